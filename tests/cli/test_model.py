"""`smash model`: the size of a planner's MILP, and the file that any solver reads."""

import subprocess
import sys
from pathlib import Path

import highspy
import pytest

from smash import make_instance, write_instance

FIGURE1 = Path(__file__).parents[2] / "examples" / "figure1.json"


def smash(*arguments):
    command = [sys.executable, "-m", "smash", *map(str, arguments)]
    return subprocess.run(command, capture_output=True, text=True, check=False)


@pytest.mark.parametrize("suffix", ["mps", "lp"])
def test_the_written_flow_model_has_the_optimum_of_figure_1(tmp_path, suffix):
    path = tmp_path / f"figure1.{suffix}"
    done = smash("model", FIGURE1, "--planner", "smash-flow", "--out", path)
    assert (done.returncode, done.stderr) == (0, "")
    assert "columns" in done.stdout
    solver = highspy.Highs()
    solver.silent()
    solver.readModel(str(path))
    solver.run()
    assert round(solver.getInfo().objective_function_value) == 3


@pytest.mark.parametrize(
    ("arguments", "code"),
    [
        (["--planner", "greedy"], 6),
        (["--planner", "smash-flow", "--out", "x.txt"], 2),
        (["--planner", "nobody"], 2),
        (["--warm-start", "nobody"], 2),
        (["--planner", "smash-layered", "--out", "missing/x.lp"], 2),
    ],
)
def test_refusals_are_one_line(tmp_path, arguments, code):
    done = smash("model", FIGURE1, *arguments)
    assert done.returncode == code
    assert len(done.stderr.splitlines()) == 1


@pytest.mark.parametrize("planner", ["smash-flow", "smash-layered"])
def test_a_full_hand_has_a_model_for_each_first_place_and_none_of_all(tmp_path, planner):
    held = make_instance({"s1": ["a"]}, {"s1": ["a", "b"]}, hand="b")
    write_instance(held, tmp_path / "held.json")
    done = smash("model", tmp_path / "held.json", "--planner", planner)
    assert (done.returncode, len(done.stderr.splitlines())) == (6, 1)
    assert "first place" in done.stderr
