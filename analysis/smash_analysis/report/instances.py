"""Cards of the instances: start and goal, what is known of their costs, and replays of their episodes."""

from __future__ import annotations

import os
from pathlib import Path
from urllib.parse import quote

import pandas as pd

from smash_analysis.report.blocks import CardsBlock
from smash_analysis.report.pictures import MOST_BLOCKS, Card, drawable, scenes
from smash_analysis.report.sources import Source
from smash_analysis.report.stores import shown

MOST_CARDS = 120
"""More would make a page that nobody scrolls through."""


def cards(source: Source, runs: pd.DataFrame) -> CardsBlock:
    """Return a card per instance of the section.

    Args:
        source: with its records and, perhaps, replays.
        runs: `compared`; its costs and optima are what is known.
    """
    behind: dict[tuple[str, str], list[int]] = {}
    for number, record in enumerate(source.runs):
        behind.setdefault((record.suite, record.instance), []).append(number)
    drawn = {key: numbers for key, numbers in behind.items() if drawable(source.runs[numbers[0]])}
    replays = _replays(source.path)
    known = {(str(s), str(i)): part for (s, i), part in runs.groupby(["suite", "instance"], sort=False)}
    made = []
    for (suite, instance), numbers in sorted(drawn.items())[:MOST_CARDS]:
        pictures, note = scenes(source.runs[numbers[0]].instance_document)
        name = shown(instance) if instance.startswith(suite) else f"{suite}: {shown(instance)}"
        costs = _costs(known[suite, instance]) if (suite, instance) in known else []
        links = [(file.stem.removeprefix(instance).strip("-_ ") or "replay", str(file)) for file in replays(instance)]
        made.append(Card(name, pictures, note, costs, numbers, links))
    return CardsBlock(
        "instances", "Instances: start, goal, best known costs", made, "runs", _note(len(behind), len(made))
    )


def _note(count: int, drawn: int) -> str:
    note = "Cost of the best plan of any planner, by buffers and variant; ✓ marks a proven optimum."
    if drawn < count:
        note += f" {drawn} of {count} are drawn: none of more than {MOST_BLOCKS} blocks, none after {MOST_CARDS}."
    return note


def _costs(runs: pd.DataFrame) -> list[tuple[str, ...]]:
    """Return a header and a row per buffer count, a column a variant; buffer counts with the same costs share a row."""
    variants = sorted(runs["variant"].unique())
    rows: dict[tuple[str, ...], list[str]] = {}
    for buffers, part in runs.groupby("buffers"):
        texts = []
        for variant in variants:
            mine = part[part["variant"] == variant]
            best, proven = mine["cost"].min(), mine["optimum"].notna().any()
            texts.append("–" if pd.isna(best) else f"{best:g}{' ✓' if proven else ''}")
        rows.setdefault(tuple(texts), []).append(f"{buffers:g}")
    return [("B", *variants), *((", ".join(counts), *texts) for texts, counts in rows.items())]


class _Replays:
    """Replays below a directory, by the instance that their names begin with."""

    def __init__(self, directory: Path) -> None:
        folder = directory / "replays"
        self._files = sorted(folder.glob("*.html")) if folder.is_dir() else []

    def __call__(self, instance: str) -> list[Path]:
        return [
            file for file in self._files
            if file.stem.startswith(instance) and not file.stem[len(instance) : len(instance) + 1].isalnum()
        ]  # fmt: skip


def _replays(directory: Path) -> _Replays:
    return _Replays(directory)


def relative_link(file: str, page: Path) -> str:
    """Return the link from the directory `page` to a file, so that both can be moved together."""
    return quote(Path(os.path.relpath(file, page)).as_posix())
