"""Plan files of both kinds, for the subcommands that take them: ours in JSON, and those of PDDL planners."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from itertools import zip_longest
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypeVar

import click

from smash.problem.blocksworld.folders import Found, Importer
from smash.problem.blocksworld.plan_text import PddlStep, PlanText, parse_plan
from smash.problem.blocksworld.plans import imported, pddl_names
from smash.problem.blocksworld.problem import BlocksProblem
from smash.problem.blocksworld.reading import Reading
from smash.problem.blocksworld.steps import USUAL_READING, Interpreter
from smash.problem.blocksworld.text import decoded
from smash.problem.costs import Costs
from smash.problem.errors import IllegalAction, MalformedFile, RefusedPlan
from smash.problem.files.documents import parse_json, read_bytes
from smash.problem.files.plans import plan_from_document
from smash.problem.model import Action, Instance, PlanOptions, State
from smash.problem.plan import Plan
from smash.problem.rules import Law
from smash.problem.words import counted

if TYPE_CHECKING:
    from smash_baselines.task import PddlTask

F = TypeVar("F", bound=Callable[..., Any])
PLANNER = "imported"
"""The planner of a plan that came in from PDDL."""


@dataclass(frozen=True)
class PlanFile:
    """A plan and what there is to say of how it was read.

    Attributes:
        plan: the plan.
        moves: its cost in moves, where its domain has no hand; None elsewhere.
        placed: the block that it left in the hand, for which a place was added.
        ours: whether it is a plan file of the testbed.
    """

    plan: Plan
    moves: int | None = None
    placed: str | None = None
    ours: bool = False

    def told(self, costs: Costs) -> str:
        """Return its length and its cost in words."""
        length = len(self.plan.actions or ())
        words = counted(length, "action")
        if not costs.plain:
            words += f", {self.plan.cost} {costs.unit}"
        return words if self.moves is None else f"{words}, {counted(self.moves, 'move')} in its own domain"

    def say(self) -> None:
        """Say what was added to the plan."""
        if self.placed is not None:
            cost = self.plan.cost
            click.echo(f"the plan ends with {self.placed!r} in the hand; one place is added, and the cost is {cost}")


def of_pddl(command: F) -> F:
    """Give a subcommand the options that say of which PDDL files a plan is."""
    for option in (
        click.option("--domain", type=click.Path(path_type=Path, dir_okay=False), help="The plan's PDDL domain."),
        click.option("--problem", type=click.Path(path_type=Path, dir_okay=False), help="The plan's PDDL problem."),
    ):
        command = option(command)
    return command


def read_plan_file(path: Path, instance: Instance, problem: Path | None, domain: Path | None) -> PlanFile:
    """Read a plan file of either kind; of one in PDDL every step is looked at.

    Args:
        path: the plan.
        instance: what it is for.
        problem: the PDDL problem that it was made for; None: the blocks are called as in the instance.
        domain: the PDDL domain; None: the actions have their usual names, or are those of an encoding of the testbed.

    Raises:
        MalformedFile: where it is no plan.
        RefusedPlan: where it is wrong, with the step and the reason.
    """
    content = read_bytes(path, "plan files")
    if content.lstrip(b"\xef\xbb\xbf \t\r\n").startswith(b"{"):
        return PlanFile(plan_from_document(parse_json(content, str(path)), str(path)), ours=True)
    text = parse_plan(decoded(content, str(path)), str(path))
    reading = reading_for(instance, problem, domain)
    try:
        tasks = _tasks(instance, text, reading) if domain is None else []
        if tasks:
            return _from_encoding(instance, text, tasks)
        found = imported(instance, text, reading)
    except RefusedPlan as error:
        raise RefusedPlan(f"{path}: {error}") from None
    plan = Plan(instance.name, PLANNER, PlanOptions(topple=False), "feasible", found.actions, stated_cost=None)
    return PlanFile(_priced(instance, plan), found.moves, found.placed)


def reading_for(instance: Instance, problem: Path | None, domain: Path | None) -> Reading:
    """Return how the PDDL files of a plan tell a blocks world.

    Raises:
        MalformedFile: where the problem is another one than the instance's.
        SmashError: where one of the files cannot be read.
    """
    importer = Importer(domain, beside=False)
    if problem is not None:
        read = importer.problem(Found(problem, problem.parent, problem.stem))
        _require_same(read, instance)
        return read.reading
    return USUAL_READING if domain is None else importer.recognizer(domain).reading_of_blocks(pddl_names_of(instance))


def pddl_names_of(instance: Instance) -> list[str]:
    """Return the names of an instance's blocks in PDDL."""
    return list(pddl_names(instance, plain=False).values())


