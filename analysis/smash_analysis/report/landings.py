"""The section on topples: how often one of each cut and size goes well, and where the blocks land."""

from __future__ import annotations

from functools import partial
from typing import TYPE_CHECKING

import pandas as pd

from smash.records.trials import Trial
from smash_analysis.charts.heatmaps import SUCCESS_COLOURS
from smash_analysis.charts.panels import COLOURS, Chart, Curve, Panel
from smash_analysis.report.blocks import Block, Cell, ChartBlock, Grid, GridBlock
from smash_analysis.report.grids import Shades
from smash_analysis.statistics.intervals import wilson
from smash_analysis.tables.writing import share

if TYPE_CHECKING:
    from matplotlib.axes import Axes

GRASPABLE = Curve("can be grasped", COLOURS[0], "")
LOST = Curve("cannot be grasped from above", COLOURS[1], "")
REACH = ((-12, 90), (-25, 25))
"""Least ranges of the axes along and aside of the push [cm]; they grow with the landings."""


def landing_blocks(trials: list[Trial]) -> list[Block]:
    """Return the share of successes by cut and size, and a landing map for each."""
    cuts, sizes = sorted({t.height for t in trials}), sorted({t.falling for t in trials})
    groups: dict[tuple[int, int], list[int]] = {}
    for number, trial in enumerate(trials):
        groups.setdefault((trial.height, trial.falling), []).append(number)
    shade = Shades(SUCCESS_COLOURS, 0, 1)

    def cell(cut: int, size: int) -> Cell | None:
        numbers = groups.get((cut, size))
        if numbers is None:
            return None
        good, total = sum(trials[n].success for n in numbers), len(numbers)
        low, high = wilson(good, total)
        words = f"cut at height {cut}, {size} blocks falling: {good} of {total} topples go well"
        words += f", 95 % interval {100 * low:.0f} to {100 * high:.0f} %"
        return Cell(f"{good}/{total}", *shade(good / total), words, [[n] for n in numbers])

    grid = Grid(
        "Topples that go well",
        "blocks that fall",
        "cut at height",
        [str(size) for size in sizes],
        [str(cut) for cut in reversed(cuts)],
        [[cell(cut, size) for size in sizes] for cut in reversed(cuts)],
    )
    rows = []
    for (cut, size), numbers in sorted(groups.items()):
        good = sum(trials[n].success for n in numbers)
        rows.append(
            {"cut at height": cut, "falling": size, "go well": share(good, len(numbers)), "trials": len(numbers)}
        )
    note = (
        "A topple goes well where what should stand still stands, and every toppled block can be grasped where it lies."
    )
    return [
        GridBlock("topples", "Which topples go well", "trials", [grid], pd.DataFrame(rows), note=note),
        ChartBlock(
            "landings",
            "Where toppled blocks land",
            _chart(trials, groups, cuts, sizes),
            "Seen from above, in the push's frame: along the push to the right, from the pile's middle (square).",
        ),
    ]


def landing_headlines(trials: list[Trial]) -> list[str]:
    """Return how many topples go well, and the sizes that always do."""
    good = sum(trial.success for trial in trials)
    lines = [f"{good} of {len(trials)} topples go well ({share(good, len(trials))})."]
    sizes = sorted({trial.falling for trial in trials})
    sure = [n for n in sizes if all(trial.success for trial in trials if trial.falling == n)]
    if sure:
        lines.append(f"No failure with {', '.join(map(str, sure))} falling blocks, at any cut that was tried.")
    return lines


def _chart(trials: list[Trial], groups: dict[tuple[int, int], list[int]], cuts: list[int], sizes: list[int]) -> Chart:
    points = [landing for trial in trials for landing in trial.landings]
    limits = []
    for name, (least, most) in zip(("along", "aside"), REACH, strict=True):
        values = [100 * getattr(point, name) for point in points]
        limits.append((min([least, *(v - 3 for v in values)]), max([most, *(v + 3 for v in values)])))

    def draw(axis: Axes, numbers: list[int]) -> None:
        axis.plot(0, 0, "s", color="#777777", markersize=6, label="_")
        for curve, graspable, marker in ((GRASPABLE, True, "o"), (LOST, False, "x")):
            mine = [p for n in numbers for p in trials[n].landings if p.graspable == graspable]
            across, upward = [100 * p.along for p in mine], [100 * p.aside for p in mine]
            axis.plot(
                across, upward, marker, color=curve.colour, markersize=3.5, label=curve.name, gid=f"curve:{curve.name}"
            )
        axis.set(xlim=limits[0], ylim=limits[1])
        axis.set_aspect("equal")

    def panel(cut: int, size: int) -> Panel:
        numbers = groups.get((cut, size), [])
        good = sum(trials[n].success for n in numbers)
        lands = sum(len(trials[n].landings) for n in numbers)
        words = f"{lands} landings of {len(numbers)} topples, {good} of which go well"
        return Panel(f"cut at {cut}, {size} falling: {good}/{len(numbers)}", partial(draw, numbers=numbers), words)

    rows = [[panel(cut, size) for size in sizes] for cut in cuts]
    return Chart(rows, "along the push [cm]", "aside [cm]", [GRASPABLE, LOST], panel_size=(3.3, 1.75))
