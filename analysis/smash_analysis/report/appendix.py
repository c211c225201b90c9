"""Where a section's figures come from: files and their hashes, commits, machine, versions, seeds, and the commands."""

from __future__ import annotations

import re
import shlex
from collections import Counter
from collections.abc import Iterable, Iterator, Sequence
from pathlib import Path

import pandas as pd

from smash.records.episodes import EpisodeRecord
from smash.records.runs import RunRecord
from smash_analysis.report.blocks import Block, Listing, TableBlock, Words
from smash_analysis.report.growth import SIZES_FOR_CURVES
from smash_analysis.report.sources import Source
from smash_analysis.statistics.conditions import condition_lines
from smash_analysis.tables.scenes import scene_options


def appendix(source: Source) -> list[Block]:
    """Return the origin of one source's records and the commands that make them and each part again."""
    blocks: list[Block] = [Words("origin", "Records", _origin(source))]
    records: list[RunRecord | EpisodeRecord] = [*source.runs, *source.episodes]
    if versions := _versions(records):
        mixed = [name for name, found in versions.items() if len(found) > 1]
        note = f"Mixed within these records: {', '.join(mixed)}." if mixed else "The same for all records."
        rows = [(name, ", ".join(found)) for name, found in versions.items()]
        blocks.append(
            TableBlock("versions", "Versions", pd.DataFrame(rows, columns=["package", "version"]), note, folded=True)
        )
    blocks.append(Listing("commands", "Commands that make it again", "\n".join(commands(source))))
    if source.experiment:
        blocks.append(Listing("experiment", "What was run: experiment.toml", source.experiment))
    return blocks


def _origin(source: Source) -> list[str]:
    lines = [f"{name}: SHA-256 {digest}" for name, digest in source.hashes()] + [
        str(problem) for problem in source.problems
    ]
    if source.runs:
        lines += condition_lines(source.runs, "runs")
        lines.append(_dates(source.runs, "runs"))
        lines.append(f"seeds of the planners: {_listed(record.seed for record in source.runs)}")
        budgets = _listed(record.budget for record in source.runs)
        lines.append(f"budgets: {budgets} s; threads: {_listed(record.threads for record in source.runs)}")
    if source.episodes:
        lines += condition_lines(source.episodes, "episodes")
        lines.append(_dates(source.episodes, "episodes"))
        lines.append(f"seeds of the physics: {_listed(record.seed for record in source.episodes)}")
    if source.trials:
        lines.append(f"{len(source.trials)} topples, scene {_listed(trial.scene for trial in source.trials)}")
        lines.append(f"seeds of the physics: {_listed(trial.seed for trial in source.trials)}")
    if source.scaling is not None:
        lines.append("the records behind the table were not kept: commit, machine and versions are not known here")
    records: list[RunRecord | EpisodeRecord] = [*source.runs, *source.episodes]
    commits = {record.commit.hash for record in records}
    if len(commits) > 1:
        lines.append(f"MIXED COMMITS: {len(commits)} of them; figures of different code stand side by side")
    return lines


def _dates(records: Iterable[RunRecord | EpisodeRecord], what: str) -> str:
    started = sorted(record.started for record in records)
    return (
        f"{what} started from {started[0][:16]} to {started[-1][:16]} UTC" if started else f"{what}: start not recorded"
    )


def _listed(values: Iterable[object]) -> str:
    distinct = sorted({value for value in values if value is not None}, key=lambda value: (str(type(value)), value))
    shown = [f"{value:g}" if isinstance(value, float) else str(value) for value in distinct]
    return ", ".join(shown) if len(shown) <= 12 else f"{', '.join(shown[:11])}, … ({len(shown)} in all)"


def _versions(records: Iterable[RunRecord | EpisodeRecord]) -> dict[str, list[str]]:
    found: dict[str, dict[str, None]] = {}
    for record in records:
        for name, version in record.versions.items():
            found.setdefault(name, {})[version] = None
    return {name: list(versions) for name, versions in sorted(found.items())}


