"""The exact cost against the number of buffers, with and without topple."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from statistics import mean
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

VARIANTS = ((False, "without topple", "#b2552b", "o"), (True, "with topple", "#2b6cb2", "s"))


def frontier_figure(rows: Sequence[Mapping[str, Any]], title: str) -> Figure:
    """Draw the mean cost over the instances that have a plan at every number of buffers, and each instance thinly.

    Args:
        rows: `instance`, `buffers`, `topple`, `status` and `cost` of each solve; an unproven cost is drawn open.
        title: what was solved.
    """
    import matplotlib as mpl
    from matplotlib.figure import Figure
    from matplotlib.ticker import MaxNLocator

    mpl.rcParams.update({"font.size": 9, "pdf.fonttype": 42})
    figure = Figure(figsize=(5.2, 3.4), layout="constrained")
    axis = figure.subplots()
    for topple, name, colour, marker in VARIANTS:
        part = [row for row in rows if row["topple"] == topple]
        _draw(axis, part, name, colour, marker)
    axis.set_xlabel("buffers")
    axis.set_ylabel("fewest actions")
    axis.set_title(title)
    axis.set_ylim(bottom=0)
    axis.xaxis.set_major_locator(MaxNLocator(integer=True))
    axis.grid(axis="y", alpha=0.3)
    axis.legend(frameon=False)
    return figure


def _draw(axis: Axes, rows: Sequence[Mapping[str, Any]], name: str, colour: str, marker: str) -> None:
    counts = sorted({row["buffers"] for row in rows})
    costs = {(row["instance"], row["buffers"]): row["cost"] for row in rows if row["cost"] is not None}
    instances = sorted({row["instance"] for row in rows})
    whole = [instance for instance in instances if all((instance, count) in costs for count in counts)]
    unproven = [row for row in rows if row["status"] == "feasible"]
    if len(instances) > 1:
        for instance in instances:
            known = [count for count in counts if (instance, count) in costs]
            axis.plot(known, [costs[instance, count] for count in known], color=colour, alpha=0.15, linewidth=0.8)
    if whole:
        means = [mean(costs[instance, count] for instance in whole) for count in counts]
        label = f"{name}, mean of {len(whole)}" if len(instances) > 1 else name
        axis.plot(counts, means, color=colour, marker=marker, markersize=4, linewidth=1.8, label=label)
    elif costs:
        axis.plot([], [], color=colour, marker=marker, label=f"{name} (not with every number of buffers)")
        known = [count for count in counts if (instances[0], count) in costs]
        axis.plot(known, [costs[instances[0], count] for count in known], color=colour, marker=marker, markersize=4)
    if unproven:
        points = [(row["buffers"], row["cost"]) for row in unproven]
        axis.plot(*zip(*points, strict=True), "x", color=colour, markersize=6, label=f"{name}: not proven")
