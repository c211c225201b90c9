"""A reproduction: every stage once, in order, each with a record of what it was made from and what it made.

`OUT/records/STAGE.json` says how far a stage is. One that is done and whose inputs have not changed since is not run
again; one that was stopped or killed is continued by the resume of its own commands; one whose inputs have changed is
begun from nothing, and what it had made before is set aside in `OUT/.stale`.
"""

from __future__ import annotations

import os
import subprocess
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from datetime import UTC, datetime
from functools import partial
from pathlib import Path
from threading import Event
from time import monotonic
from typing import Literal, Protocol, cast

import msgspec

from smash.experiments.environment import commit, load
from smash.experiments.isolation.lifetime import end_with_parent
from smash.experiments.reproduction.stages import OR, MadeFrom, Stage, Stages, file_hash, made_from
from smash.problem.errors import MalformedFile
from smash.problem.extras import install_line, is_known
from smash.problem.files.documents import convert, parse_json, read_bytes, write_text
from smash.records.record import Commit

HEARTBEAT = 10.0
"""Seconds between two notes of how long a stage has run, so that a kill loses no more of its time."""
PATIENCE = 60.0
"""Seconds that a command has to end by itself once it is asked to."""

STALE = ".stale"
"""Hidden, so that whoever reads all records below the directory passes it by."""

State = Literal["begun", "failed", "done"]
Plan = Literal["done", "kept", "to do", "continued", "stale", "not run"]
"""`kept`: done, and kept although something has changed; `stale`: done once, and made anew."""


class Product(msgspec.Struct, frozen=True):
    """One file that a stage made."""

    sha256: str
    bytes: int


class Load(msgspec.Struct):
    """The machine's load average over a minute: at the first start, the mean of all samples, the most."""

    before: float
    mean: float
    most: float
    samples: int = 1

    def add(self, sample: float) -> None:
        """Take one more sample."""
        self.mean = round((self.mean * self.samples + sample) / (self.samples + 1), 3)
        self.samples += 1
        self.most = max(self.most, sample)


class StageRecord(msgspec.Struct):
    """`OUT/records/STAGE.json`: `seconds` and `load` are over all `starts` of the stage."""

    stage: str = msgspec.field(name="step")
    state: State
    made_from: MadeFrom
    commit: Commit
    started: str
    load: Load
    ended: str | None = None
    seconds: float = 0.0
    starts: int = 0
    problem: str = ""
    exit_code: int = 0
    products: dict[str, Product] = {}

    def products_hash(self) -> str:
        """Return one hash of all products."""
        return "".join(f"{name} {product.sha256}\n" for name, product in sorted(self.products.items()))


@dataclass(frozen=True)
class Planned:
    """A stage, what is to be done about it, and why in a few words."""

    stage: Stage
    plan: Plan
    why: str
    record: StageRecord | None


class Display(Protocol):
    """Whoever shows how a reproduction goes."""

    def begun(self, planned: Planned, log: Path) -> None:
        """A stage has started."""

    def running(self, seconds: float) -> None:
        """The stage still runs (asked several times a second)."""

    def ended(self, record: StageRecord) -> None:
        """The stage has ended."""


