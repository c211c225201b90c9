"""What the built wheel does in an empty environment, outside the tree: `.ci/wheel.py PYTHON --build DIR`.

It is built by the interpreter that runs this (it needs hatchling), installed by PYTHON into an environment of its own,
first as it is, then with the extra `analysis`. Nothing of the tree is on the path; the working folder is full of
modules that are called as folders of the tree are.
"""

from __future__ import annotations

import argparse
import os
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path
from zipfile import ZipFile

ROOT = Path(__file__).resolve().parents[1]
LARGEST = {"": 450, "[analysis]": 700}
"""Extras -> the most that their environment may take on disk [MB]."""
EQUALS = 1
"""What `smash submit-check` ends with where a plan is as good as the best known one."""
TRAPS = ("analysis", "baselines", "domains", "experiments", "tests")
FIVE_LINES = """
import smash
instance = smash.make_instance({"s1": ["b1", "b2"]}, {"s2": ["b2", "b1"]})
plan = smash.plan(instance)
assert smash.check(instance, plan)
assert plan.cost == 4, plan.cost
"""
ANALYSIS = """
import smash
instance = smash.make_instance({"s1": ["b1", "b2"]}, {"s2": ["b2", "b1"]})
assert smash.draw(instance, smash.plan(instance), "drawn.png").axes
assert len(smash.compare([instance], ["greedy", "astar"], budget=2)) == 2
"""
WITHOUT = """
import smash
try:
    smash.draw(smash.make_instance({"s1": ["b1"]}, {"s2": ["b1"]}))
except smash.SmashError as error:
    assert "smash-testbed[analysis]" in str(error), error
else:
    raise AssertionError("drawn without matplotlib")
"""
SUITES = """
import smash
assert len(smash.suite("multi-9")) == 20
assert len(smash.generate("multi", blocks=5, count=2)) == 2
"""


class Failed(Exception):
    """Something that the wheel should do and does not."""


class Installed:
    """The environment of the wheel, and the empty folder that its commands run in."""

    def __init__(self, directory: Path, folder: Path) -> None:
        self.directory = directory
        self.folder = folder
        self.environment = {name: value for name, value in os.environ.items() if not name.startswith("PYTHON")}
        self.failures = 0

    def python(self, *words: str) -> subprocess.CompletedProcess[str]:
        """Run its interpreter."""
        return subprocess.run(
            [str(self.directory / "bin" / "python"), *words],
            cwd=self.folder,
            env=self.environment,
            capture_output=True,
            text=True,
            check=False,
        )

    def expect(self, *words: str, code: int = 0) -> str:
        """Run its interpreter, which must end with `code`, with one line where that is an error; return its output."""
        ended = self.python(*words)
        command = " ".join(words).strip().replace("\n", "; ")
        if ended.returncode == code and (code in (0, EQUALS) or ended.stderr.count("\n") == 1):
            print(f"  well (exit {code}): {command}", flush=True)
        else:
            self.failures += 1
            print(
                f"  FAILED (exit {ended.returncode}, expected {code}): {command}\n{ended.stdout}{ended.stderr}",
                flush=True,
            )
        return ended.stdout

    def smash(self, *words: str, code: int = 0) -> str:
        """Run `python -m smash`, as `expect` does: the working folder is the first on its path."""
        return self.expect("-m", "smash", *words, code=code)

    def install(self, wheel: Path, extras: str) -> None:
        """Install the wheel and its part of requirements.lock, and compare what it takes on disk with `LARGEST`.

        Raises:
            Failed: where pip fails, the lock lacks something of what the wheel asks for, or it takes more.
        """
        names = [name for name in extras.strip("[]").split(",") if name]
        locked = subprocess.run(
            [sys.executable, str(ROOT / ".ci" / "locked.py"), *names], stdout=subprocess.PIPE, check=True
        )
        packages = self.folder / "packages.txt"
        packages.write_bytes(locked.stdout)
        pip = ("-m", "pip", "install", "--quiet", "--disable-pip-version-check", "--no-input")
        wanted = f"smash-testbed{extras} @ {wheel.as_uri()}"
        for words in (
            (*pip, "--require-hashes", "-r", str(packages)),
            (*pip, "--no-deps", "--force-reinstall", str(wheel)),
            (*pip, "--no-index", wanted),
            ("-m", "pip", "check"),
        ):
            ended = self.python(*words)
            if ended.returncode:
                raise Failed(f"{' '.join(words)}: {ended.stdout}{ended.stderr}")
        size = disk_use(self.directory)
        print(f"  smash-testbed{extras}: {size} MB on disk", flush=True)
        if size > LARGEST[extras]:
            raise Failed(f"smash-testbed{extras} takes {size} MB on disk; {LARGEST[extras]} are allowed")