def commands(source: Source) -> list[str]:
    """Return the commands that make the records of a source again, in a place of their own, then each part of them."""
    path = shlex.quote(f"again/{source.name}")
    lines: list[str] = []
    engine = f" --engine {source.engine}" if source.engine else ""
    engine += f" --robot {shlex.quote(robot_given(source.robot))}" if source.robot else ""
    if source.runs:
        lines += [_runs(source, path), f"smash records check {path}"]
    if source.episodes:
        lines += _episodes(source.episodes, f"smash episodes {path}", engine)
    if source.trials:
        cut, most, seed = (
            max(getattr(trial, name) for trial in source.trials) for name in ("height", "falling", "seed")
        )
        lines.append(f"smash topple-map --highest-cut {cut} --most {most} --seeds {seed + 1}{engine} --out {path}")
    if source.scaling is not None:
        table = source.scaling
        lines.append(
            _scaling(table["label"].unique(), table["blocks"].max(), table["runs"].max(), "") + f" --out {path}"
        )
    lines += [f"python -m smash_analysis.{module} {path}    # {words}" for module, words in _modules(source)]
    return lines


def robot_given(label: str) -> str:
    """Return what `--robot` takes for the robot of a record: the name of a shipped one, else of a file of one's own.

    The label of such a file's robot ends with the mark of its content (`smash.motion.robot.Robot.label`).
    """
    return re.sub(r"-[0-9a-f]{8}$", ".toml", label)


def _episodes(records: Sequence[EpisodeRecord], command: str, engine: str) -> Iterator[str]:
    """Yield a command for each scene, noise and pace that episodes were carried out under."""
    by_scene: dict[str | None, list[EpisodeRecord]] = {}
    for record in records:
        by_scene.setdefault(record.scene, []).append(record)
    for scene, part in by_scene.items():
        seeds = max(record.seed for record in part) + 1
        policies = " ".join(f"--policy {policy}" for policy in dict.fromkeys(record.policy for record in part))
        yield " ".join(filter(None, [command, f"--seeds {seeds} {policies}{engine}", scene_options(scene)]))


def _modules(source: Source) -> Iterator[tuple[str, str]]:
    """Yield the modules that make parts of the report one by one, and what each makes."""
    if source.runs:
        yield "ablation", "budget x buffer heatmaps"
        yield "comparison", "comparison, curves over time"
    if source.scaling is not None or len({record.blocks for record in source.runs}) >= SIZES_FOR_CURVES:
        yield "scaling", "curves over blocks"
    if source.episodes:
        yield ("engines", "both engines, paired") if source.apart else ("execution_tables", "Tables I and II")


def _runs(source: Source, path: str) -> str:
    """Return the command that did the runs: a sweep where its file is there, else the command that needs none."""
    if source.experiment:
        return f"smash sweep {shlex.quote(str(source.path / 'experiment.toml'))} --out {path}"
    planners = dict.fromkeys(record.planner for record in source.runs)
    budget = f" --budget {max(record.budget for record in source.runs):g}"
    if {record.experiment for record in source.runs} == {"scaling"}:
        count = max(Counter(suite for suite, _ in {(r.suite, r.instance) for r in source.runs}).values())
        return _scaling(planners, max(record.blocks for record in source.runs), count, budget) + f" --out {path}"
    suites = " ".join(shlex.quote(suite) for suite in dict.fromkeys(record.suite for record in source.runs))
    buffers = " ".join(f"--buffers {count}" for count in dict.fromkeys(record.buffers for record in source.runs))
    return f"smash compare {suites} {_given(planners)} {buffers}{budget} --out {path}"


def _scaling(planners: Iterable[str], most: int, count: int, budget: str) -> str:
    return f"smash scaling {_given(planners)} --largest {most} --count {count}{budget}"


def _given(planners: Iterable[str]) -> str:
    return " ".join(f"--planner {shlex.quote(name)}" for name in planners)


def report_command(results: Path, out: Path) -> str:
    """Return the command that makes this report again."""
    return f"smash report {shlex.quote(str(results))} --out {shlex.quote(str(out))}"
