"""The ablation in words, computed from the records: the paper's two figures, and whether they are met here."""

from __future__ import annotations

from collections.abc import Iterator

import pandas as pd

THRESHOLD = 0.9
"""The success rate that the paper asks of a buffer count ("at least 90 %")."""


def smallest_buffers(cells: pd.DataFrame, every_budget: bool) -> int | None:
    """Return the fewest buffers whose success reaches `THRESHOLD`, at the largest budget or at every one; None if none.

    Args:
        cells: `variant_cells` of one planner, suite and variant.
        every_budget: whether each budget must reach it.
    """
    reached = cells["success"] >= THRESHOLD
    if every_budget:
        good = reached.groupby(cells["buffers"]).all()
    else:
        largest = cells["budget"] == cells["budget"].max()
        good = reached[largest].groupby(cells["buffers"]).all()
    counts = good[good].index
    return int(counts.min()) if len(counts) else None


def findings(cells: pd.DataFrame, matched: pd.DataFrame, check: pd.DataFrame) -> str:
    """Return the findings as Markdown: per planner and suite the smallest B, the range of the ratio, the check."""
    lines = [
        "# Ablation: what the records say",
        "",
        f"Success is the share of runs with a plan, accepted by the law, by the budget. B90 is the fewest buffers "
        f"with at least {THRESHOLD:.0%} success. The paper reports B90 = 8 without topple and 0 with, and an "
        "action ratio (without / with topple, matched buffers and budget) of 1.5 to 7.",
    ]
    for (label, suite), part in cells.groupby(["label", "suite"]):
        pairs = matched[(matched["label"] == label) & (matched["suite"] == suite)]
        lines += ["", f"## {label} on {suite}", "", *(f"- {line}" for line in planner_findings(part, pairs))]
    lines += [
        "",
        "## Reading one anytime run at smaller budgets, against real cut-offs",
        "",
        *(f"- {line}" for line in cutoff_findings(check)),
    ]
    return "\n".join(lines) + "\n"


def planner_findings(cells: pd.DataFrame, pairs: pd.DataFrame) -> list[str]:
    """Return what one planner's cells of one suite say, a sentence each: B90 per variant, the range of the ratio."""
    return [*_thresholds(cells), *_ratios(pairs)]


def _thresholds(cells: pd.DataFrame) -> Iterator[str]:
    budgets = cells["budget"].unique()
    buffers = sorted(cells["buffers"].unique())
    tried = ", ".join(f"{count:g}" for count in buffers)
    for variant, part in cells.groupby("variant"):
        at_most = smallest_buffers(part, every_budget=False)
        always = smallest_buffers(part, every_budget=True)
        yield (
            f"{variant}: B90 = {_or_none(at_most)} at {max(budgets):g} s, {_or_none(always)} at every budget from "
            f"{min(budgets):g} s (B tried: {tried})"
        )


def _or_none(count: int | None) -> str:
    return "none of those tried" if count is None else str(count)


def _ratios(pairs: pd.DataFrame) -> Iterator[str]:
    if pairs.empty:
        return
    shared = pairs.dropna(subset=["ratio_common"])
    if shared.empty:
        yield "action ratio: no cell in which both variants solved one same instance"
    else:
        fewest, most = shared["common"].min(), shared["common"].max()
        yield (
            f"action ratio on instances that both solved: {_span(shared['ratio_common'])} over {len(shared)} of "
            f"{len(pairs)} cells ({fewest} to {most} instances a cell)"
        )
        yield (
            f"action ratio of the two means over all that each solved (different subsets, as two heatmaps are "
            f"divided): {_span(pairs['ratio_all'].dropna())}"
        )
    alone = ((pairs["solved_with"] > 0) & (pairs["solved_without"] == 0)).sum()
    reverse = ((pairs["solved_with"] == 0) & (pairs["solved_without"] > 0)).sum()
    yield f"cells with plans with topple alone: {alone}; without topple alone: {reverse}"


def _span(ratios: pd.Series[float]) -> str:
    return f"{ratios.min():.2f} to {ratios.max():.2f}, median {ratios.median():.2f}"


def cutoff_findings(check: pd.DataFrame) -> Iterator[str]:
    """Yield per planner how often real cut-offs agree with what one anytime run says about that budget."""
    if check.empty:
        yield "No run was repeated with real cut-offs."
        return
    for label, part in check.groupby("label"):
        same = part["solved_read"] == part["solved_cut"]
        both = part[part["solved_read"] & part["solved_cut"]]
        off = both["cost_cut"] - both["cost_read"]
        costs = (
            f"equal cost in {(off == 0).sum()} of {len(both)} solved in both, mean difference (cut off - read) "
            f"{off.mean():+.2f} actions"
            if len(both)
            else "none solved in both"
        )
        yield f"{label}: {len(part)} cut-offs, success the same in {same.sum()}; {costs}"
