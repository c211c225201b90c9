"""Options that several subcommands share."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from math import isnan
from typing import TYPE_CHECKING, Any, TypeVar

import click

from smash.problem.actions.registry import FAMILY
from smash.problem.extras import ENGINES
from smash.problem.words import one_line

if TYPE_CHECKING:
    from smash.execution.scene.tabletop import Tabletop
    from smash.problem.model import Instance

Decorated = TypeVar("Decorated", bound=Callable[..., Any])

without_option = click.option(
    "--without",
    type=click.Choice([name for name in FAMILY if name != "topple"]),
    multiple=True,
    help="An aggregating action of the instance that plans may not use; may be given twice.",
)

PACE = click.FloatRange(0.01, 1.0)
"""The type of options that take a share of the arm's limits: from `smash.execution.scene.tabletop.SLOWEST` on."""
noise_option = click.option(
    "--noise",
    metavar="KIND=AMOUNT,…",
    help="What is not known exactly: pose=3mm, yaw=2deg, camera=2mm, placement=2mm, friction=10%, mass=20%, size=1mm.",
)
pace_option = click.option(
    "--pace",
    type=PACE,
    metavar="SHARE",
    help="Of the arm's velocity and acceleration limits, for motions; MoveIt's default is 0.1.",
)

command_option = click.option(
    "--command",
    "command_line",
    metavar="'PROGRAM …'",
    help="Any PDDL planner in place of --planner: 'PLANNER {domain} {problem} {plan}', without a shell.",
)
encoding_option = click.option(
    "--encoding",
    metavar="NAME",
    help="What a --command is handed: `chain` (the default), `conditional`, `pick-and-place` (no topple, no costs).",
)


dask_option = click.option(
    "--dask", metavar="ADDRESS", help="Run on the Dask scheduler at tcp://host:8786, or of a scheduler file."
)
engine_option = click.option(
    "--engine",
    type=click.Choice(list(ENGINES)),
    help="What simulates it (default: the scene's, else PyBullet, else MuJoCo where that is what is installed).",
)


robot_option = click.option(
    "--robot",
    metavar="NAME|FILE",
    help="Robot, shipped or of a smash-robot/1 file (default: the scene's, else panda; `smash robot` lists them).",
)


def say_engine(engine: str, tabletop: Tabletop, named: str | None) -> None:
    """Say on standard error which engine is used, where neither the command line nor the scene names one."""
    if named is None and tabletop.engine is None:
        click.echo(f"engine: {engine} (--engine names another)", err=True)


def say_strangers(tabletop: Tabletop, instance: Instance) -> None:
    """Say on standard error which blocks the scene gives a size and the instance has not: a name may be misspelt."""
    strangers = tabletop.strangers(instance)
    if strangers:
        named, more = (
            ", ".join(map(repr, strangers[:5])),
            f" and {len(strangers) - 5} more" if len(strangers) > 5 else "",
        )
        words = f"scene {tabletop.name!r} has sizes for blocks that instance {instance.name!r} has not: {named}{more}"
        click.echo(one_line(words), err=True)


def check_command(command: str | None, encoding: str | None) -> None:
    """Refuse a program's command line or encoding that is none.

    Raises:
        SmashError: with one line; an encoding without a program is wrong too.
    """
    if command is None:
        if encoding is not None:
            raise click.UsageError("--encoding goes with --command; a planner on another encoding is `NAME:ENCODING`")
        return
    from smash_baselines.engines.command import check_command as check

    check(command, encoding)


def named_commands(given: Iterable[str]) -> dict[str, str]:
    """Return command lines by name, from `NAME='PROGRAM …'`.

    Raises:
        UsageError: where a name or a program is missing, or a name stands twice.
    """
    named: dict[str, str] = {}
    for word in given:
        name, _, line = word.partition("=")
        if not name.strip() or not line.strip():
            raise click.UsageError(f"--command {word!r}: NAME='PROGRAM …' is wanted")
        if name in named:
            raise click.UsageError(f"--command: {name!r} stands twice")
        named[name] = line
    return named


class _Seconds(click.FloatRange):
    """A span of time: more than none, and a number."""

    def convert(self, value: Any, param: click.Parameter | None, ctx: click.Context | None) -> float:
        seconds: float = super().convert(value, param, ctx)
        if isnan(seconds):
            self.fail(f"{value!r} is not a number of seconds.", param, ctx)
        return seconds


SECONDS = _Seconds(min=0, min_open=True, max=1e9)
"""The type of options that take a span of time."""
BUDGET = 30.0
"""The paper's [s]: what `--budget` is where nothing else is said, in every command."""


def budget_option(whose: str) -> Callable[[Decorated], Decorated]:
    """Return `--budget`, which means and is the same in every command: wall time, at most.

    Args:
        whose: what it is the time of, in words.
    """
    return click.option(
        "--budget",
        type=SECONDS,
        default=BUDGET,
        show_default=True,
        metavar="SECONDS",
        help=f"Wall time {whose}, model building and translation included.",
    )
