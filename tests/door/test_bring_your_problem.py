"""Every block of `docs/bring-your-problem.md` runs, from top to bottom, in an empty folder."""

import re
import subprocess
import sys
from pathlib import Path

PAGE = Path(__file__).parents[2] / "docs" / "bring-your-problem.md"
BLOCK = re.compile(r"^```(?P<kind>\w+) ?(?P<file>\S*)\n(?P<text>.*?)^```$", re.MULTILINE | re.DOTALL)


def test_every_block_runs(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    kinds = []
    for block in BLOCK.finditer(PAGE.read_text(encoding="utf-8")):
        kinds.append(block["kind"])
        assert block["text"].count("\n") <= 12
        if block["file"]:
            Path(block["file"]).write_text(block["text"])
        elif block["kind"] == "python":
            exec(compile(block["text"], PAGE.name, "exec"), {"__name__": "__main__"})
        else:
            for line in block["text"].splitlines():
                command, *arguments = line.split()
                assert command == "smash"
                called = [sys.executable, "-m", "smash", *arguments]
                ended = subprocess.run(called, capture_output=True, text=True, timeout=60)
                assert ended.returncode == 0, f"{line}: {ended.stderr}"
    assert kinds == ["pddl", "pddl", "sh", "json", "sh", "python", "sh"]
