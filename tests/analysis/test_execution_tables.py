import json

import pytest
from smash_analysis.execution_tables import (
    disturbed_table,
    failure_table,
    make,
    metric_table,
    paired_table,
    read_episodes,
    slower_table,
)
from smash_analysis.report.appendix import commands
from smash_analysis.report.sources import find_sources
from smash_analysis.tables.scenes import SEVERAL, by_scene

from smash.problem.errors import MalformedFile
from smash.records.engines import MixedEngines, MixedRobots


def record(instance, variant, seconds, success=True, seed=0, task=0.0):
    failure = None if success else {"name": "slip", "reason": "it slipped", "step": 2, "action": ["pick", "a", "s"]}
    times = {"offline": 0.1, "offline_cpu": 0.1, "online": 0.2, "online_cpu": 0.2, "execution": seconds, "task": task}
    episode = {
        "format": "smash-episode/1",
        "instance": instance,
        "planner": "smash",
        "topple": True,
        "max_topple": None,
        "scene": "default",
        "seed": seed,
        "replanning": False,
        "plan_cost": 8,
        "final": {"piles": {}, "table": []},
        "actions": [],
        "success": success,
        "failure": failure,
        "times": times,
        "actions_executed": 4,
        "replans": 0,
        "retries": 0,
    }
    return {
        "format": "smash-episode-run/1",
        "key": f"{instance}/{variant}/{seed}",
        "run": f"{instance}/{variant}",
        "scene": None,
        "status": "feasible",
        "budget": 1.0,
        "best_plan_seconds": 0.01,
        "wall_seconds": 12.0,
        "instance": instance,
        "suite": "multi-4",
        "label": "smash",
        "variant": variant,
        "policy": "open",
        "seed": seed,
        "blocks": 4,
        "depth": None,
        "cost": 8,
        "first_plan_seconds": 0.01,
        "episode": episode,
        "problem": "",
        "started": "2026-01-01T00:00:00.000+00:00",
        "load_average": [0.1, 0.2],
        "commit": {"hash": "c", "dirty": False},
        "machine": {"processor": "p", "cores": 2, "usable_cores": 2, "memory_mib": 1000, "system": "Linux"},
        "versions": {},
    }


@pytest.fixture
def results(tmp_path):
    records = [
        record("a", "topple", 20.0),
        record("a", "no-topple", 30.0),
        record("b", "topple", 25.0),
        record("b", "no-topple", 27.0),
        record("c", "topple", 5.0, success=False),
        record("c", "no-topple", 40.0),
    ]
    (tmp_path / "episodes.jsonl").write_text("".join(json.dumps(r) + "\n" for r in records) + '{"format": "sma')
    return tmp_path


def test_the_paper_s_figures_stand_beside_ours(results):
    table = metric_table(read_episodes(results), "multi")
    rows = table[table["metric"] == "Success rate"].set_index("source")
    assert rows.loc["paper", "6 blocks w/ topple"] == "0.95"
    assert rows.loc["smash, open", "4 blocks w/ topple"].startswith("0.67")
    assert rows.loc["smash, open", "9 blocks w/ topple"] == "–"


def test_success_counts_instances_and_says_how_many_episodes(tmp_path):
    records = [record("a", "topple", 20.0, seed=seed) for seed in range(3)] + [
        record("b", "topple", 5.0, success=False)
    ]
    (tmp_path / "episodes.jsonl").write_text("".join(json.dumps(r) + "\n" for r in records))
    table = metric_table(read_episodes(tmp_path), "multi").set_index(["metric", "source"])
    assert table.loc[("Success rate", "smash, open"), "4 blocks w/ topple"] == "0.50 [0.09, 0.91] of 2 (4 episodes)"


