"""The scripts and notebooks of `examples/use` run from top to bottom, in any folder."""

import json
import subprocess
import sys
from pathlib import Path

import pytest

from tests.examples.notebooks import run_notebook

USE = Path(__file__).parents[2] / "examples" / "use"
SCRIPTS = sorted(USE.glob("*.py"))
PLANNING = [script for script in SCRIPTS if script.name != "carry_out.py"]
NOTEBOOKS = sorted(USE.glob("*.ipynb"))


def run(script, folder):
    ended = subprocess.run([sys.executable, script], capture_output=True, text=True, cwd=folder, timeout=110)
    assert ended.returncode == 0, ended.stderr
    return ended.stdout


@pytest.mark.parametrize("script", PLANNING, ids=lambda file: file.name)
def test_a_script_runs(script, tmp_path):
    assert run(script, tmp_path)


@pytest.mark.slow
def test_the_script_that_carries_a_plan_out_runs(tmp_path):
    pytest.importorskip("pybullet")
    assert run(USE / "carry_out.py", tmp_path).endswith("success\n")


def test_the_first_plan_is_proven_and_accepted(tmp_path):
    said = run(USE / "first_plan.py", tmp_path).splitlines()
    assert said[0] == "optimal, 5 actions"
    assert said[-1] == "accepted"


@pytest.mark.parametrize("notebook", NOTEBOOKS, ids=lambda file: file.name)
def test_a_notebook_runs_and_shows_something_at_every_value(notebook, tmp_path, monkeypatch):
    matplotlib = pytest.importorskip("matplotlib")
    pytest.importorskip("pandas")
    matplotlib.use("Agg")
    monkeypatch.chdir(tmp_path)
    values = run_notebook(notebook)
    assert len(values) >= 4
    for value in values:
        picture = getattr(value, "_repr_svg_", None) or getattr(value, "_repr_png_", None)
        assert picture is None or picture()


@pytest.mark.parametrize("notebook", NOTEBOOKS, ids=lambda file: file.name)
def test_a_notebook_is_committed_without_outputs(notebook):
    document = json.loads(notebook.read_text(encoding="utf-8"))
    assert (document["nbformat"], document["nbformat_minor"]) >= (4, 5)
    for cell in document["cells"]:
        assert cell["id"]
        if cell["cell_type"] == "code":
            assert not cell["outputs"]
            assert cell["execution_count"] is None


def test_the_folder_names_every_example():
    said = (USE.parent / "README.md").read_text(encoding="utf-8")
    assert all(f"(use/{file.name})" in said for file in [*SCRIPTS, *NOTEBOOKS])