class Reproduction:
    """The stages of one file, made in one directory."""

    def __init__(self, stages: Stages, here: Path, out: Path, keep_stale: bool = False) -> None:
        self.stages = stages
        self.here = here.resolve()
        self.out = out.resolve()
        self.keep_stale = keep_stale

    def plan(self) -> list[Planned]:
        """Return what is to be done about each stage."""
        planned: dict[str, Planned] = {}
        for stage in self.stages.stages:
            planned[stage.name] = self._plan(stage, planned)
        return list(planned.values())

    def run(self, display: Display, stop: Event) -> list[Planned]:
        """Do what is to be done, stage by stage; return the stages as they stand afterwards."""
        done: dict[str, Planned] = {}
        for stage in self.stages.stages:
            planned = self._plan(stage, done, running=True)
            if planned.plan in ("to do", "continued", "stale") and not stop.is_set():
                display.begun(planned, self.log(stage))
                record = self._run(planned, done, display, stop)
                display.ended(record)
                planned = self._plan(stage, done, running=True)
            done[stage.name] = planned
        return list(done.values())

    def log(self, stage: Stage) -> Path:
        """Return where the output of a stage's commands goes."""
        return self.out / "logs" / f"{stage.name}.log"

    def _plan(self, stage: Stage, before: dict[str, Planned], running: bool = False) -> Planned:
        record = self._read(stage)
        if lacking := stage.lacking():
            return Planned(stage, "not run", f"not installed: {', '.join(lacking)}{_how_to_get(lacking)}", record)
        unmade = [name for name in stage.after if before[name].plan not in ("done", "kept", "not run")]
        if running and stage.after and not any(before[name].plan in ("done", "kept") for name in stage.after):
            return Planned(stage, "not run", f"there is nothing of {', '.join(stage.after)}", record)
        if record is None:
            return Planned(stage, "to do", f"after {', '.join(unmade)}" if unmade else "", None)
        changes = record.made_from.changes(self._made_from(stage, before))
        if record.state != "done":
            if changes and not self.keep_stale:
                return Planned(stage, "stale", "; ".join(changes), record)
            return Planned(stage, "continued", record.problem or "it was killed", record)
        if not running:
            changes += [f"{name} is to be made anew" for name in unmade]
        missing, changed = self._damaged(record)
        if changed or (changes and not self.keep_stale):
            return Planned(stage, "stale", "; ".join(changes + changed), record)
        if missing:
            return Planned(stage, "continued", "; ".join(missing), record)
        return Planned(stage, "kept" if changes else "done", "; ".join(changes), record)

    def _made_from(self, stage: Stage, before: dict[str, Planned]) -> MadeFrom:
        uses = {name: made.products_hash() for name in stage.after if (made := before[name].record) is not None}
        return made_from(stage, self.here, uses)

    def _damaged(self, record: StageRecord) -> tuple[list[str], list[str]]:
        """Return in words the products that are missing, and those that somebody has changed."""
        there = {name: self.out / name for name in record.products if (self.out / name).is_file()}
        changed = [name for name, file in there.items() if file_hash(file) != record.products[name].sha256]
        missing = [f"{name} is missing" for name in record.products if name not in there]
        return missing, [f"{name} is not as it was made" for name in changed]

    def _run(self, planned: Planned, before: dict[str, Planned], display: Display, stop: Event) -> StageRecord:
        stage = planned.stage
        made, now = self._made_from(stage, before), datetime.now(UTC).isoformat(timespec="seconds")
        record = planned.record
        if planned.plan != "continued" or record is None:
            self._set_aside(stage)
            record = StageRecord(stage.name, "begun", made, commit(), now, Load(load(), load(), load()))
        record.starts += 1
        record.state, record.problem, record.exit_code, record.ended = "begun", "", 0, None
        (self.out / stage.name).mkdir(parents=True, exist_ok=True)
        self._write(record)
        self._run_commands(stage, record, display, stop)
        if not record.problem:
            record.products = self._products(stage, record)
        if not stop.is_set():
            record.state = "failed" if record.problem else "done"
        record.ended = datetime.now(UTC).isoformat(timespec="seconds")
        self._write(record)
        return record

    def _run_commands(self, stage: Stage, record: StageRecord, display: Display, stop: Event) -> None:
        log = self.log(stage)
        log.parent.mkdir(parents=True, exist_ok=True)
        for words, text in zip(stage.words(self.out, self.here), stage.commands, strict=True):
            with open(log, "a", encoding="utf-8") as said:
                said.write(f"$ {text}\n")
                said.flush()
                code = _run_command(words, said.fileno(), record, lambda: self._write(record), display, stop)
            if stop.is_set():
                record.problem = "it was stopped"
                return
            if code:
                record.exit_code = code
                record.problem = f"`{text}` ended with exit code {code}: {last_line(log)}"
                return

    def _products(self, stage: Stage, record: StageRecord) -> dict[str, Product]:
        products = {}
        for pattern in stage.products:
            files = [file for file in sorted(self.out.glob(pattern)) if file.is_file()]
            if not files:
                record.problem = f"it made no {pattern}"
            for file in files:
                name = file.relative_to(self.out).as_posix()
                products[name] = Product(file_hash(file), file.stat().st_size)
        return products

    def _set_aside(self, stage: Stage) -> None:
        """Move what the stage had made before to a folder of its own, its record and log with it."""
        parts = [self.out / stage.name, self._path(stage.name), self.log(stage)]
        parts = [part for part in parts if part.exists()]
        if not parts:
            return
        number = 1
        while (aside := self.out / STALE / f"{stage.name}-{number}").exists():
            number += 1
        aside.mkdir(parents=True)
        for part in parts:
            part.rename(aside / part.name)

    def _path(self, name: str) -> Path:
        return self.out / "records" / f"{name}.json"

    def _read(self, stage: Stage) -> StageRecord | None:
        path = self._path(stage.name)
        if not path.is_file():
            return None
        try:
            document = parse_json(read_bytes(path), str(path))
        except MalformedFile:
            return None  # cut off by a full disk: the stage is done anew
        return cast(StageRecord, convert(document, StageRecord, str(path)))

    def _write(self, record: StageRecord) -> None:
        path = self._path(record.stage)
        path.parent.mkdir(parents=True, exist_ok=True)
        write_text(path, msgspec.json.format(msgspec.json.encode(record), indent=1).decode() + "\n")


def _run_command(
    words: Sequence[str], said: int, record: StageRecord, note: Callable[[], None], display: Display, stop: Event
) -> int:
    """Run one command to its end and keep the record's time; it is asked to end where `stop` is set."""
    process = subprocess.Popen(
        words,
        stdin=subprocess.DEVNULL,
        stdout=said,
        stderr=said,
        start_new_session=True,
        preexec_fn=partial(end_with_parent, os.getpid()),
    )
    counted = noted = monotonic()
    asked: float | None = None
    while True:
        try:
            code: int | None = process.wait(timeout=0.25)
        except subprocess.TimeoutExpired:
            code = None
        now = monotonic()
        record.seconds, counted = record.seconds + now - counted, now
        if code is not None:
            return code
        if now - noted > HEARTBEAT:
            noted = now
            record.load.add(load())
            note()
        if stop.is_set() and asked is None:
            process.terminate()
            asked = now
        if asked is not None and now - asked > PATIENCE:
            process.kill()
        display.running(record.seconds)


def last_line(log: Path) -> str:
    """Return the last line of words that the commands have printed; empty where there is none yet."""
    with open(log, "rb") as said:
        said.seek(max(0, said.seek(0, 2) - 2000))
        lines = said.read().decode(errors="replace").splitlines()
    return next((line.strip() for line in reversed(lines) if any(map(str.isalnum, line))), "")


def _how_to_get(packages: Sequence[str]) -> str:
    """Return the lines that install packages, in brackets; nothing where no extra brings them."""
    first = [words.split(OR)[0] for words in packages]
    lines = dict.fromkeys(install_line(package) for package in first if is_known(package))
    return f" ({'; '.join(lines)})" if lines else ""
