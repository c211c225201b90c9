"""The fenced blocks of a page, run as a reader would who types them from top to bottom in an empty folder."""

import os
import re
import subprocess
import sys
import tomllib
from dataclasses import dataclass
from pathlib import Path

from smash.problem.extras import EXTRAS, is_there

ROOT = Path(__file__).parents[2]
BLOCK = re.compile(r"^```(?P<kind>\w+) ?(?P<word>\S*)\n(?P<text>.*?)^```$", re.MULTILINE | re.DOTALL)
PROGRAMS = {"smash": ("-m", "smash"), "python": ()}


@dataclass
class Typed:
    """What is typed in `folder`; distributions that are `pip install`ed go to a folder of their own."""

    folder: Path

    def run(self, page):
        """Write the files of a page, run its shell and Python blocks; return how many commands and blocks ran."""
        ran = 0
        for block in BLOCK.finditer(page.read_text(encoding="utf-8")):
            needs = EXTRAS.get(block["word"], ())
            if not all(map(is_there, needs)):
                continue
            if "." in block["word"]:
                file = self.folder / block["word"]
                file.parent.mkdir(exist_ok=True)
                file.write_text(block["text"])
            elif block["kind"] == "python":
                ran += self.call(["-c", block["text"]])
            elif block["kind"] == "sh":
                ran += sum(map(self.type, block["text"].splitlines()))
        return ran

    def type(self, line):
        """Do one line of a shell."""
        match line.split():
            case ["source", activate]:
                assert activate == ".venv/bin/activate"
                return 0
            case ["pip", "install", "-e", folder]:
                self.install(self.folder / folder)
                return 1
            case [program, *arguments]:
                return self.call([*PROGRAMS[program], *arguments])

    def call(self, arguments):
        """Run an interpreter; it must end well."""
        packages = (self.folder / "site", ROOT, ROOT / "baselines", ROOT / "analysis")
        path = os.pathsep.join(map(str, packages))
        ended = subprocess.run(
            [sys.executable, *arguments],
            cwd=self.folder,
            env={**os.environ, "PYTHONPATH": path},
            capture_output=True,
            text=True,
            timeout=300,
        )
        assert ended.returncode == 0, f"{arguments}: {ended.stdout[-2000:]}{ended.stderr}"
        self.said = ended.stdout
        return 1

    def install(self, package):
        """Put a package where interpreters find it, with what its pyproject.toml says: pip would ask the network."""
        project = tomllib.loads((package / "pyproject.toml").read_text())
        about = project["project"]
        info = self.folder / "site" / f"{about['name'].replace('-', '_')}-{about['version']}.dist-info"
        info.mkdir(parents=True)
        (info / "METADATA").write_text(f"Metadata-Version: 2.1\nName: {about['name']}\nVersion: {about['version']}\n")
        lines = []
        for group, entries in about["entry-points"].items():
            lines += [f"[{group}]", *(f"{name} = {target}" for name, target in entries.items()), ""]
        (info / "entry_points.txt").write_text("\n".join(lines))
        for module in project["tool"]["setuptools"]["py-modules"]:
            (self.folder / "site" / f"{module}.py").symlink_to(package / f"{module}.py")
