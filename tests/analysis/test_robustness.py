"""Curves over each kind of noise, and what topple saves at several paces, of made-up records."""

import json

import pytest
from smash_analysis import paces, robustness

from smash.problem.errors import MalformedFile
from tests.analysis.test_execution_tables import record


def written(folder, rows):
    lines = []
    for number, (name, variant, seconds, success, more) in enumerate(rows):
        row = record(name, variant, seconds, success)
        row["episode"] |= more
        lines.append(json.dumps(row | {"key": f"{row['key']}/{number}"}) + "\n")
    (folder / "episodes.jsonl").write_text("".join(lines))
    return folder


def test_time_under_noise_is_compared_on_what_succeeds_both_ways(tmp_path):
    rows = [(name, "topple", 20.0, True, {}) for name in "ab"]
    rows += [
        ("a", "topple", 30.0, True, {"noise": {"pose": 0.003}}),
        ("b", "topple", 99.0, False, {"noise": {"pose": 0.003}}),
    ]
    rows += [("a", "topple", 22.0, True, {"noise": {"yaw": 0.0349066}})]
    rows += [("a", "topple", 77.0, True, {"noise": {"yaw": 0.1, "pose": 0.001}})]
    table = robustness.robustness_table(robustness.read_noisy(written(tmp_path, rows))).set_index("noise")
    assert list(table.index) == ["none", "pose 3 mm", "yaw 2 °"]
    assert table.loc["pose 3 mm", "success"].startswith("0.50")
    assert table.loc["pose 3 mm", "time"].startswith("1.50")
    assert table.loc["yaw 2 °", "time"].startswith("1.10")
    assert table.loc["pose 3 mm", "failures"] == "slip 1"


def test_table_and_curves_are_written(tmp_path):
    rows = [(name, "topple", 20.0, True, more) for name in "ab" for more in ({}, {"noise": {"size": 0.001}})]
    text, picture = robustness.make(written(tmp_path, rows), tmp_path / "out")
    assert "size 1 mm" in text.read_text()
    assert picture.read_bytes().startswith(b"\x89PNG")


def test_nothing_but_several_kinds_at_once_lies_on_no_curve(tmp_path):
    rows = [("a", "topple", 20.0, True, {"noise": {"size": 0.001, "mass": 0.1}})]
    with pytest.raises(MalformedFile, match="one kind"):
        robustness.read_noisy(written(tmp_path, rows))


def test_what_topple_saves_is_told_by_pace(tmp_path):
    rows = [
        ("a", variant, seconds * factor, True, {"speed": speed})
        for speed, factor in (((0.5, 0.25), 1.0), ((0.1, 0.1), 3.0))
        for variant, seconds in (("topple", 20.0), ("no-topple", 30.0))
    ]
    alone = [("b", "topple", 1.0, True, {"speed": (0.5, 0.25)})]
    (text,) = paces.make(written(tmp_path, [*rows, *alone]), tmp_path / "out")
    assert "5 episodes, 4 of them of plans that succeed at every pace" in text.read_text()
    table = paces.pace_table(paces.read_paces(tmp_path)).set_index("pace")
    assert table["without [s]"].to_dict() == {"0.1, 0.1": "90.0", "0.5, 0.25": "30.0"}
    assert table["saved [%]"].tolist() == ["33", "33"]
    seconds = paces.action_table(paces.read_paces(tmp_path)).set_index(["pace", "variant"])["seconds an action"]
    assert seconds["0.1, 0.1", "topple"] == "15.00"
    assert (seconds["the paper", "topple"], seconds["the paper", "no-topple"]) == ("5.36", "5.00")
    assert "5.36" in text.read_text()
