"""Heatmaps whose cells know the runs behind them: budget x buffers, planner x set, cut x blocks that fall."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import partial
from typing import Any

import pandas as pd

from smash.records.runs import RunRecord
from smash_analysis.charts.heatmaps import (
    ACTION_COLOURS,
    GAIN_COLOURS,
    SUCCESS_COLOURS,
    ink,
    planner_figure,
    ratio_place,
    ratio_reach,
)
from smash_analysis.report.blocks import Cell, Grid, GridBlock
from smash_analysis.report.stores import seconds
from smash_analysis.statistics.findings import planner_findings, smallest_buffers
from smash_analysis.statistics.intervals import FEWEST_UNITS, wilson
from smash_analysis.tables.cells import matched_cells, variant_cells
from smash_analysis.tables.readings import readings
from smash_analysis.tables.runs import runs_table
from smash_analysis.tables.writing import ablation_table

VARIANT_WORDS = {"no-topple": "without topple", "topple": "with topple"}

CAPPED = "max-topple-"


class Shades:
    """Colours of a scale, with an ink that can be read on each."""

    def __init__(self, colours: str, low: float, high: float) -> None:
        import matplotlib as mpl

        self._colours = mpl.colormaps[colours]
        self._low, self._width = low, max(high - low, 1e-9)

    def __call__(self, value: float) -> tuple[str, str]:
        """Return (background, ink) as CSS colours."""
        red, green, blue, _ = self._colours(min(1.0, max(0.0, (value - self._low) / self._width)))
        return f"#{round(255 * red):02x}{round(255 * green):02x}{round(255 * blue):02x}", ink(red, green, blue)


def variant_words(variant: str) -> str:
    """Return what a variant is called in a title."""
    if variant.startswith(CAPPED):
        return f"with topples of at most {variant.removeprefix(CAPPED)}"
    return VARIANT_WORDS.get(variant, variant)


def ablation_grids(records: list[RunRecord]) -> list[GridBlock]:
    """Return budget x buffer heatmaps, a block per planner and suite that was run at several of each."""
    read = readings(records)
    blocks: list[GridBlock] = []
    if read.empty:
        return blocks
    runs = runs_table(records)
    cells, matched = variant_cells(read), matched_cells(read)
    for (label, suite), part in read.groupby(["label", "suite"], sort=False):
        if part["buffers"].nunique() < 2 or part["budget"].nunique() < 2:
            continue
        mine = cells[(cells["label"] == label) & (cells["suite"] == suite)]
        pairs = matched[(matched["label"] == label) & (matched["suite"] == suite)]
        table = runs[(runs["label"] == label) & (runs["suite"] == suite) & (runs["kind"] != "cutoff")]
        blocks.append(
            GridBlock(
                name=f"heatmap-{label}-{suite}",
                title=f"{label} on {suite}",
                store="runs",
                grids=_Ablation(part, mine, pairs).grids(),
                frame=ablation_table(table).drop(columns=["planner", "suite"]),
                lines=planner_findings(mine, pairs),
                picture=partial(planner_figure, str(label), str(suite), mine, pairs),
                fold=True,
                opened=not blocks,
                summary=_summary(mine, pairs),
            )
        )
    return blocks


def _summary(cells: pd.DataFrame, pairs: pd.DataFrame) -> str:
    """Return the figures of a folded heatmap: B90 at the largest budget per variant, and the middle ratio."""
    said = []
    for variant in ("no-topple", "topple"):
        mine = cells[cells["variant"] == variant]
        if len(mine):
            fewest = smallest_buffers(mine, every_budget=False)
            said.append(f"{'none' if fewest is None else fewest} {variant_words(variant)}")
    words = f"B90 at {cells['budget'].max():g} s: {', '.join(said)}"
    ratios = pairs["ratio_common"].dropna()
    return words + (f"; without / with topple: {ratios.median():.2f} (median)" if len(ratios) else "")


class _Ablation:
    """The grids of one planner on one suite."""

    def __init__(self, read: pd.DataFrame, cells: pd.DataFrame, matched: pd.DataFrame) -> None:
        self.budgets = sorted(read["budget"].unique())
        self.buffers = sorted(read["buffers"].unique(), reverse=True)
        present = set(cells["variant"])
        self.variants = [v for v in ("no-topple", "topple") if v in present]
        self.variants += sorted(present - set(self.variants))
        self.cells = {(row["variant"], row["buffers"], row["budget"]): row for _, row in cells.iterrows()}
        self.matched = {(row["buffers"], row["budget"]): row for _, row in matched.iterrows()}
        self.behind: dict[tuple[str, int, float], list[list[Any]]] = {}
        for row in read.to_dict("records"):
            found = [f"{row['cost']:.0f}", seconds(row["seconds"])] if row["solved"] else ["–", "–"]
            key = str(row["variant"]), int(row["buffers"]), float(row["budget"])
            self.behind.setdefault(key, []).append([int(row["run"]), *found])
        costs = cells["mean_cost"].dropna()
        low, high = (float(costs.min()), float(costs.max())) if len(costs) else (0.0, 1.0)
        self.success, self.actions = Shades(SUCCESS_COLOURS, 0, 1), Shades(ACTION_COLOURS, low, max(high, low + 1))
        self.reach = ratio_reach(matched["ratio_common"].dropna())
        self.ratio, self.gain = Shades(GAIN_COLOURS, 0, 1), Shades(GAIN_COLOURS, -1, 1)

    def grids(self) -> list[Grid]:
        """Return success and actions per variant, and where there are both, what topple gains and saves."""
        success = [self._grid(f"Success [%], {variant_words(v)}", partial(self._success, v)) for v in self.variants]
        actions = [self._grid(f"Mean actions, {variant_words(v)}", partial(self._actions, v)) for v in self.variants]
        if self.matched:
            success.append(self._grid("Success gained by topple [points]", self._gain))
            actions.append(self._grid("Actions without / with topple", self._ratio))
        return success + actions

    def _grid(self, title: str, cell: Callable[[int, float], Cell | None]) -> Grid:
        return Grid(
            title=title,
            across="budget [s]",
            upward="B",
            columns=[f"{budget:g}" for budget in self.budgets],
            rows=[f"{count:g}" for count in self.buffers],
            cells=[[cell(count, budget) for budget in self.budgets] for count in self.buffers],
            extra=["cost by then", "found at [s]"],
        )

    def _success(self, variant: str, buffers: int, budget: float) -> Cell | None:
        row = self.cells.get((variant, buffers, budget))
        if row is None:
            return None
        low, high = 100 * row["success_low"], 100 * row["success_high"]
        words = f"{row['solved']} of {row['runs']} with a plan, 95 % interval {low:.0f} to {high:.0f} %"
        text = f"{100 * row['success']:.0f}"
        return self._cell(text, self.success(row["success"]), words, [variant], buffers, budget, row["runs"])

    def _actions(self, variant: str, buffers: int, budget: float) -> Cell | None:
        row = self.cells.get((variant, buffers, budget))
        if row is None:
            return None
        if not row["solved"]:
            return self._cell("", ("", ""), "no plan", [variant], buffers, budget)
        spread = "" if pd.isna(row["std_cost"]) else f" ± {row['std_cost']:.1f}"
        words = f"{row['mean_cost']:.2f}{spread} actions, mean of the {row['solved']} of {row['runs']} solved here"
        shade = self.actions(row["mean_cost"])
        return self._cell(f"{row['mean_cost']:.1f}", shade, words, [variant], buffers, budget, row["solved"])

    def _gain(self, buffers: int, budget: float) -> Cell | None:
        row = self.matched.get((buffers, budget))
        if row is None:
            return None
        gain = (row["solved_with"] - row["solved_without"]) / row["runs"]
        words = f"{row['solved_with']} of {row['runs']} with topple, {row['solved_without']} without"
        text = f"{100 * gain:+.0f}" if gain else "0"
        return self._cell(text, self.gain(gain), words, ["no-topple", "topple"], buffers, budget, row["runs"])

    def _ratio(self, buffers: int, budget: float) -> Cell | None:
        row = self.matched.get((buffers, budget))
        if row is None:
            return None
        both = ["no-topple", "topple"]
        if pd.isna(row["ratio_common"]):
            return self._cell("", ("", ""), "no instance that both solved", both, buffers, budget)
        words = f"{row['ratio_common']:.3f}, on the {row['common']} of {row['runs']} instances that both solved"
        shade = self.ratio(ratio_place(row["ratio_common"], self.reach))
        return self._cell(f"{row['ratio_common']:.2f}", shade, words, both, buffers, budget, row["common"])

    def _cell(
        self,
        text: str,
        colours: tuple[str, str],
        words: str,
        variants: Sequence[str],
        buffers: int,
        budget: float,
        instances: int = 0,
    ) -> Cell:
        """Return a cell; `instances` is how many its figure stands for."""
        entries = [entry for v in variants for entry in self.behind.get((v, buffers, budget), [])]
        named = " and ".join(variant_words(v) for v in variants)
        few = int(instances) if instances < FEWEST_UNITS else 0
        return Cell(text, *colours, f"{named}, B = {buffers:g}, {budget:g} s: {words}", entries, few)


def coverage_grids(records: list[RunRecord], kept: Sequence[int], runs: pd.DataFrame) -> GridBlock:
    """Return planner x suite: how many problems have a plan, and how many a proof, a grid per variant and question.

    Args:
        records: all runs of the section.
        kept: the places in `records` of the rows of `runs`.
        runs: `compared` table of the runs at the largest budget.
    """
    table = runs.assign(run=list(kept))
    suites = list(dict.fromkeys(table["suite"]))
    grids = [
        _coverage_grid(mine, suites, column, f"{words}, {variant_words(str(variant))}")
        for variant, mine in table.groupby("variant", sort=False)
        for column, words in (("solved", "with a plan"), ("proven", "proven optimal"))
    ]
    return GridBlock("coverage-table", "Who answers what", "runs", grids, _coverage_frame(table))


def _coverage_grid(table: pd.DataFrame, order: Sequence[str], column: str, words: str) -> Grid:
    """Return planner x suite (those of the table, in `order`) of one variant: in how many runs `column` holds.

    Args:
        table: runs of the variant.
        order: suites of all variants.
        column: what is counted.
        words: the same in words.
    """
    shade = Shades(SUCCESS_COLOURS, 0, 1)
    labels, suites = list(dict.fromkeys(table["label"])), [suite for suite in order if (table["suite"] == suite).any()]
    groups = dict(list(table.groupby(["label", "suite"])))

    def cell(label: str, suite: str) -> Cell | None:
        part = groups.get((label, suite))
        if part is None:
            return None
        count, total = int(part[column].sum()), len(part)
        low, high = wilson(count, total)
        said = f"{label} on {suite}: {count} of {total} {words}, 95 % interval {100 * low:.0f} to {100 * high:.0f} %"
        return Cell(f"{count}/{total}", *shade(count / total), said, [[int(run)] for run in part["run"]])

    cells = [[cell(label, suite) for suite in suites] for label in labels]
    return Grid(words.capitalize(), "instance set", "planner", suites, labels, cells, wide=True)


def _coverage_frame(table: pd.DataFrame) -> pd.DataFrame:
    rows = []
    for (label, suite, variant), part in table.groupby(["label", "suite", "variant"], sort=False):
        solved, proven = int(part["solved"].sum()), int(part["proven"].sum())
        rows.append(
            {
                "planner": label,
                "suite": suite,
                "variant": variant,
                "with a plan": f"{solved}/{len(part)}",
                "proven optimal": f"{proven}/{len(part)}",
            }
        )
    return pd.DataFrame(rows)