def disk_use(directory: Path) -> int:
    """Return what the files below a directory take on disk [MB], as `du -sm` does."""
    blocks = {(file.lstat().st_ino, file.lstat().st_blocks) for file in directory.rglob("*")}
    return -(-sum(count for _, count in blocks) * 512 // 2**20)


def build(target: Path) -> Path:
    """Build the wheel and return it.

    Raises:
        Failed: where it cannot be built, or would install a top-level name that does not begin with `smash`.
    """
    shutil.rmtree(target, ignore_errors=True)
    pip = [sys.executable, "-m", "pip", "wheel", "--quiet", "--disable-pip-version-check", "--no-deps"]
    ended = subprocess.run([*pip, "--no-build-isolation", "-w", str(target), str(ROOT)], check=False)
    if ended.returncode:
        raise Failed("pip wheel . failed")
    (wheel,) = target.glob("*.whl")
    with ZipFile(wheel) as content:
        foreign = sorted({name.split("/")[0] for name in content.namelist() if not name.startswith("smash")})
    if foreign:
        raise Failed(f"{wheel.name} holds {', '.join(foreign)}; every name must begin with smash")
    return wheel


def check_planning(installed: Installed) -> None:
    """Check what works without any extra."""
    installed.expect("-c", FIVE_LINES)
    installed.expect("-c", SUITES)
    installed.expect("-c", WITHOUT)
    installed.smash("--help")
    installed.smash("planners")
    installed.smash("plan", "figure1.json", "--out", "plan.json")
    installed.smash("validate", "figure1.json", "plan.json")
    installed.smash("generate", "multi", "--blocks", "5", "--count", "2", "--out", "set")
    installed.smash("export-pddl", "figure1.json", "--out", "pddl")
    installed.smash("best-known", "table")
    installed.smash("best-known", "add", "plan.json", "--by", "nobody", code=2)
    installed.smash("generate", "single", "--blocks", "4", "--count", "1", "--out", "towers")
    installed.smash("reproduce", "--dry-run", code=2)
    installed.smash("report", "set", code=6)
    installed.smash("draw", "instance", "figure1.json", "--out", "figure1.png", code=6)
    plans = installed.expect("-c", "from smash.experiments.best_known.files import LIST; print(LIST / 'plans')").strip()
    installed.smash("submit-check", str(min(Path(plans).glob("*.json"))), code=EQUALS)


def check_analysis(installed: Installed) -> None:
    """Check what works with the extra `analysis`."""
    installed.expect("-c", ANALYSIS)
    (installed.folder / "small.toml").write_text(
        'name = "small"\nsuites = ["towers"]\nbudgets = [2]\n[[planners]]\nname = "greedy"\n'
    )
    installed.smash("sweep", "small.toml", "--out", "runs")
    installed.smash("report", "runs")
    installed.smash("draw", "instance", "figure1.json", "--out", "figure1.png")
    installed.smash("compare", "towers", "--planner", "greedy", "--planner", "astar", "--out", "compared")


def main() -> int:
    """Build, install, check; return the exit code."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("python", metavar="PYTHON", help="the interpreter to install it for")
    parser.add_argument("--build", type=Path, required=True, metavar="DIR", help="of the wheel and the environment")
    arguments = parser.parse_args()
    target: Path = arguments.build.resolve()
    environment = target / "environment"
    with tempfile.TemporaryDirectory() as folder:
        installed = Installed(environment, Path(folder))
        for trap in TRAPS:
            (installed.folder / f"{trap}.py").write_text("raise SystemExit('a file of the working folder was run')\n")
        shutil.copy(ROOT / "examples" / "figure1.json", installed.folder)
        try:
            wheel = build(target)
            subprocess.run([arguments.python, "-m", "venv", str(environment)], check=True)
            for extras, check in (("", check_planning), ("[analysis]", check_analysis)):
                installed.install(wheel, extras)
                check(installed)
            if installed.failures:
                raise Failed(f"{installed.failures} commands do not do what they should")
        except (Failed, subprocess.CalledProcessError) as error:
            print(f"wheel: {error}", file=sys.stderr)
            return 1
        finally:
            shutil.rmtree(environment, ignore_errors=True)
    print("wheel: well")
    return 0


if __name__ == "__main__":
    sys.exit(main())
