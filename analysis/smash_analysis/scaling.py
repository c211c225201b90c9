"""Scaling: time against blocks as log-log curves, with growth exponents, from the records of `smash scaling`."""

from __future__ import annotations

import math
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
import pandas as pd

from smash.problem.words import counted
from smash.records.runs import RunRecord
from smash_analysis import command
from smash_analysis.charts.panels import Chart, Panel, curves
from smash_analysis.tables.believed import runs_of
from smash_analysis.tables.runs import runs_table
from smash_analysis.tables.writing import markdown, write_csv

if TYPE_CHECKING:
    from matplotlib.axes import Axes

PAPERS_FIRST_FEASIBLE = {4: (0.13, 0.22), 6: (0.49, 0.66), 9: (2.8, 3.9)}
"""Blocks -> seconds to the first feasible solution that the paper reports (Gurobi, least and most of its settings)."""
PAPERS_BARS = "paper, Gurobi, first feasible"
MARGIN = 1.4
"""Beside the fewest and the most blocks, a factor."""
GROUP = ["label", "variant", "room"]
MEASURES = {"first_seconds": "first plan", "proof_seconds": "proven optimum"}


def scaling_cells(records: Sequence[RunRecord]) -> pd.DataFrame:
    """Return one row per planner, variant, room and size: shares, medians of times, mean cost and gap.

    `room` is the number of buffers as it was chosen: 0, 12, or `blocks` (as many as blocks).
    """
    runs = runs_table(records)
    runs["room"] = np.where(runs["buffers"] == runs["blocks"], "blocks", runs["buffers"].astype(str))
    # A run of milliseconds may end before its supervisor has looked at the clock: the last plan's time is a floor.
    runs["proof_seconds"] = runs[["wall_seconds", "best_seconds"]].max(axis=1).where(runs["proven"])
    runs["gap"] = 100 * (1 - runs["lower_bound"].astype(float) / runs["cost"]).where(runs["cost"] > 0)
    rows = []
    for (label, variant, room, blocks, stacks), part in runs.groupby([*GROUP, "blocks", "stacks"], sort=True):
        rows.append(
            {
                "label": label,
                "variant": variant,
                "room": room,
                "blocks": blocks,
                "stacks": stacks,
                "runs": len(part),
                "solved": int(part["solved"].sum()),
                "proven": int(part["proven"].sum()),
                "first_seconds": part["first_seconds"].median(),
                "proof_seconds": part["proof_seconds"].median(),
                "worst_proof_seconds": part["proof_seconds"].max(),
                "mean_cost": part["cost"].mean(),
                "mean_gap_percent": part["gap"].mean(),
            }
        )
    return pd.DataFrame(rows)


def exponent(blocks: list[float], seconds: list[float]) -> float:
    """Return the slope of log seconds over log blocks by least squares; NaN with fewer than three sizes."""
    points = [(math.log(b), math.log(s)) for b, s in zip(blocks, seconds, strict=True) if s > 0 and math.isfinite(s)]
    if len(points) < 3:
        return math.nan
    slope = np.polyfit([x for x, _ in points], [y for _, y in points], 1)[0]
    return float(slope)


def exponent_table(cells: pd.DataFrame) -> pd.DataFrame:
    """Return growth exponents of both times and the largest size with every instance proven, a row per curve."""
    rows = []
    for (label, variant, room), part in cells.groupby(GROUP, sort=True):
        proven = part[part["proven"] == part["runs"]]
        row = {"planner": label, "variant": variant, "buffers": room}
        for column, words in MEASURES.items():
            slope = exponent(part["blocks"].tolist(), part[column].tolist())
            row[f"exponent, {words}"] = "–" if math.isnan(slope) else f"{slope:.2f}"
        row["most blocks, all solved"] = (
            str(int(part[part["solved"] == part["runs"]]["blocks"].max() or 0))
            if (part["solved"] == part["runs"]).any()
            else "–"
        )
        row["most blocks, all proven"] = "–" if proven.empty else str(int(proven["blocks"].max()))
        rows.append(row)
    return pd.DataFrame(rows)


def scaling_chart(cells: pd.DataFrame, column: str) -> Chart:
    """Return median seconds over blocks on log axes: a panel per variant and room, a curve per planner that has any."""
    variants, rooms = sorted(cells["variant"].unique()), sorted(cells["room"].unique())
    legend = curves(sorted(cells[cells[column].notna()]["label"].unique()))
    least, most = cells["blocks"].min() / MARGIN, cells["blocks"].max() * MARGIN

    def panel(variant: str, room: str) -> Panel:
        part = cells[(cells["variant"] == variant) & (cells["room"] == room)]

        def draw(axis: Axes) -> None:
            for curve in legend:
                mine = part[part["label"] == curve.name]
                axis.plot(mine["blocks"], mine[column], marker="o", markersize=3, lw=1.5, **curve.style())
            _mark_paper(axis)
            axis.set_xscale("log")
            axis.set_yscale("log")
            axis.set_xlim(least, most)
            axis.xaxis.set_major_formatter("{x:g}")
            axis.xaxis.set_minor_formatter("")
            axis.yaxis.set_major_formatter("{x:g}")

        words = "as many buffers as blocks" if room == "blocks" else counted(int(room), "buffer")
        return Panel(
            f"{variant}, {words}", draw, f"{MEASURES[column]}, median seconds over blocks, both axes logarithmic"
        )

    rows = [[panel(variant, room) for room in rooms] for variant in variants]
    return Chart(rows, "blocks", f"{MEASURES[column]}, median [s]", legend)


def _mark_paper(axis: Axes) -> None:
    """Mark the paper's seconds to a first feasible solution as upright bars."""
    for number, (blocks, (least, most)) in enumerate(PAPERS_FIRST_FEASIBLE.items()):
        name = PAPERS_BARS if number == 0 else "_"
        axis.plot([blocks, blocks], [least, most], color="black", lw=4, solid_capstyle="butt", alpha=0.55, label=name)


def make(results: Path, out: Path) -> list[Path]:
    """Write the table (CSV and Markdown) and the curves (PNG and PDF); return the files.

    Raises:
        MalformedFile: where there is nothing to read.
    """
    cells = scaling_cells(runs_of(results))
    out.mkdir(parents=True, exist_ok=True)
    files = [out / "scaling.csv", out / "scaling.md"]
    write_csv(cells, files[0])
    shown = cells.copy()
    for column in ("first_seconds", "proof_seconds", "worst_proof_seconds"):
        shown[column] = [f"{value:.3g}" if math.isfinite(value) else "–" for value in shown[column]]
    for column in ("mean_cost", "mean_gap_percent"):
        shown[column] = [f"{value:.1f}" if math.isfinite(value) else "–" for value in shown[column]]
    files[1].write_text(f"{markdown(exponent_table(cells))}\n{markdown(shown)}", encoding="utf-8")
    for column in MEASURES:
        figure = scaling_chart(cells, column).figure()
        for ending in ("png", "pdf"):
            files.append(out / f"{column.replace('_', '-')}.{ending}")
            figure.savefig(files[-1], dpi=200)
    return files


def main() -> None:
    """Make the scaling tables and curves and say where they are."""
    command.run("scaling", __doc__, make, shown="scaling.md")


if __name__ == "__main__":
    main()
