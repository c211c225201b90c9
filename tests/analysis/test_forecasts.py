import pandas as pd
import pytest
from smash_analysis.forecasts import chart, error_table, forecast_table, objective_table


class Run:
    def __init__(self, key, objective, label, expected=None):
        self.key, self.objective, self.label, self.expected_seconds = key, objective, label, expected


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
        ["multi-9: 1 episodes, median error 5.0 %"]
    ]
    chart(forecast_table(RUNS, episodes())).figure()
