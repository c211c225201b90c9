"""The code of `docs/python.md` runs from top to bottom."""

import re
from pathlib import Path

import pytest

PAGE = Path(__file__).parents[2] / "docs" / "python.md"
BLOCK = re.compile(r"^```python(?P<needs>[^\n]*)\n(?P<code>.*?)^```$", re.MULTILINE | re.DOTALL)


def test_the_blocks_run_in_order(tmp_path, monkeypatch):
    pytest.importorskip("pandas")
    monkeypatch.chdir(tmp_path)
    names = {"__name__": "__main__"}
    blocks = list(BLOCK.finditer(PAGE.read_text(encoding="utf-8")))
    assert len(blocks) >= 8
    for block in blocks:
        if "execution" not in block["needs"]:
            exec(compile(block["code"], PAGE.name, "exec"), names)


@pytest.mark.slow
def test_the_block_that_carries_a_plan_out_runs(tmp_path, monkeypatch):
    pytest.importorskip("pybullet")
    monkeypatch.chdir(tmp_path)
    blocks = [block["code"] for block in BLOCK.finditer(PAGE.read_text(encoding="utf-8"))]
    chosen = [blocks[0], *(code for code in blocks if "smash.execute" in code)]
    exec(compile("\n".join(chosen), PAGE.name, "exec"), {"__name__": "__main__"})
