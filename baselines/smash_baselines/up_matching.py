"""Is a unified-planning problem a blocks world with a hand? Known by what its four actions do, not by names."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass
from itertools import permutations, product
from typing import TYPE_CHECKING

from smash_baselines.names import Fact

if TYPE_CHECKING:
    from unified_planning.model import Action as UpAction
    from unified_planning.model import Problem

ROLES = {"on": 2, "ontable": 1, "clear": 1, "holding": 1, "handempty": 0}
"""What the facts of a blocks world are about, with the number of blocks that each names."""

Said = tuple[frozenset[Fact], frozenset[tuple[Fact, bool]]]
"""What an action needs and what it changes: facts about `x` and `y`, each made true or false."""


def _schema(needs: str, adds: str, deletes: str) -> Said:
    def facts(text: str) -> list[Fact]:
        return [tuple(fact.split()) for fact in text.split(", ")]

    changes = [*((fact, True) for fact in facts(adds)), *((fact, False) for fact in facts(deletes))]
    return frozenset(facts(needs)), frozenset(changes)


SCHEMAS: Mapping[str, Said] = {
    "pick-up": _schema("clear x, ontable x, handempty", "holding x", "ontable x, clear x, handempty"),
    "put-down": _schema("holding x", "ontable x, clear x, handempty", "holding x"),
    "stack": _schema("holding x, clear y", "on x y, clear x, handempty", "holding x, clear y"),
    "unstack": _schema("on x y, clear x, handempty", "holding x, clear y", "on x y, clear x, handempty"),
}
"""The four actions of the blocks world with a hand."""


@dataclass(frozen=True, slots=True)
class Matched:
    """How a problem calls the parts of a blocks world.

    Attributes:
        fluents: role -> name of the fluent.
        turned: whether its `on` names the lower block first.
        actions: action of `SCHEMAS` -> name of the action, and whether its parameters are (y, x).
    """

    fluents: Mapping[str, str]
    turned: bool
    actions: Mapping[str, tuple[str, bool]]


def in_roles(facts: Iterable[Fact], role_of: Mapping[str, str], *, turned: bool) -> list[Fact]:
    """Return facts about the parts of a blocks world, by role; those about anything else are left out.

    Args:
        facts: facts by the problem's names.
        role_of: fluent -> role.
        turned: whether the problem's `on` names the lower block first.
    """
    return [
        (role_of[name], *(reversed(blocks) if turned and role_of[name] == "on" else blocks))
        for name, *blocks in facts
        if name in role_of
    ]


def match(problem: Problem) -> Matched | None:
    """Return how a problem calls the parts of a blocks world with a hand, or None where it is none."""
    said = [_said(action) for action in problem.actions]
    if len(said) != len(SCHEMAS) or any(one is None for one in said):
        return None
    used = {fact[0]: len(fact) - 1 for one in said if one for fact in (*one[0], *(fact for fact, _ in one[1]))}
    if sorted(used.values()) != sorted(ROLES.values()):
        return None
    [on], [empty] = ([name for name, arity in used.items() if arity == wanted] for wanted in (2, 0))
    unary = [name for name, arity in used.items() if arity == 1]
    for (ontable, clear, holding), turned in product(permutations(unary), (False, True)):
        fluents = {"on": on, "ontable": ontable, "clear": clear, "holding": holding, "handempty": empty}
        actions = _match_actions(problem, fluents, turned=turned)
        if actions is not None:
            return Matched(fluents, turned, actions)
    return None


def _match_actions(problem: Problem, fluents: Mapping[str, str], *, turned: bool) -> dict[str, tuple[str, bool]] | None:
    role_of = {name: role for role, name in fluents.items()}
    found: dict[str, tuple[str, bool]] = {}
    for action in problem.actions:
        for swapped in (False, True):
            said = _said(action, swapped=swapped)
            assert said is not None
            known = _renamed(said, role_of, turned=turned)
            kind = next((kind for kind, schema in SCHEMAS.items() if schema == known), None)
            if kind is not None:
                found[kind] = (action.name, swapped and len(action.parameters) == 2)
                break
    return found if len(found) == len(SCHEMAS) else None


def _renamed(said: Said, role_of: Mapping[str, str], *, turned: bool) -> Said:
    def fact_of(fact: Fact) -> Fact:
        [renamed] = in_roles([fact], role_of, turned=turned)
        return renamed

    return frozenset(map(fact_of, said[0])), frozenset((fact_of(fact), value) for fact, value in said[1])


def _said(action: UpAction, *, swapped: bool = False) -> Said | None:
    """Return what an action needs and changes; None where it is no plain STRIPS action of one or two blocks."""
    variables = ["y", "x"] if swapped and len(action.parameters) == 2 else ["x", "y"]
    if not 1 <= len(action.parameters) <= 2 or not hasattr(action, "preconditions"):
        return None
    name_of = {parameter.name: variable for parameter, variable in zip(action.parameters, variables, strict=False)}
    needs = list(_facts(action.preconditions, name_of))
    changes = []
    for effect in action.effects:
        plain = effect.is_assignment() and not effect.is_conditional() and effect.value.is_bool_constant()
        fact = _fact(effect.fluent, name_of) if plain else None
        if fact is None:
            return None
        changes.append((fact, effect.value.is_true()))
    if any(fact is None for fact in needs):
        return None
    return frozenset(fact for fact in needs if fact), frozenset(changes)


def _facts(conditions: Iterable[object], name_of: Mapping[str, str]) -> Iterator[Fact | None]:
    for condition in conditions:
        if condition.is_and():  # type: ignore[attr-defined]
            yield from _facts(condition.args, name_of)  # type: ignore[attr-defined]
        elif not condition.is_true():  # type: ignore[attr-defined]
            yield _fact(condition, name_of)


def _fact(condition: object, name_of: Mapping[str, str]) -> Fact | None:
    if not condition.is_fluent_exp():  # type: ignore[attr-defined]
        return None
    arguments = [str(argument) for argument in condition.args]  # type: ignore[attr-defined]
    if any(argument not in name_of for argument in arguments):
        return None
    return (condition.fluent().name, *(name_of[argument] for argument in arguments))  # type: ignore[attr-defined]
