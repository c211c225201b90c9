"""The same plans by several robots, of made-up records."""

import json

import pytest
from smash_analysis import arms as module

from smash.problem.errors import MalformedFile
from tests.analysis.test_execution_tables import record


def episode(name, variant, seconds, robot, success=True):
    row = record(name, variant, seconds, success)
    return {**row, "engine": "mujoco", "robot": robot, "key": f"{row['key']}/mujoco/{robot}"}


def written(folder, rows):
    (folder / "episodes.jsonl").write_text("".join(json.dumps(row) + "\n" for row in rows))
    return folder


@pytest.fixture
def results(tmp_path):
    rows = [
        episode("a", "topple", 20.0, "panda"),
        episode("b", "topple", 20.0, "panda"),
        episode("a", "no-topple", 40.0, "panda"),
        episode("a", "topple", 30.0, "ur5"),
        episode("b", "topple", 30.0, "ur5", success=False),
        episode("a", "no-topple", 40.0, "ur5"),
        episode("a", "topple", 18.0, "xarm7"),
    ]
    return written(tmp_path, rows)


def test_times_are_compared_with_the_first_robot_on_what_both_carry_out(results):
    robots, episodes = module.read_arms(results)
    assert robots == ["panda", "ur5", "xarm7"]
    table = module.arm_table(episodes, robots).set_index(["variant", "robot"])
    assert table.loc[("topple", "ur5"), "success"].startswith("0.50")
    assert table.loc[("topple", "ur5"), "failures"] == "slip 1"
    assert table.loc[("topple", "panda"), "time"] == "1"
    assert table.loc[("topple", "ur5"), "time"].startswith("1.50")
    assert table.loc[("topple", "xarm7"), "time"].startswith("0.90")
    assert ("no-topple", "xarm7") not in table.index


def test_what_topple_saves_is_told_of_each_robot_on_what_all_carry_out(results):
    robots, episodes = module.read_arms(results)
    saved = module.saved_table(episodes[episodes["robot"] != "xarm7"], robots).set_index("robot")["saved [%]"]
    assert saved.to_dict() == {"panda": "50", "ur5": "25"}


def test_the_page_has_failures_and_tables(results, tmp_path):
    (file,) = module.make(results, tmp_path / "out")
    page = file.read_text()
    assert "7 episodes by panda, ur5, xarm7" in page
    assert "it slipped" in page


def test_one_robot_alone_makes_no_table(tmp_path):
    with pytest.raises(MalformedFile, match=r"episodes by ur5 alone; `smash episodes` with --robot"):
        module.read_arms(written(tmp_path, [episode("a", "topple", 20.0, "ur5")]))
