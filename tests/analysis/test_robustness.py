"""Curves over each kind of noise, and what topple saves at several paces, of made-up records."""

import json

import pytest
from smash_analysis import paces, robustness

from smash.problem.errors import MalformedFile
from smash.records.engines import MixedEngines
from smash.records.scenes import MixedScenes
from tests.analysis.test_execution_tables import record

FAST, SLOW = {"speed": (0.5, 0.25)}, {"speed": (0.1, 0.1)}


def written(folder, rows):
    made = []
    for name, variant, seconds, success, more in rows:
        row = record(name, variant, seconds, success)
        row["episode"] |= more
        made.append(row)
    return kept(folder, made)


def kept(folder, rows):
    lines = [json.dumps(row | {"key": f"{row['key']}/{number}"}) + "\n" for number, row in enumerate(rows)]
    (folder / "episodes.jsonl").write_text("".join(lines))
    return folder


def under(scene, more, name="a", variant="topple", seconds=20.0):
    """A record in a scene; without an episode where it has nothing more."""
    row = record(name, variant, seconds) | {"scene": scene}
    return (
        row | {"episode": row["episode"] | more} if more else row | {"episode": None, "problem": "killed by signal 9"}
    )


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
    rows += [("a", "topple", 20.0, True, {"noise": {"wind": 0.1}})]
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


def test_a_crash_under_noise_is_a_loss_at_its_amount(tmp_path):
    noisy = FAST | {"noise": {"pose": 0.003}}
    rows = [under(None, FAST, name) for name in "ab"]
    rows += [under("default pose=3mm", noisy), under("default pose=3mm", None, "b")]
    rows += [under("default pose=5mm", None, name) for name in "ab"]
    table = robustness.robustness_table(robustness.read_noisy(kept(tmp_path, rows))).set_index("noise")
    assert table["success"].str[:4].to_dict() == {"none": "1.00", "pose 3 mm": "0.50", "pose 5 mm": "0.00"}
    assert table["success"].iloc[0].endswith("of 2 (2 episodes)")
    assert table["failures"].tolist() == ["–", "crashed 1", "crashed 2"]
    robustness.make(tmp_path, tmp_path / "out")


def test_a_crash_in_a_scene_with_noise_of_its_own_is_told_by_the_others_there(tmp_path):
    rows = [under("rough", FAST | {"noise": {"mass": 0.1}}), under("rough", None, "b"), under("rough exact", FAST)]
    episodes = robustness.read_noisy(kept(tmp_path, rows))
    assert list(zip(episodes["kind"], episodes["amount"], strict=True)) == [("mass", 10.0)] * 2 + [("", 0.0)]


def test_noise_at_one_pace_is_set_against_none_at_that_pace(tmp_path, capsys):
    noise = {"noise": {"pose": 0.003}}
    rows = [under(None, FAST), under("default pace=0.1", SLOW, seconds=60.0), under("default pose=3mm", FAST | noise)]
    table = robustness.robustness_table(robustness.read_noisy(kept(tmp_path, rows)))
    assert table["time"].str[:4].tolist() == ["1.00", "1.00"]
    assert "1 episode of another pace" in capsys.readouterr().err
    kept(tmp_path, [*rows, under("default pose=3mm pace=0.1", SLOW | noise)])
    with pytest.raises(MixedScenes, match=r"\(1 in default at 0.1, 0.1, 1 in default at 0.5, 0.25\)"):
        robustness.read_noisy(tmp_path)


def test_a_policy_that_was_tried_with_one_kind_alone_has_no_line_in_the_others(tmp_path):
    rows = [under(None, FAST), under("default pose=3mm", FAST | {"noise": {"pose": 0.003}})]
    rows += [under("default mass=10%", FAST | {"noise": {"mass": 0.1}}) | {"policy": "replan"}]
    text, _ = robustness.make(kept(tmp_path, rows), tmp_path / "out")
    assert "| replan | mass 10 % |" in text.read_text()


def test_a_crash_loses_its_pair_and_no_more(tmp_path):
    rows = [
        under(scene, speed | {"noise": {}}, name, variant)
        for scene, speed in ((None, FAST), ("default pace=0.1", SLOW))
        for name in "ab"
        for variant in ("topple", "no-topple")
    ]
    rows[0], rows[4] = under(None, None), under("default pace=0.1", None)
    episodes = paces.read_paces(kept(tmp_path, rows))
    assert episodes["pace"].value_counts().to_dict() == {"0.5, 0.25": 4, "0.1, 0.1": 4}
    (text,) = paces.make(tmp_path, tmp_path / "out")
    assert "8 episodes, 6 of them of plans that succeed at every pace" in text.read_text()
    assert "| open, default pace=0.1 | crashed | 1 |" in text.read_text()


def test_paces_are_of_one_scene_without_noise_and_one_name_of_a_pace(tmp_path, capsys):
    rows = [
        under(None, FAST),
        under("default exact", FAST),
        under("default pose=3mm", FAST | {"noise": {"pose": 0.003}}),
    ]
    assert len(paces.read_paces(kept(tmp_path, rows))) == 1
    assert capsys.readouterr().err.startswith("1 episode with noise")
    with pytest.raises(MixedScenes, match="1 in rough"):
        paces.read_paces(kept(tmp_path, [*rows, under("rough exact", FAST)]))
    with pytest.raises(MalformedFile, match="no episode without noise"):
        paces.read_paces(kept(tmp_path, rows[2:]))


@pytest.mark.parametrize("read", [paces.read_paces, robustness.read_noisy])
def test_what_is_refused_says_where_it_is(tmp_path, read):
    kept(tmp_path, [under(None, FAST), under(None, FAST, "b") | {"engine": "mujoco"}])
    with pytest.raises(MixedEngines, match=str(tmp_path)):
        read(tmp_path)
