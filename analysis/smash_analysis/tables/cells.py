"""Cells of the heatmaps: per planner, suite, variant, buffer count and budget over all instances."""

from __future__ import annotations

import pandas as pd

from smash_analysis.statistics.intervals import wilson
from smash_analysis.tables.readings import SETTING

CELL = ["label", "suite", "buffers", "budget"]
PROBLEM = ["instance", "seed"]


def variant_cells(read: pd.DataFrame) -> pd.DataFrame:
    """Return one row per cell and variant.

    Columns: `CELL`, variant, runs, solved, success (share), success_low, success_high (95 % Wilson), mean_cost,
    std_cost, median_cost (all three over the runs solved in this very cell).
    """
    grouped = read.groupby([*CELL, "variant"], sort=True)
    cells = grouped.agg(
        runs=("solved", "size"),
        solved=("solved", "sum"),
        mean_cost=("cost", "mean"),
        std_cost=("cost", "std"),
        median_cost=("cost", "median"),
    ).reset_index()
    cells["success"] = cells["solved"] / cells["runs"]
    bounds = [wilson(int(s), int(n)) for s, n in zip(cells["solved"], cells["runs"], strict=True)]
    cells["success_low"] = [low for low, _ in bounds]
    cells["success_high"] = [high for _, high in bounds]
    return cells


def matched_cells(read: pd.DataFrame, without: str = "no-topple", with_: str = "topple") -> pd.DataFrame:
    """Return, per cell, how no-topple compares with topple at the same planner, buffers and budget.

    Columns: `CELL`; `common` (instances that both solved here), `ratio_common` (mean actions without over mean
    actions with topple, over those instances: the same subset on both sides), `ratio_all` (the same of the
    means over all that each solved: different subsets, as a reader of two heatmaps would divide them),
    `solved_without`, `solved_with`, `runs` (instances tried by both).
    """
    keys = [*SETTING, "budget"]
    left = read[read["variant"] == without].drop(columns="variant")
    right = read[read["variant"] == with_].drop(columns="variant")
    keys.remove("variant")
    pairs = left.merge(right, on=keys, suffixes=("_without", "_with"))
    both = pairs["solved_without"] & pairs["solved_with"]
    common = pairs[both].groupby(CELL)[["cost_without", "cost_with"]].mean()
    cells = pairs.groupby(CELL).agg(
        runs=("solved_with", "size"),
        solved_without=("solved_without", "sum"),
        solved_with=("solved_with", "sum"),
        mean_without=("cost_without", "mean"),
        mean_with=("cost_with", "mean"),
    )
    cells["common"] = pairs[both].groupby(CELL).size()
    cells["common"] = cells["common"].fillna(0).astype(int)
    cells["ratio_common"] = _ratio(common["cost_without"], common["cost_with"])
    cells["ratio_all"] = _ratio(cells["mean_without"], cells["mean_with"])
    return cells.reset_index()


def _ratio(without: pd.Series[float], with_: pd.Series[float]) -> pd.Series[float]:
    return without / with_.where(with_ > 0)


def grid(cells: pd.DataFrame, column: str) -> pd.DataFrame:
    """Return one column of cells as a grid: rows are buffer counts, columns budgets, both ascending; NaN where none."""
    return cells.pivot(index="buffers", columns="budget", values=column).sort_index().sort_index(axis=1)
