import json

import pandas as pd
import pytest
from smash_analysis.execution_sweeps import make, read_trials, saved_table, scene_table, size_table
from smash_analysis.execution_tables import read_episodes

from smash.problem.errors import MalformedFile
from tests.analysis.test_execution_tables import record


def trial(falling, good, scene="default", seed=0):
    landings = [{"level": 2 + level, "along": 0.1 * level, "aside": 0.0, "graspable": good} for level in range(falling)]
    plain = {
        "format": "smash-topple-trial/1",
        "scene": scene,
        "layout": scene,
        "stack": 0,
        "height": 2,
        "falling": falling,
        "seed": seed,
    }
    return {**plain, "moved": 0.001, "stands": True, "landings": landings, "problem": ""}


@pytest.fixture
def results(tmp_path):
    records = [
        {**(row := record(name, variant, seconds)), "scene": scene, "key": f"{row['key']}/{scene}"}
        for scene, slower in ((None, 0.0), ("friction-0.40", 12.0))
        for name in ("a", "b")
        for variant, seconds in (("topple", 20.0 + slower), ("no-topple", 30.0))
    ]
    (tmp_path / "episodes.jsonl").write_text("".join(json.dumps(r) + "\n" for r in records))
    trials = [trial(1, True), trial(1, True, seed=1), trial(2, False), trial(1, False, "rough")]
    (tmp_path / "trials.jsonl").write_text("".join(json.dumps(t) + "\n" for t in trials))
    return tmp_path


def test_topple_may_save_time_in_one_scene_and_lose_it_in_another(results):
    episodes = read_episodes(results)
    episodes["scene"] = episodes["scene"].fillna("default")
    saved = saved_table(episodes).set_index("scene")["saved [%]"]
    assert saved.to_dict() == {"default": "33", "friction-0.40": "-7"}


def test_scenes_are_compared_on_what_is_successful_in_all_of_them(results):
    episodes = read_episodes(results)
    episodes["scene"] = episodes["scene"].fillna("default")
    hard = {"instance": "a", "variant": "topple", "scene": "friction-0.40"}
    lost = pd.concat([episodes[name] == value for name, value in hard.items()], axis=1).all(axis=1)
    episodes.loc[lost, "success"] = False
    episodes.loc[episodes["instance"] == "b", "execution_seconds"] += 1.0
    table = scene_table(episodes).set_index(["scene", "variant"])
    assert table["compared on, instances (episodes)"].tolist() == ["2 (2)", "1 (1)"] * 2
    assert table.loc[("default", "topple"), "execution [s]"] == "21.0"
    assert table.loc[("friction-0.40", "topple"), "execution [s]"] == "33.0"
    assert table.loc[("friction-0.40", "topple"), "success"].startswith("0.50")


def test_topples_are_counted_by_size_and_scene(results):
    table = size_table(read_trials([results])).set_index("scene")
    assert table.loc["default", "1 falling"].startswith("2/2")
    assert table.loc["default", "2 falling"].startswith("0/1")
    assert table.loc["rough", "2 falling"] == "–"


def test_tables_and_plot_are_written(results, tmp_path):
    text, picture = make(results, [results], tmp_path / "out")
    assert "friction-0.40" in text.read_text()
    assert picture.read_bytes().startswith(b"\x89PNG")


def test_no_trials_are_named(tmp_path):
    with pytest.raises(MalformedFile, match=r"trials\.jsonl"):
        read_trials([tmp_path])
