"""`smash reproduce`: every table and figure, the paper's and ours, from nothing."""

from __future__ import annotations

import shutil
import sys
from collections.abc import Sequence
from fnmatch import fnmatch
from pathlib import Path
from time import monotonic

import click

import smash
from smash.cli.shown_tables import console
from smash.cli.signals import stopped_by_signals
from smash.experiments.reproduction.manifest import write_manifest
from smash.experiments.reproduction.reproduce import Planned, Reproduction, StageRecord, last_line
from smash.experiments.reproduction.stages import read_stages
from smash.experiments.sweeps.display import span
from smash.problem.errors import Interrupted, MalformedFile, SmashError
from smash.problem.words import one_line, visible
from smash.records.locking import hold

EXPERIMENTS = Path(smash.__file__).parent.parent / "experiments"
LEFT = ("to do", "continued", "stale")
SECONDS_BETWEEN_LINES = 30.0
"""How often a line says how a stage goes where no terminal shows it."""


class _StageFailed(SmashError):
    def __init__(self, message: str, exit_code: int) -> None:
        self.exit_code = exit_code if exit_code > 0 else 7
        super().__init__(message)


@click.command("reproduce")
@click.option("--full", is_flag=True, help="The whole grids instead of the stated small ones (days; says how long).")
@click.option(
    "--steps", type=click.Path(path_type=Path, dir_okay=False), metavar="FILE", help="Another list of stages."
)
@click.option("--out", type=click.Path(path_type=Path, file_okay=False), help="Default: runs/NAME-OF-THE-LIST.")
@click.option("--dry-run", is_flag=True, help="Say what would be run, what is done, and how long it takes.")
@click.option("--keep-stale", is_flag=True, help="Keep what is done though code or inputs have changed (it is noted).")
@click.option("--copy-to", type=click.Path(path_type=Path, file_okay=False), metavar="DIR", help="Copy products there.")
def command(
    full: bool, steps: Path | None, out: Path | None, dry_run: bool, keep_stale: bool, copy_to: Path | None
) -> None:
    """Make the paper's tables and figures, and those of this testbed, stage by stage, and write a manifest.

    It may be stopped or killed at any moment: start it again and it goes on. What is done and unchanged is not run
    again. OUT/MANIFEST.md says what was run, what was not and why, how long it took, and the hash of each product.

    \b
    Examples:
      smash reproduce --dry-run
      smash reproduce
      smash reproduce --full --out runs/everything
    """
    file = steps or EXPERIMENTS / f"reproduce{'-full' if full else ''}.toml"
    if steps is None and not file.is_file():
        raise MalformedFile(str(file), "not there: run it in a checkout of the repository, or give --steps FILE")
    read = read_stages(file)
    reproduction = Reproduction(read, file.parent, out or Path("runs") / read.name, keep_stale)
    if dry_run:
        _show(reproduction, reproduction.plan())
        return
    with stopped_by_signals() as stop, hold(reproduction.out):
        planned = reproduction.plan()
        _show(reproduction, planned)
        if any(entry.plan in LEFT for entry in planned):
            with _Progress(sum(entry.plan in LEFT for entry in planned)) as progress:
                planned = reproduction.run(progress, stop)
        files = write_manifest(reproduction, planned)
        if copy_to is not None:
            _copy(reproduction, planned, files, copy_to)
        if stop.is_set():
            raise Interrupted("interrupted; start again to go on")
    _end(planned, files)


def _show(reproduction: Reproduction, planned: Sequence[Planned]) -> None:
    """Say what there is to do and how long it takes on 2 cores."""
    from rich.table import Table
    from rich.text import Text

    left = [entry for entry in planned if entry.plan in LEFT]
    total = span(60 * sum(entry.stage.minutes for entry in left))
    words = f"{len(left)} of {len(planned)} stages to do, about {total} on 2 cores" if left else "nothing to do"
    click.echo(one_line(f"{reproduction.stages.name} in {reproduction.out}: {words}"))
    table = Table("stage", "what", "about", "plan", "why")
    for entry in planned:
        took = span(60 * entry.stage.minutes)
        table.add_row(
            *(Text(visible(cell)) for cell in (entry.stage.name, entry.stage.about, took, entry.plan, entry.why))
        )
    console().print(table)


class _Progress:
    """Says on stderr which stage runs, since when, and the last line that it printed."""

    def __init__(self, total: int) -> None:
        self._total, self._number = total, 0
        self._said = 0.0
        self._words = ""
        self._log = Path()
        self._status = None
        if sys.stderr.isatty():
            from rich.console import Console

            self._status = Console(stderr=True).status("")

    def __enter__(self) -> _Progress:
        if self._status is not None:
            self._status.start()
        return self

    def __exit__(self, *_: object) -> None:
        if self._status is not None:
            self._status.stop()

    def begun(self, planned: Planned, log: Path) -> None:
        """Say that a stage has started."""
        self._number += 1
        self._log, self._said = log, monotonic()
        self._words = f"[{self._number}/{self._total}] {planned.stage.name}"
        self._say(f"{self._words}: about {span(60 * planned.stage.minutes)}; its output: {log}")

    def running(self, seconds: float) -> None:
        """Show the last line that the stage has printed."""
        if self._status is not None:
            from rich.text import Text

            self._status.update(Text(f"{self._words}, {span(seconds)}: {last_line(self._log)}"[:160]))
        elif monotonic() - self._said > SECONDS_BETWEEN_LINES:
            self._said = monotonic()
            self._say(f"{self._words}, {span(seconds)}: {last_line(self._log)}")

    def ended(self, record: StageRecord) -> None:
        """Say how a stage ended."""
        words = record.problem or f"{len(record.products)} products"
        self._say(f"{self._words}: {record.state}, {span(record.seconds)}: {words}")

    def _say(self, words: str) -> None:
        if self._status is None:
            click.echo(words, err=True)
        else:
            self._status.console.print(words, markup=False, highlight=False)


def _copy(reproduction: Reproduction, planned: Sequence[Planned], files: Sequence[Path], target: Path) -> None:
    """Copy the products and the manifest: a reference set that is small enough to be kept."""
    made = [reproduction.out / name for entry in planned if entry.plan in ("done", "kept") for name in _small(entry)]
    for file in [*files, *made]:
        copy = target / file.relative_to(reproduction.out)
        copy.parent.mkdir(parents=True, exist_ok=True)
        shutil.copyfile(file, copy)
    click.echo(f"{len(made)} products and the manifest copied to {target}")


def _small(entry: Planned) -> list[str]:
    """Return the products of a stage but for those that a reference set does without."""
    names = entry.record.products if entry.record is not None else {}
    return [name for name in names if not any(fnmatch(name, pattern) for pattern in entry.stage.not_copied)]


def _end(planned: Sequence[Planned], files: Sequence[Path]) -> None:
    click.echo("\n".join(str(file) for file in files))
    for entry in planned:
        if entry.plan == "not run":
            click.echo(one_line(f"{entry.stage.name} was not run: {entry.why}"), err=True)
    failed = [entry.record for entry in planned if entry.record is not None and entry.record.state == "failed"]
    if failed:
        others = f" (and {len(failed) - 1} more)" if len(failed) > 1 else ""
        raise _StageFailed(f"stage {failed[0].stage}{others}: {failed[0].problem}", failed[0].exit_code)