def _require_same(problem: BlocksProblem, instance: Instance) -> None:
    """Refuse a problem whose blocks lie otherwise than the instance's."""
    names = pddl_names(instance, plain=False)
    state = State.start_of(instance)
    here = {tuple(names[block] for block in pile) for pile in state.piles.values() if pile}
    here |= {(names[block],) for block in state.table}
    held = None if instance.hand is None else names[instance.hand]
    if set(problem.blocks) != set(names.values()):
        raise MalformedFile(problem.where, f"has other blocks than the instance {instance.name!r}")
    if set(problem.start.towers()) != here or problem.start.held != held:
        raise MalformedFile(problem.where, f"starts from another arrangement than the instance {instance.name!r}")


def _tasks(instance: Instance, text: PlanText, reading: Reading) -> list[PddlTask]:
    """Return the compiled problems that a plan may be of, the likeliest first; none where its words are the usual ones.

    A plan does not say whether topple was allowed where it went out.
    """
    interpreter = Interpreter(reading, {})
    unknown = {step[0] for step in text.steps if not interpreter.knows(step[0])}
    if not unknown:
        return []
    from smash_baselines.task import compile_instance

    region = any(step[0] in ("pick", "place") and len(step) > 3 for step in text.steps)
    topple = region or any(name.startswith("topple") for name in unknown)
    encodings = ("chain", "conditional") if unknown.isdisjoint(("topple", "topple-base")) else ("conditional", "chain")
    options = [PlanOptions(topple), PlanOptions(not topple)]
    tasks = [compile_instance(instance, option, encoding) for option in options for encoding in encodings]
    actions = {name for task in tasks for name in re.findall(r"\(:action\s+(\S+)", task.domain_text)}
    return [] if unknown.isdisjoint(actions) else tasks


def _from_encoding(instance: Instance, text: PlanText, tasks: Sequence[PddlTask]) -> PlanFile:
    """Return the plan that steps of an encoding are, by the first of some problems that it fits."""
    refused: RefusedPlan | None = None
    for task in tasks:
        try:
            return _from_task(instance, text, task)
        except RefusedPlan as error:
            refused = refused or error
    assert refused is not None
    raise refused


def _from_task(instance: Instance, text: PlanText, task: PddlTask) -> PlanFile:
    from smash_baselines.goal_words import JUDGED
    from smash_baselines.steps import actions_of, steps_of

    at = 0
    steps = [step for step in text.steps if not (task.encoding.judged and step[0] in JUDGED)]

    def numbered() -> Iterator[PddlStep]:
        nonlocal at
        for at, step in enumerate(steps, start=1):  # noqa: B007 - it is read where a step is refused
            yield step

    try:
        actions = tuple(actions_of(numbered(), task))
    except IllegalAction as error:
        raise RefusedPlan(f"refused at step {at}: ({' '.join(steps[at - 1])}): {error}") from None
    right_steps = [step for step in steps_of(actions, task) if not (task.encoding.judged and step[0] in JUDGED)]
    for number, (step, right) in enumerate(zip_longest(steps, right_steps, fillvalue=()), start=1):
        if step[: len(right)] != right or not step or not right:
            wanted = f"; ({' '.join(right)}) would do what is done then" if right else ""
            raise RefusedPlan(f"refused at step {number}: ({' '.join(step)}): does not fit the encoding{wanted}")
    plan = _priced(instance, Plan(instance.name, PLANNER, task.options, "feasible", actions))
    verdict = Law(instance).check(actions)
    if not verdict.accepted:
        raise RefusedPlan(str(verdict))
    if text.cost is not None and text.cost != plan.cost:
        raise RefusedPlan(f"refused: its cost says {text.cost}, its actions cost {plan.cost}")
    return PlanFile(plan)


def _priced(instance: Instance, plan: Plan) -> Plan:
    actions: tuple[Action, ...] = plan.actions or ()
    cost = Law(instance).price(actions)
    return Plan(plan.instance, plan.planner, plan.options, plan.status, actions, stated_cost=cost)
