"""Curves over the number of blocks, from records of many sizes or from the table that was kept of them."""

from __future__ import annotations

import math

import pandas as pd

from smash_analysis.report.blocks import Block, ChartBlock, TableBlock
from smash_analysis.scaling import MEASURES, exponent_table, scaling_chart

SIZES_FOR_CURVES = 4
"""Fewer sizes than this make no curve."""


def growth_blocks(cells: pd.DataFrame) -> list[Block]:
    """Return the curves of both times, and the growth exponents."""
    blocks: list[Block] = []
    for column, words in MEASURES.items():
        if cells[column].notna().any():
            note = "Medians over the instances of a size that have it: a curve that ends early has none beyond."
            chart = scaling_chart(cells, column)
            blocks.append(ChartBlock(column.replace("_", "-"), f"Seconds to a {words} over blocks", chart, note))
    note = (
        "Slope of log seconds over log blocks by least squares, from three sizes on, and the largest size with every "
        "instance solved, or proven."
    )
    blocks.append(TableBlock("exponents", "Growth exponents", exponent_table(cells), note))
    return blocks


def growth_headlines(cells: pd.DataFrame) -> list[str]:
    """Return the largest sizes that were proven whole, a sentence a variant."""
    lines = []
    for variant, part in cells.groupby("variant"):
        whole = part[(part["proven"] == part["runs"]) & (part["proven"] > 0)]
        if whole.empty:
            continue
        most = whole["blocks"].max()
        best = whole[whole["blocks"] == most].sort_values("proof_seconds").iloc[0]
        seconds = "" if math.isnan(best["proof_seconds"]) else f", median {best['proof_seconds']:.2g} s"
        lines.append(f"{variant}: every instance proven up to {most:g} blocks (quickest: {best['label']}{seconds}).")
    return lines
