"""The section on episodes: plans carried out, the paper's Tables I and II, failures by name."""

from __future__ import annotations

from collections.abc import Hashable

import pandas as pd

from smash.records.episodes import EpisodeRecord
from smash_analysis.charts.heatmaps import SUCCESS_COLOURS
from smash_analysis.execution_tables import (
    BENCHMARKS,
    LEGEND,
    VARIANTS,
    failure_table,
    metric_table,
    paired_table,
    told_episodes,
)
from smash_analysis.report.blocks import Block, Cell, Grid, GridBlock, TableBlock
from smash_analysis.report.grids import Shades, variant_words
from smash_analysis.statistics.intervals import success_rate
from smash_analysis.tables.scenes import by_scene
from smash_analysis.tables.writing import SPREADS, rate_cell


def execution_blocks(records: list[EpisodeRecord]) -> list[Block]:
    """Return success as grids, the paper's tables with ours, execution time saved, and the failures."""
    episodes = by_scene(told_episodes(records))
    blocks: list[Block] = [_success(episodes)]
    for benchmark, title in BENCHMARKS.items():
        if (episodes["benchmark"] == benchmark).any():
            table = metric_table(episodes, benchmark)
            papers = frozenset(i for i, source in enumerate(table["source"]) if source == "paper")
            blocks.append(TableBlock(f"table-{benchmark}", title, table, LEGEND, emphasis=papers, grouped=True))
    saved = paired_table(episodes)
    if len(saved):
        note = (
            "Without minus with, on the instances and seeds that the same planner and policy carried out both ways; an "
            f"instance counts once. Success is over all that were tried both ways. {SPREADS}"
        )
        blocks.append(TableBlock("execution-saved", "Execution time saved by topple, paired by instance", saved, note))
    failed = failure_table(episodes)
    behind = [_failed(episodes, row) for row in failed.to_dict("records")]
    note = "" if len(failed) else "No episode failed."
    blocks.append(
        TableBlock(
            "episode-failures", "Failed episodes and their reasons", failed, note, entries=behind, store="episodes"
        )
    )
    return blocks


def _failed(episodes: pd.DataFrame, row: dict[Hashable, object]) -> list[int]:
    """Return the places of the failed episodes that a row of `failure_table` counts."""
    columns = ["suite", "label", "variant", "policy", "failure"]
    wanted = tuple(row[name] for name in columns)
    return [
        at
        for at, episode in enumerate(episodes.to_dict("records"))
        if not episode["success"] and tuple(episode[name] for name in columns) == wanted
    ]


def execution_headlines(records: list[EpisodeRecord]) -> list[str]:
    """Return success rates by policy and variant, and the time that topple saves, a sentence each."""
    episodes = by_scene(told_episodes(records))
    lines = []
    for (benchmark, policy), part in episodes.groupby(["benchmark", "policy"]):
        who = f"{str(benchmark).capitalize()}-goal episodes, policy “{policy}”"
        if part["success"].all():
            lines.append(f"{who}: all {len(part)} succeed, in every variant ({_rate(part)}).")
            continue
        said = [f"{_rate(mine)} {variant_words(str(variant))}" for variant, mine in part.groupby("variant")]
        lines.append(f"{who}, success: {', '.join(said)}.")
    failures = episodes[~episodes["success"]]["failure"].value_counts()
    if len(failures):
        counted = ", ".join(f"{name} {count}" for name, count in failures.items())
        lines.append(f"{len(episodes[~episodes['success']])} of {len(episodes)} episodes failed: {counted}.")
    return lines


def _rate(episodes: pd.DataFrame) -> str:
    return rate_cell(success_rate(episodes, "success"), "episode")


def _success(episodes: pd.DataFrame) -> GridBlock:
    shade = Shades(SUCCESS_COLOURS, 0, 1)
    grids = []
    for benchmark in dict.fromkeys(episodes["benchmark"]):
        mine = episodes[episodes["benchmark"] == benchmark]
        known = [v for v in VARIANTS if v in set(mine["variant"])]
        variants = known + sorted(set(mine["variant"]) - set(known))
        columns = [(blocks, variant) for blocks in sorted(mine["blocks"].unique()) for variant in variants]
        rows = sorted(set(zip(mine["label"], mine["policy"], strict=True)))
        groups = dict(list(mine.groupby(["label", "policy", "blocks", "variant"])))
        cells = [[_cell(groups.get((*row, *at)), shade, f"{row[0]}, {row[1]}") for at in columns] for row in rows]
        grids.append(
            Grid(
                f"Success, {benchmark}-goal",
                "blocks, variant",
                "planner, policy",
                [f"{blocks} {VARIANTS.get(variant, variant)}" for blocks, variant in columns],
                [f"{label}, {policy}" for label, policy in rows],
                cells,
                wide=True,
            )
        )
    by = ["benchmark", "blocks", "label", "policy", "variant"]
    table = pd.DataFrame([(*key, _rate(part)) for key, part in episodes.groupby(by)], columns=[*by, "success"])
    return GridBlock("episode-success", "Episodes that reached their goal", "episodes", grids, table)


def _cell(part: pd.DataFrame | None, shade: Shades, who: str) -> Cell | None:
    if part is None:
        return None
    good, total = int(part["success"].sum()), len(part)
    low, high = success_rate(part, "success").interval
    first = part.iloc[0]
    words = f"{who}, {first['blocks']} blocks, {variant_words(first['variant'])}: {good} of {total} episodes succeed"
    words += f", 95 % interval over instances {100 * low:.0f} to {100 * high:.0f} %"
    return Cell(f"{good}/{total}", *shade(good / total), words, [[int(number)] for number in part.index])