def test_actions_are_of_all_plans_and_times_of_successful_episodes(tmp_path):
    records = [record("a", "topple", 20.0), {**record("b", "topple", 5.0, success=False), "cost": 12}]
    (tmp_path / "episodes.jsonl").write_text("".join(json.dumps(r) + "\n" for r in records))
    ours = metric_table(read_episodes(tmp_path), "multi").set_index(["metric", "source"])["4 blocks w/ topple"]
    assert ours["Number of actions", "smash, open"] == "10.00 ± 2.83 (10.00)"
    assert ours["Execution [s]", "smash, open"] == "20.00 ± 0.00 (20.00)"


def test_replanning_stands_beside_execution_and_the_paper_has_none(tmp_path):
    records = [record("a", "topple", 20.0, task=1.5), record("b", "topple", 20.0), record("a", "no-topple", 30.0)]
    (tmp_path / "episodes.jsonl").write_text("".join(json.dumps(r) + "\n" for r in records))
    episodes = read_episodes(tmp_path)
    rows = metric_table(episodes, "multi").set_index(["metric", "source"])["4 blocks w/ topple"]
    assert rows["Replanning [s]", "paper"] == "–"
    assert rows["Replanning [s]", "smash, open"] == "0.75 ± 1.06 (0.75)"
    assert paired_table(episodes)["replanning without, with [s]"].tolist() == ["0.00, 1.50"]
    make(tmp_path, tmp_path)
    assert r"Replanning [s] & paper & -- & --" in (tmp_path / "table-multi.tex").read_text()


def test_savings_are_paired_over_instances_that_both_solved(results):
    (row,) = paired_table(read_episodes(results)).to_dict("records")
    assert row["instances"] == 2
    assert row["success with"] == "0.67 [0.21, 0.94] of 3 (3 episodes)"
    assert row["saved [s], mean [95 %] (range)"] == "6.0 (2.0 to 10.0)"
    assert row["faster, equal, slower"] == "2, 0, 0"
    assert row["the paper [%]"] == "13"


def test_failures_are_listed_with_an_example(results):
    (row,) = failure_table(read_episodes(results)).to_dict("records")
    assert row["failure"] == "slip"
    assert "it slipped" in row["example"]


def test_an_episode_whose_process_ended_is_a_failure_with_the_process_s_words(tmp_path):
    crashed = {**record("a", "topple", 0.0), "episode": None, "problem": "killed by signal 9"}
    (tmp_path / "episodes.jsonl").write_text(json.dumps(crashed) + "\n" + json.dumps(record("b", "topple", 1.0)) + "\n")
    (row,) = failure_table(read_episodes(tmp_path)).to_dict("records")
    assert (row["failure"], row["example"]) == ("crashed", "a seed 0: killed by signal 9")


def test_tables_are_written_as_markdown_and_latex(results):
    files = make(results, results / "tables")
    assert {file.name for file in files} == {"episodes.csv", "tables.md", "table-multi.tex", "table-multi-column.tex"}
    assert r"\begin{table*}" in (results / "tables" / "table-multi.tex").read_text()


def test_without_records_there_is_one_line(tmp_path):
    with pytest.raises(MalformedFile, match="cannot be read"):
        read_episodes(tmp_path)


def test_where_topple_took_longer_is_named_with_both_sides(tmp_path):
    records = [record("a", "topple", 33.0), record("a", "no-topple", 30.0), record("b", "topple", 20.0)]
    (tmp_path / "episodes.jsonl").write_text("".join(json.dumps(r) + "\n" for r in records))
    (row,) = slower_table(read_episodes(tmp_path)).to_dict("records")
    assert (row["instance"], row["lost [s]"], row["planned with, without"]) == ("a", "3.0", "8, 8")


