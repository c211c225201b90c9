"""A unified-planning problem, of our domains or of a classical blocks world, back to an instance."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence, Set
from dataclasses import dataclass
from functools import cache
from typing import TYPE_CHECKING

from smash.problem.errors import Unsupported
from smash.problem.model import Action, Instance, PlanOptions
from smash_baselines.encodings import BY_DOMAIN, ENCODINGS, Encoding, action_names
from smash_baselines.names import Fact, Step
from smash_baselines.read_problem import RawProblem, ReadProblem, interpret
from smash_baselines.steps import actions_of, steps_of
from smash_baselines.up_classical import Classical, read_classical

if TYPE_CHECKING:
    from unified_planning.model import FNode, Problem

_NO_PROBLEM = """(define (problem none) (:domain {}) (:init (= (total-cost) 0)) (:goal (and))
                  (:metric minimize (total-cost)))"""
"""The library reads costs as costs only where a problem minimises them."""
_COSTS = "total-cost"
_DOMAINS = f"one of the domains {', '.join(encoding.domain for encoding in ENCODINGS.values())}"


@dataclass(frozen=True, slots=True)
class OwnReading:
    """A problem of our domains read: the instance, and how its plans are said in the problem's names.

    Attributes:
        read: the instance and its encoding.
        exact: whether the problem counts what the law counts. Without a metric every step counts 1: each step of a
            topple that is told in several, too.
    """

    read: ReadProblem
    exact: bool

    @property
    def instance(self) -> Instance:
        """The instance."""
        return self.read.instance

    @property
    def options(self) -> PlanOptions:
        """What its plans may use."""
        return self.read.options

    @property
    def keeps_hand(self) -> bool:
        """Whether the hand is empty at the end of every plan: so the law has it."""
        return True

    @property
    def may_end_full(self) -> bool:
        """Whether a plan may end one step earlier with a block in the hand: never."""
        return False

    def bound(self, lower: int) -> int:
        """Return how many steps a plan of the problem has at least, where one of ours costs at least `lower`."""
        return lower

    def steps(self, actions: Sequence[Action]) -> list[Step]:
        """Return the problem's steps for a legal plan.

        Raises:
            IllegalAction: where the law refuses an action.
        """
        return steps_of(actions, self.read.task)

    def actions(self, steps: Iterable[Step]) -> list[Action]:
        """Return the law's actions for a plan of the problem.

        Raises:
            IllegalAction: where a step is not of the encoding, or the law refuses what it says.
        """
        return actions_of(steps, self.read.task)


Reading = OwnReading | Classical


def reading_of(problem: Problem) -> Reading:
    """Return the instance of a unified-planning problem, with the way between its plans and ours.

    Its actions are those of one of our domains, or do what those of a classical blocks world do.

    Raises:
        Unsupported: where the actions are other ones, the goal is no conjunction of facts, or there is more to it:
            constraints on the way, timed goals, a metric that is neither costs nor length.
        MalformedFile: where the facts describe no instance.
        Infeasible: where the goal of a blocks world asks for what cannot be.
    """
    unit = _counts_steps(problem)
    if _alike({action.name for action in problem.actions}):
        return OwnReading(*_own(problem))
    if not unit:
        raise Unsupported("a blocks world whose actions do not all cost 1")
    try:
        return read_classical(problem)
    except Unsupported as error:
        raise Unsupported(f"{error} (and its actions are not those of {_DOMAINS})") from None


def read_up_problem(problem: Problem) -> ReadProblem:
    """Return the instance of a unified-planning problem of one of our domains.

    Its actions must be those of one of our domains, word for word: from `smash_baselines.up_problem`, or by the
    library's PDDL reader from `smash export-pddl` or any other problem file of these domains.

    Raises:
        Unsupported: where the actions are other ones, or the goal is no conjunction of facts.
        MalformedFile: where the facts describe no instance.
    """
    read, _ = _own(problem)
    return read


def _own(problem: Problem) -> tuple[ReadProblem, bool]:
    _refuse_more(problem)
    counted = not problem.quality_metrics or _length(problem)
    encoding = _encoding_of(problem, counted=counted)
    objects = {kind: _objects(problem, kind) for kind in ("block", "location", "count", "word")}
    raw = RawProblem(
        encoding, problem.name or "problem", objects, list(_start(problem)), list(_goal(problem)), where="problem"
    )
    return interpret(raw), not (counted and encoding.chain)


def _refuse_more(problem: Problem) -> None:
    for part, what in (
        ("trajectory_constraints", "constraints on the way"),
        ("timed_goals", "timed goals"),
        ("timed_effects", "timed effects"),
    ):
        if getattr(problem, part, None):
            raise Unsupported(f"the problem has {what}")
    if len(problem.quality_metrics) > 1:
        raise Unsupported("the problem has several metrics")


def _length(problem: Problem) -> bool:
    return all(metric.is_minimize_sequential_plan_length() for metric in problem.quality_metrics)


def _counts_steps(problem: Problem) -> bool:
    """Whether a problem counts its steps: no metric, their number, or 1 for each.

    Raises:
        Unsupported: where it counts anything but steps and costs of actions.
    """
    _refuse_more(problem)
    for metric in problem.quality_metrics:
        if metric.is_minimize_action_costs():
            costs = {str(metric.get_action_cost(action)) for action in problem.actions}
            return costs == {"1"}
        if not metric.is_minimize_sequential_plan_length():
            raise Unsupported(f"its metric is {metric}; costs of actions and the number of steps are known")
    return True


def _encoding_of(problem: Problem, *, counted: bool) -> Encoding:
    said = _actions(problem, counted=counted)
    alike = _alike(said.keys())
    for encoding in alike:
        if said == _reference(encoding, counted=counted):
            return encoding
    for encoding in alike:
        reference = _reference(encoding, counted=counted)
        changed = next(name for name, text in said.items() if text != reference[name])
        raise Unsupported(f"action {changed!r} is not as in {encoding.domain}")
    raise Unsupported(f"the problem's actions are not those of {_DOMAINS}")


def _alike(actions: Set[str]) -> list[Encoding]:
    """Return the encodings whose domains have actions of these names."""
    known = (encoding for encoding in BY_DOMAIN.values() if encoding.costs)
    return [encoding for encoding in known if actions == action_names(encoding.text)]


@cache
def _reference(encoding: Encoding, *, counted: bool) -> dict[str, str]:
    from unified_planning.io import PDDLReader

    problem = PDDLReader().parse_problem_string(encoding.text, _NO_PROBLEM.format(encoding.domain))
    return _actions(problem, counted=counted)


def _actions(problem: Problem, *, counted: bool) -> dict[str, str]:
    """Return the text of each action, with its cost; without costs, where a step counts 1."""
    if counted:
        texts = {action.name: str(action) for action in problem.actions}
        return {
            name: "\n".join(line for line in text.splitlines() if _COSTS not in line) for name, text in texts.items()
        }
    costs = {}
    for metric in problem.quality_metrics:
        costs = {action.name: str(cost) for action, cost in getattr(metric, "costs", {}).items()}
    return {action.name: f"{action} cost {costs.get(action.name, '0')}" for action in problem.actions}


def _objects(problem: Problem, kind: str) -> list[str]:
    if not problem.has_type(kind):
        return []
    return [item.name for item in problem.objects(problem.user_type(kind))]


def _start(problem: Problem) -> Iterator[Fact]:
    """Yield the facts that hold at the start."""
    defaults = any(value is not None and value.is_true() for value in problem.fluents_defaults.values())
    values = problem.initial_values if defaults else problem.explicit_initial_values
    yield from (_fact(fluent) for fluent, value in values.items() if value.is_true())


def _goal(problem: Problem) -> Iterator[Fact]:
    for condition in problem.goals:
        yield from _conjuncts(condition)


def _conjuncts(condition: FNode) -> Iterator[Fact]:
    if condition.is_and():
        for part in condition.args:
            yield from _conjuncts(part)
    elif condition.is_fluent_exp():
        yield _fact(condition)
    elif not condition.is_true():
        raise Unsupported(f"the goal may be a conjunction of facts; {condition} is none")


def _fact(fluent: FNode) -> Fact:
    return (fluent.fluent().name, *(str(argument) for argument in fluent.args))
