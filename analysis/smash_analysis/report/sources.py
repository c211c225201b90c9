"""What a report is made of: every directory below RESULTS that a sweep, its episodes or a topple map wrote."""

from __future__ import annotations

import hashlib
import os
from collections.abc import Callable
from dataclasses import dataclass, field, replace
from pathlib import Path

import pandas as pd

from smash.problem.errors import MalformedFile
from smash.problem.words import visible
from smash.records.believing import believed
from smash.records.episodes import ROBOT, EpisodeRecord
from smash.records.files import EPISODES, RUNS, TRIALS, R, RecordFile
from smash.records.reading import NoRecords, Reading, read
from smash.records.record import shown
from smash.records.runs import RunRecord
from smash.records.trials import Trial

SCALING = "scaling.csv"
FILES = (RUNS.name, EPISODES.name, TRIALS.name)


@dataclass(slots=True)
class Source:
    """One directory with records, or what one engine and robot did of it where several did.

    Attributes:
        name: Its path below RESULTS; RESULTS' own name where it is RESULTS itself.
        path: The directory.
        engine: What simulated its episodes and topples; empty where there are none.
        robot: What carried them out; empty for the Panda.
        apart: Whether other engines or robots did others of the directory, which are a source of their own.
        runs: Records of `runs.jsonl`; `episodes` and `trials` likewise.
        scaling: `scaling.csv`, where the records behind it were not kept.
        problems: Files that cannot be read.
        contradictions: In words, what of the runs contradicts what.
        notes: In words, what else of the records does not count.
    """

    name: str
    path: Path
    engine: str = ""
    robot: str = ""
    apart: bool = False
    runs: list[RunRecord] = field(default_factory=list)
    episodes: list[EpisodeRecord] = field(default_factory=list)
    trials: list[Trial] = field(default_factory=list)
    scaling: pd.DataFrame | None = None
    problems: list[MalformedFile] = field(default_factory=list)
    contradictions: list[str] = field(default_factory=list)
    notes: list[str] = field(default_factory=list)

    @property
    def title(self) -> str:
        """What the report calls it."""
        return ", ".join(filter(None, (self.name, self.engine, self.robot))) if self.apart else self.name

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
        files = [self.path / name for name in (*FILES, SCALING)]
        return [(file.name, hashlib.sha256(file.read_bytes()).hexdigest()) for file in files if file.is_file()]


def find_sources(results: Path, out: Path, said: Callable[[str], None] = lambda _: None) -> list[Source]:
    """Return the sources at and below `results`, by name; nothing in `out` is read.

    Args:
        results: the directory.
        out: of the report.
        said: hears what is read.

    Raises:
        NoRecords: where there is no record at all.
    """
    if not results.is_dir():
        raise NoRecords(str(results), "no such directory")
    directories = _directories(results, out.resolve())
    sources = [source for directory in directories for source in _by_engine(_read(directory, results, said))]
    if all(source.empty for source in sources):
        problems = [problem for source in sources for problem in source.problems]
        if problems:
            raise problems[0]
        raise NoRecords(str(results), f"no finished run there or below ({', '.join(FILES)})")
    return [source for source in sources if not source.empty or source.problems]


def _directories(results: Path, out: Path) -> list[Path]:
    found: list[Path] = []
    for place, inner, files in os.walk(results):
        directory = Path(place)
        inner[:] = sorted(name for name in inner if not name.startswith(".") and (directory / name).resolve() != out)
        has_records = any(name in files for name in FILES)
        # A table of curves beside or below its records says nothing that they do not say.
        alone = SCALING in files and not any(directory.is_relative_to(other) for other in found)
        if directory.resolve() != out and (has_records or alone):
            found.append(directory)
    return found


def _read(directory: Path, results: Path, said: Callable[[str], None]) -> Source:
    name = results.resolve().name if directory == results else directory.relative_to(results).as_posix()
    size = sum(file.stat().st_size for file in map(directory.joinpath, FILES) if file.is_file())
    said(f"reading {name} ({size / 1e6:.1f} MB)")
    source = Source(name.encode(errors="backslashreplace").decode(), directory)
    if (runs := _reading(source, RUNS)) is not None:
        found = believed(runs.records)
        source.runs = found.records
        source.contradictions = [visible(str(contradiction)) for contradiction in found.contradictions]
        source.notes += [visible(line) for line in found.rest()]
    source.episodes = _records(source, EPISODES)
    source.trials = _records(source, TRIALS)
    if not source.runs and (directory / SCALING).is_file():
        source.scaling = _scaling(directory / SCALING, source.problems)
    return source


def _by_engine(source: Source) -> list[Source]:
    """Return a source for each engine and robot: what several have done makes no table. Plans stand with the first."""
    episodes = [(record.engine, record.robot) for record in source.episodes]
    kinds = list(dict.fromkeys([*episodes, *((trial.engine, trial.robot) for trial in source.trials)]))
    if len(kinds) < 2:
        engine, robot = kinds[0] if kinds else ("", "")
        return [replace(source, engine=engine, robot="" if robot == ROBOT else robot)]
    parts = [
        Source(
            source.name,
            source.path,
            engine,
            "" if robot == ROBOT else robot,
            apart=True,
            episodes=[record for record in source.episodes if (record.engine, record.robot) == (engine, robot)],
            trials=[trial for trial in source.trials if (trial.engine, trial.robot) == (engine, robot)],
        )
        for engine, robot in kinds
    ]
    first = parts[0]
    whole = replace(
        source, engine=first.engine, robot=first.robot, apart=True, episodes=first.episodes, trials=first.trials
    )
    return [whole, *parts[1:]]


def _records(source: Source, kind: RecordFile[R]) -> list[R]:
    reading = _reading(source, kind)
    return [] if reading is None else [shown(record) for record in reading.records]


def _reading(source: Source, kind: RecordFile[R]) -> Reading[R] | None:
    """Return what a file holds, and note what of it does not count; None where there is nothing in it."""
    if not kind.path(source.path).is_file():
        return None
    try:
        reading = read(source.path, kind)
    except MalformedFile as error:
        source.problems.append(error)
        return None
    if not reading.lines:
        for damaged in reading.damaged[:1]:
            source.problems.append(MalformedFile(f"{reading.path}:{damaged.number}", damaged.reason))
        return None
    source.notes += [visible(line) for line in reading.notes()]
    return reading


def _scaling(file: Path, problems: list[MalformedFile]) -> pd.DataFrame | None:
    try:
        table = pd.read_csv(file, dtype={"room": "string", "label": "string", "variant": "string"})
    except (ValueError, OSError) as error:
        problems.append(MalformedFile(str(file), " ".join(str(error).split())))
        return None
    if not {"label", "variant", "room", "blocks", "first_seconds", "proof_seconds"} <= set(table.columns):
        problems.append(MalformedFile(str(file), "not the table that `python -m smash_analysis.scaling` writes"))
        return None
    return table
