"""What a report is made of: every directory below RESULTS that a sweep, its episodes or a topple map wrote."""

from __future__ import annotations

import hashlib
import os
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import pandas as pd

from smash_analysis.records import RUN_FORMAT, NoRecords, read_lines

EPISODE_FORMAT = "smash-episode-run/1"
TRIAL_FORMAT = "smash-topple-trial/1"
RUNS, EPISODES, TRIALS, SCALING = "runs.jsonl", "episodes.jsonl", "trials.jsonl", "scaling.csv"
FORMATS = {RUNS: RUN_FORMAT, EPISODES: EPISODE_FORMAT, TRIALS: TRIAL_FORMAT}

Record = dict[str, Any]


@dataclass(slots=True)
class Source:
    """One directory with records.

    Attributes:
        name: Its path below RESULTS; RESULTS' own name where it is RESULTS itself.
        path: The directory.
        runs: Records of `runs.jsonl`; `episodes` and `trials` likewise.
        scaling: `scaling.csv`, where the records behind it were not kept.
        problems: Files that cannot be read, a line each.
    """

    name: str
    path: Path
    runs: list[Record] = field(default_factory=list)
    episodes: list[Record] = field(default_factory=list)
    trials: list[Record] = field(default_factory=list)
    scaling: pd.DataFrame | None = None
    problems: list[str] = field(default_factory=list)

    @property
    def empty(self) -> bool:
        """Whether nothing in it can be shown."""
        return not (self.runs or self.episodes or self.trials or self.scaling is not None)

    @property
    def experiment(self) -> str:
        """The text of the sweep's own copy of its experiment file; empty where there is none."""
        file = self.path / "experiment.toml"
        return file.read_text(encoding="utf-8", errors="replace") if file.is_file() else ""

    def hashes(self) -> list[tuple[str, str]]:
        """Return (name, SHA-256) of the files that were read."""
        files = [self.path / name for name in (*FORMATS, SCALING)]
        return [(file.name, hashlib.sha256(file.read_bytes()).hexdigest()) for file in files if file.is_file()]


def find_sources(results: Path, out: Path) -> list[Source]:
    """Return the sources at and below `results`, by name; nothing in `out` is read.

    Raises:
        NoRecords: where there is no record at all.
    """
    if not results.is_dir():
        raise NoRecords(f"{results}: no such directory")
    sources = [_read(directory, results) for directory in _directories(results, out.resolve())]
    if all(source.empty for source in sources):
        problems = [problem for source in sources for problem in source.problems]
        wanted = ", ".join(FORMATS)
        raise NoRecords(problems[0] if problems else f"{results}: no finished run there or below ({wanted})")
    return [source for source in sources if not source.empty or source.problems]


def _directories(results: Path, out: Path) -> list[Path]:
    found: list[Path] = []
    for place, inner, files in os.walk(results):
        directory = Path(place)
        inner[:] = sorted(name for name in inner if not name.startswith(".") and (directory / name).resolve() != out)
        has_records = any(name in files for name in FORMATS)
        # A table of curves beside or below its records says nothing that they do not say.
        alone = SCALING in files and not any(directory.is_relative_to(other) for other in found)
        if directory.resolve() != out and (has_records or alone):
            found.append(directory)
    return found


def _read(directory: Path, results: Path) -> Source:
    name = results.resolve().name if directory == results else directory.relative_to(results).as_posix()
    source = Source(name.encode(errors="backslashreplace").decode(), directory)
    for file, wanted in FORMATS.items():
        if not (directory / file).is_file():
            continue
        try:
            records = read_lines(directory / file, wanted)
        except NoRecords as error:
            source.problems.append(str(error))
            continue
        match file:
            case "runs.jsonl":
                source.runs = records
            case "episodes.jsonl":
                source.episodes = records
            case "trials.jsonl":
                source.trials = records
    if not source.runs and (directory / SCALING).is_file():
        source.scaling = _scaling(directory / SCALING, source.problems)
    return source


def _scaling(file: Path, problems: list[str]) -> pd.DataFrame | None:
    try:
        table = pd.read_csv(file, dtype={"room": "string", "label": "string", "variant": "string"})
    except (ValueError, OSError) as error:
        problems.append(f"{file}: {' '.join(str(error).split())}")
        return None
    if not {"label", "variant", "room", "blocks", "first_seconds", "proof_seconds"} <= set(table.columns):
        problems.append(f"{file}: not the table that `python -m smash_analysis.scaling` writes")
        return None
    return table