def test_blocks_that_were_moved_or_touched_unmeant_are_counted_by_setting(tmp_path):
    def row(step, **noted):
        return {"step": step, "action": ["pick", "a", "s"], "origin": "plan", **noted}

    records = [record("a", "topple", 20.0), record("b", "topple", 20.0), record("a", "no-topple", 20.0)]
    records[0]["episode"]["actions"] = [row(1, disturbed={"x": 0.03, "y": 0.4}), row(2, disturbed={"x": 0.1}), row(3)]
    records[1]["episode"]["actions"] = [row(1, touched=["z"]), row(2, aside=["u", "v"])]
    (tmp_path / "episodes.jsonl").write_text("".join(json.dumps(each) + "\n" for each in records))
    episodes = read_episodes(tmp_path)
    assert list(episodes["disturbed"]) == [3, 0, 0]
    (found,) = disturbed_table(episodes).to_dict("records")
    assert (found["variant"], found["episodes"]) == ("topple", 2)
    assert (found["disturbed"], found["touched"], found["aside"]) == (3, 1, 2)
    make(tmp_path, tmp_path / "out")
    assert "Moved or touched unmeant" in (tmp_path / "out" / "tables.md").read_text()


def test_where_nothing_was_moved_unmeant_the_page_says_so(results):
    assert disturbed_table(read_episodes(results)).empty


def two_kinds(folder, **other):
    """Two episodes, the second with another engine or robot."""
    records = [record("i", "topple", 60.0), {**record("i", "topple", 60.0, seed=1), **other}]
    (folder / "episodes.jsonl").write_text("".join(json.dumps(entry) + "\n" for entry in records))


def test_episodes_of_two_engines_make_no_table(tmp_path):
    two_kinds(tmp_path, engine="mujoco")
    words = r"episodes of several engines \(1 by mujoco, 1 by pybullet\) make no table"
    with pytest.raises(MixedEngines, match=words):
        read_episodes(tmp_path)


def test_the_report_shows_each_engine_apart(tmp_path):
    two_kinds(tmp_path, engine="mujoco")
    sources = find_sources(tmp_path, tmp_path / "report")
    assert [source.title for source in sources] == [f"{tmp_path.name}, pybullet", f"{tmp_path.name}, mujoco"]
    assert [[each.seed for each in source.episodes] for source in sources] == [[0], [1]]
    assert commands(sources[1]) == [
        f"smash episodes again/{tmp_path.name} --seeds 2 --policy open --engine mujoco",
        f"python -m smash_analysis.engines again/{tmp_path.name}    # both engines, paired",
    ]


def test_episodes_of_two_robots_make_no_table_and_old_ones_are_the_panda_s(tmp_path):
    two_kinds(tmp_path, robot="six-1234abcd")
    words = r"episodes of several robots \(1 by panda, 1 by six-1234abcd\) make no table"
    with pytest.raises(MixedRobots, match=words):
        read_episodes(tmp_path)
    sources = find_sources(tmp_path, tmp_path / "report")
    assert [source.title for source in sources] == [
        f"{tmp_path.name}, pybullet",
        f"{tmp_path.name}, pybullet, six-1234abcd",
    ]
    assert commands(sources[1])[0].endswith("--engine pybullet --robot six.toml")


def test_scenes_are_not_put_together(tmp_path):
    records = [
        record("a", variant, seconds * slower) | {"scene": scene, "key": f"{variant}/{scene}"}
        for scene, slower in ((None, 1.0), ("default pace=0.1", 3.0))
        for variant, seconds in (("topple", 33.0), ("no-topple", 30.0))
    ]
    (tmp_path / "episodes.jsonl").write_text("".join(json.dumps(each) + "\n" for each in records))
    make(tmp_path, tmp_path / "out")
    text = (tmp_path / "out" / "tables.md").read_text()
    assert SEVERAL in text
    assert "Where topple took longer: 2 pairs" in text
    assert "| smash, open, default pace=0.1 |" in text
    episodes = by_scene(read_episodes(tmp_path))
    assert paired_table(episodes)["without [s]"].tolist() == ["30.0", "90.0"]
    assert slower_table(episodes)["lost [s]"].tolist() == ["9.0", "3.0"]
