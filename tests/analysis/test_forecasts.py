import json

import pandas as pd
import pytest
from smash_analysis.forecasts import chart, error_table, forecast_table, objective_table, read_default

from tests.analysis.test_execution_tables import record


class Run:
    def __init__(self, key, objective, label, expected=None):
        self.key, self.objective, self.label, self.expected_seconds = key, objective, label, expected
        self.planner = label.split(",")[0]


RUNS = [
    Run("quick", "seconds", "smash, seconds", 47.5),
    Run("few", "actions", "smash"),
    Run("bare", "actions", "smash"),
]


def episodes(quick=50.0):
    rows = [("quick", "topple", quick), ("few", "topple", 60.0), ("bare", "no-topple", 100.0)]
    return pd.DataFrame(
        {
            "run": key,
            "suite": "multi-9",
            "instance": "one",
            "label": next(run.label for run in RUNS if run.key == key),
            "variant": variant,
            "policy": "replan",
            "seed": 0,
            "replans": 0,
            "success": True,
            "execution_seconds": seconds,
        }
        for key, variant, seconds in rows
    )


def test_an_error_is_a_share_of_what_the_episode_took():
    forecasts = forecast_table(RUNS, episodes())
    assert forecasts["error"].tolist() == pytest.approx([-0.05])
    assert error_table(forecasts)["median absolute error [%]"].tolist() == ["5.0"]


def test_what_topple_saves_is_against_the_plan_without_of_the_fewest_actions():
    table = objective_table(RUNS, episodes())
    assert [saved.split()[0] for saved in table["saved [%]"]] == ["40.0", "50.0"]
    assert table["slower by more than 5 %"].tolist() == [0, 0]


def test_a_loss_is_counted_and_named():
    table = objective_table(RUNS, episodes(quick=120.0))
    assert table["slower by more than 5 %"].tolist() == [0, 1]
    assert table["worst"].tolist()[1] == "one: -20 %"


def test_the_plot_has_a_panel_for_each_set():
    assert [[panel.title for panel in row] for row in chart(forecast_table(RUNS, episodes())).rows] == [
        ["multi-9: 1 episode, median error 5.0 %"]
    ]
    chart(forecast_table(RUNS, episodes())).figure()


def test_topple_is_compared_by_one_planner_each_alone():
    others = [Run(f"other {run.key}", run.objective, run.label.replace("smash", "other")) for run in RUNS]
    few = Run("third", "actions", "third")
    theirs = episodes().assign(
        run=[run.key for run in others], label=[run.label for run in others], execution_seconds=[10.0, 20.0, 40.0]
    )
    none = episodes().tail(1).assign(run="third", label="third", execution_seconds=1.0)
    table = objective_table([*RUNS, *others, few], pd.concat([episodes(), theirs, none]))
    assert table["planner"].tolist() == ["other", "other, seconds", "smash", "smash, seconds"]
    assert table["planner without"].tolist() == ["other", "other", "smash", "smash"]
    assert table["without [s]"].tolist() == ["40.0", "40.0", "100.0", "100.0"]


def test_forecasts_are_of_the_built_in_scene_as_it_is(tmp_path, capsys):
    scenes = (None, "default pace=0.1", "default exact")
    rows = [record("a", "topple", 20.0) | {"scene": scene, "key": str(scene)} for scene in scenes]
    (tmp_path / "episodes.jsonl").write_text("".join(json.dumps(row) + "\n" for row in rows))
    assert read_default(tmp_path)["key"].tolist() == ["None"]
    assert "2 episodes in another scene, noise or pace left out" in capsys.readouterr().err
    assert forecast_table(RUNS, read_default(tmp_path)).empty
