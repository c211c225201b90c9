"""`python -m smash_analysis.ablation RESULTS`: the budget x buffer heatmaps of the paper's task-planning ablation."""

from __future__ import annotations

import re
from pathlib import Path

import pandas as pd

from smash_analysis import command
from smash_analysis.charts.heatmaps import planner_figure
from smash_analysis.statistics.conditions import conditions
from smash_analysis.statistics.findings import findings
from smash_analysis.tables.believed import runs_of
from smash_analysis.tables.cells import matched_cells, variant_cells
from smash_analysis.tables.latex import write_latex
from smash_analysis.tables.readings import cutoff_check, readings
from smash_analysis.tables.runs import runs_table
from smash_analysis.tables.writing import ablation_table, markdown, write_csv


def make(results: Path, out: Path) -> list[Path]:
    """Make every picture and table of the ablation from the records in `results`; return the files.

    Raises:
        MalformedFile: where there are none, or they are damaged.
    """
    records = runs_of(results)
    out.mkdir(parents=True, exist_ok=True)
    read = readings(records)
    cells, matched, check = variant_cells(read), matched_cells(read), cutoff_check(records)
    runs = runs_table(records)
    table = ablation_table(runs[runs["kind"] != "cutoff"])
    files = [out / name for name in ("cells.csv", "matched.csv", "cutoffs.csv", "table.csv", "table.md", "findings.md")]
    for file, frame in zip(files, (cells, matched, check, table), strict=False):
        write_csv(frame, file)
    files[4].write_text(markdown(table), encoding="utf-8")
    files[5].write_text(findings(cells, matched, check) + conditions(records), encoding="utf-8")
    files += write_latex(table, "Ablation: runs at the largest budget", "tab:ablation", out / "table")
    return files + _pictures(cells, matched, out)


def _pictures(cells: pd.DataFrame, matched: pd.DataFrame, out: Path) -> list[Path]:
    files = []
    for (label, suite), part in cells.groupby(["label", "suite"]):
        pairs = matched[(matched["label"] == label) & (matched["suite"] == suite)]
        name = re.sub(r"[^A-Za-z0-9._-]+", "-", f"heatmap-{label}-{suite}").strip("-")
        figure = planner_figure(str(label), str(suite), part, pairs)
        column = planner_figure(str(label), str(suite), part, pairs, narrow=True)
        for drawn, file in ((figure, f"{name}.png"), (figure, f"{name}.pdf"), (column, f"{name}-column.pdf")):
            files.append(out / file)
            drawn.savefig(files[-1], dpi=250)
    return files


def main() -> None:
    """Make the ablation's pictures and say where they are."""
    command.run("ablation", __doc__, make, shown="findings.md")


if __name__ == "__main__":
    main()
