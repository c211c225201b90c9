"""A unified-planning problem of our domains back to an instance."""

from __future__ import annotations

from collections.abc import Iterator
from functools import cache
from typing import TYPE_CHECKING

from smash.problem.errors import Unsupported
from smash_baselines.encodings import BY_DOMAIN, ENCODINGS, Encoding
from smash_baselines.names import Fact
from smash_baselines.read_problem import RawProblem, ReadProblem, interpret

if TYPE_CHECKING:
    from unified_planning.model import FNode, Problem

_NO_PROBLEM = """(define (problem none) (:domain {}) (:init (= (total-cost) 0)) (:goal (and))
                  (:metric minimize (total-cost)))"""
"""The library reads costs as costs only where a problem minimises them."""


def read_up_problem(problem: Problem) -> ReadProblem:
    """Return the instance of a unified-planning problem.

    Its actions must be those of one of our domains, word for word: from `smash_baselines.up_problem`, or by the
    library's PDDL reader from `smash export-pddl` or any other problem file of these domains.

    Raises:
        Unsupported: where the actions are other ones, or the goal is no conjunction of facts.
        MalformedFile: where the facts describe no instance.
    """
    encoding = _encoding_of(problem)
    objects = {kind: _objects(problem, kind) for kind in ("block", "location", "count")}
    start = [_fact(fluent) for fluent, value in problem.explicit_initial_values.items() if value.is_true()]
    goal = [fact for condition in problem.goals for fact in _conjuncts(condition)]
    return interpret(RawProblem(encoding, problem.name or "problem", objects, start, goal, where="problem"))


def _encoding_of(problem: Problem) -> Encoding:
    said = _actions(problem)
    alike = [encoding for encoding in BY_DOMAIN.values() if said.keys() == _reference(encoding).keys()]
    for encoding in alike:
        if said == _reference(encoding):
            return encoding
    for encoding in alike:
        changed = next(name for name, text in said.items() if text != _reference(encoding)[name])
        raise Unsupported(f"action {changed!r} is not as in {encoding.domain}")
    domains = ", ".join(encoding.domain for encoding in ENCODINGS.values())
    raise Unsupported(f"the problem's actions are those of none of the domains {domains}")


@cache
def _reference(encoding: Encoding) -> dict[str, str]:
    from unified_planning.io import PDDLReader

    return _actions(PDDLReader().parse_problem_string(encoding.text, _NO_PROBLEM.format(encoding.domain)))


def _actions(problem: Problem) -> dict[str, str]:
    costs = {}
    for metric in problem.quality_metrics:
        costs = {action.name: str(cost) for action, cost in getattr(metric, "costs", {}).items()}
    return {action.name: f"{action} cost {costs.get(action.name, '0')}" for action in problem.actions}


def _objects(problem: Problem, kind: str) -> list[str]:
    if not problem.has_type(kind):
        return []
    return [item.name for item in problem.objects(problem.user_type(kind))]


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
