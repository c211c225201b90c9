"""The same plans and topples in two engines, of made-up records."""

import json

import pytest
from smash_analysis import engines as module
from smash_analysis.engine_landings import outcome_table, paired_landings, rank_table, unlike_topples

from smash.problem.errors import MalformedFile
from smash.records.trials import Landing, Trial
from tests.analysis.test_execution_tables import record

BOTH = ("pybullet", "mujoco")


def episode(name, variant, seconds, engine, success=True):
    row = record(name, variant, seconds, success)
    return {**row, "engine": engine, "key": f"{row['key']}/{engine}"}


def topple(engine, along, good=True, falling=2, seed=0):
    landings = tuple(
        Landing(level=2 + place, along=where, aside=0.0, graspable=good) for place, where in enumerate(along)
    )
    return Trial(
        scene="default", engine=engine, stack=0, height=2, falling=falling, seed=seed, moved=0.001, stands=True,
        landings=landings, problem="" if along else "no way to the pile",
    )  # fmt: skip


@pytest.fixture
def results(tmp_path):
    rows = [
        episode("a", "topple", 20.0, "pybullet"),
        episode("a", "topple", 20.5, "mujoco"),
        episode("a", "no-topple", 30.0, "pybullet"),
        episode("a", "no-topple", 30.0, "mujoco"),
        episode("b", "topple", 20.0, "pybullet"),
        episode("b", "topple", 9.0, "mujoco", success=False),
        episode("c", "topple", 20.0, "pybullet"),
        episode("c", "topple", 22.0, "mujoco"),
        episode("alone", "topple", 20.0, "mujoco"),
    ]
    (tmp_path / "episodes.jsonl").write_text("".join(json.dumps(row) + "\n" for row in rows))
    return tmp_path


def test_success_and_time_are_compared_on_what_both_tried(results):
    engines, episodes = module.read_engines(results)
    assert engines == BOTH
    table = module.engine_table(episodes, engines).set_index("variant")
    assert table.loc["topple", "success, pybullet"].startswith("1.00")
    assert table.loc["topple", "success, mujoco"].startswith("0.67")
    assert "3 episodes" in table.loc["topple", "success, mujoco"]
    assert table.loc["topple", "time"].startswith("1.062")
    assert (table.loc["topple", "in one alone"], table.loc["topple", "failures, mujoco"]) == (1, "slip 1")


def test_other_ends_and_other_times_are_disagreements(results):
    engines, episodes = module.read_engines(results)
    listed = module.disagreements(episodes, engines).set_index("instance")
    assert listed["mujoco"].to_dict() == {"b": "slip, step 2: it slipped", "c": "success in 22.0 s"}
    assert listed.loc["b", "pybullet"] == "success in 20.0 s"


def test_what_topple_saves_is_told_of_each_engine(results):
    engines, episodes = module.read_engines(results)
    saved = module.saved_table(episodes, engines).set_index("engine")["saved [%]"]
    assert saved.to_dict() == {"pybullet": "33", "mujoco": "32"}


def test_landings_are_paired_by_rank():
    trials = [topple("pybullet", (0.2, 0.1)), topple("mujoco", (0.11, 0.24))]
    trials += [topple("pybullet", (0.3, 0.1), seed=1), topple("mujoco", (0.1, 0.3), good=False, seed=1)]
    trials += [
        topple("pybullet", (), seed=2),
        topple("mujoco", (0.1, 0.3), seed=2),
        topple("mujoco", (0.1, 0.2), seed=3),
    ]
    pairs = paired_landings(trials, BOTH)
    ranks = rank_table(pairs, BOTH).set_index("rank")
    assert ranks["topples"].tolist() == [2, 2]
    assert ranks["apart, mean [cm]"].tolist() == ["0.5", "2.0"]
    assert ranks["greatest [cm]"].tolist() == ["1.0", "4.0"]
    (outcome,) = outcome_table(pairs, BOTH).to_dict("records")
    assert [outcome[name] for name in ("topples", "go well in pybullet", "in mujoco", "in both", "in one")] == [
        *(3, 2, 2, 1, 2)
    ]
    unlike = unlike_topples(pairs, BOTH).set_index("seed")
    assert unlike.loc[1, "mujoco"] == "cannot be grasped: level 2 at 10 cm, level 3 at 30 cm"
    assert unlike.loc[2, "pybullet"] == "no way to the pile"


def test_table_and_chart_are_written(results, tmp_path):
    place = results / "landings"
    for engine in BOTH:
        (place / engine).mkdir(parents=True)
        (place / engine / "trials.jsonl").write_text(json.dumps(trial_document(engine)) + "\n")
    text, picture = module.make(results, tmp_path / "out")
    words = text.read_text()
    assert "9 episodes, 4 pairs: pybullet first, mujoco second." in words
    assert "## Disagreements: 2 of 4" in words
    assert "## Landings: 1 topple in both" in words
    assert picture.read_bytes().startswith(b"\x89PNG")


def trial_document(engine):
    landings = [{"level": 2, "along": 0.1, "aside": 0.0, "graspable": True}]
    place = {"stack": 0, "height": 2, "falling": 1, "seed": 0}
    said = {"format": "smash-topple-trial/1", "scene": "default", "layout": "x", "engine": engine}
    return {**said, **place, "moved": 0.001, "stands": True, "landings": landings, "problem": ""}


def test_one_engine_alone_is_no_comparison(tmp_path):
    (tmp_path / "episodes.jsonl").write_text(json.dumps(record("a", "topple", 20.0)) + "\n")
    with pytest.raises(MalformedFile, match="by pybullet alone"):
        module.read_engines(tmp_path)
