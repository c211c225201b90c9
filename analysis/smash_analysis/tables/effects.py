"""Effects on the same problems as tables of texts, the coverage of both sides beside every figure."""

from __future__ import annotations

from collections.abc import Mapping

import pandas as pd

from smash_analysis.statistics.effects import Effect
from smash_analysis.tables.writing import median_iqr, rate_cell, with_spread


def topple_table(effects: list[Effect]) -> pd.DataFrame:
    """Return the effects of topple as texts: coverage of both sides, then figures over the common instances alone."""
    names = {"label": "planner", "buffers": "B"}
    rows = []
    for effect in effects:
        pair = effect.pair
        fewer, equal, more = pair.tally
        about = {names.get(name, name): value for name, value in effect.about.items()}
        rows.append(
            {
                **_first(about, {"saved, mean [95 %] (range)": with_spread(pair.mean, pair.interval, pair.units)}),
                "saved, median [IQR]": median_iqr(pd.Series(pair.differences), 1),
                "ratio [95 %] (range)": with_spread(pair.ratio, pair.ratio_interval, pair.units, 2),
                "without": figure(pair.left_mean),
                "with": figure(pair.right_mean),
                "shorter / same / longer": f"{fewer} / {equal} / {more}",
                "common instances": pair.units,
                "solved without": rate_cell(pair.left_rate, "problem"),
                "solved with": rate_cell(pair.right_rate, "problem"),
            }
        )
    return pd.DataFrame(rows)


def _first(about: Mapping[str, object], saved: Mapping[str, object]) -> dict[str, object]:
    """Return what names a row with what was saved behind its first column: where a narrow page shows it."""
    (first, *others) = about.items()
    return dict([first, *saved.items(), *others])


def planner_table(effects: list[Effect], reference: str) -> pd.DataFrame:
    """Return planners against the reference as texts."""
    rows = []
    for effect in effects:
        pair = effect.pair
        more, equal, fewer = pair.tally
        rows.append(
            {
                **effect.about,
                "solved": rate_cell(pair.left_rate, "problem"),
                f"solved, {reference}": rate_cell(pair.right_rate, "problem"),
                "common instances": pair.units,
                "actions": figure(pair.left_mean),
                f"actions, {reference}": figure(pair.right_mean),
                "ratio [95 %] (range)": with_spread(pair.ratio, pair.ratio_interval, pair.units, 2),
                "shorter / same / longer": f"{fewer} / {equal} / {more}",
            }
        )
    return pd.DataFrame(rows)


def figure(value: float, digits: int = 1) -> str:
    """Return a number, or a dash where there is none."""
    return "–" if pd.isna(value) else f"{value:.{digits}f}"
