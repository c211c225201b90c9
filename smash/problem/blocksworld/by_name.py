"""The reading of a problem without its domain: by the usual names of predicates."""

from __future__ import annotations

from collections.abc import Iterable, Iterator

from smash.problem.blocksworld.formula import Atom
from smash.problem.blocksworld.reading import HAND_TYPES, TABLE_NAMES, USUAL, Reading, usual, usual_relation
from smash.problem.blocksworld.sections import ProblemText
from smash.problem.blocksworld.sexpr import Expression
from smash.problem.blocksworld.typed import OBJECT
from smash.problem.blocksworld.world import RELATIONS, Meaning
from smash.problem.errors import Unsupported

ACTION_FACTS = frozenset({"pickup", "pick-up", "putdown", "put-down", "stack", "unstack"})
"""Some collections name the actions in the start; they say nothing about it."""
RELATION_NAMES = tuple(USUAL)
TYPE_FACTS = frozenset({"block", "table", OBJECT}) | HAND_TYPES


def reading_by_name(problem: ProblemText) -> tuple[Reading, tuple[str, ...]]:
    """Return how a problem tells a blocks world by the usual names, and the predicates that are not among them.

    Raises:
        Unsupported: where it has several hands.
    """
    atoms = [*problem.facts, *_goal_atoms(problem.goal)]
    hands = _hands(problem, atoms)
    if len(hands) > 1:
        raise Unsupported(f"{problem.where}: several hands ({', '.join(hands[:4])}); one is supported")
    table = _table(problem)
    others = frozenset(hands) | frozenset(_bystanders(problem, {*hands, table}))
    meanings: dict[str, Meaning] = {}
    for atom in atoms:
        meaning = _meaning(atom, others)
        if meaning is not None:
            meanings.setdefault(atom[0], meaning)
    told = {meanings[atom[0]].relation for atom in problem.facts if atom[0] in meanings}
    hand = "handempty" in told or "holding" in told
    for relation in RELATION_NAMES:
        wanted = hand if relation in ("holding", "handempty") else relation != "ontable" or table is None
        if wanted and not any(meaning.relation == relation for meaning in meanings.values()):
            meanings[relation] = Meaning(relation, tuple(range(RELATIONS[relation].arity)))
    types = {name for listed in problem.objects.values() for name in listed}
    unknown = dict.fromkeys(
        atom[0]
        for atom in problem.facts
        if atom[0] not in meanings
        and usual(atom[0]) not in ACTION_FACTS
        and not (len(atom) == 2 and (atom[0] in types or usual(atom[0]) in TYPE_FACTS))
    )
    unknown |= dict.fromkeys(function for function in problem.functions if function != "total-cost")
    return Reading(hand, meanings, table, others), tuple(unknown)


def _meaning(atom: Atom, others: frozenset[str]) -> Meaning | None:
    """Return what a fact's predicate says; an argument that is a hand says nothing."""
    known = usual_relation(atom[0])
    if known is None:
        return None
    relation, positive = known
    fixed = {number: name for number, name in enumerate(atom[1:]) if name in others}
    places = tuple(number for number in range(len(atom) - 1) if number not in fixed)
    if len(places) != RELATIONS[relation].arity or (fixed and relation not in ("holding", "handempty")):
        return None
    return Meaning(relation, places, positive, tuple(fixed.items()))


def _hands(problem: ProblemText, atoms: Iterable[Atom]) -> list[str]:
    """Return the objects that are a hand: by their type, or because one is said to be empty or full."""
    typed = [name for name, types in problem.objects.items() if not HAND_TYPES.isdisjoint(types)]
    told = [
        atom[1]
        for atom in atoms
        if len(atom) == 2 and ((usual_relation(atom[0]) or ("",))[0] == "handempty" or usual(atom[0]) in HAND_TYPES)
    ]
    return [name for name in dict.fromkeys([*typed, *told]) if name in problem.objects]


def _table(problem: ProblemText) -> str | None:
    """Return the object that is the table: one of its names, on which something lies and which lies on nothing."""
    if "table" in problem.objects:
        return "table"
    named = [name for name in problem.objects if usual(name) in TABLE_NAMES]
    under = {atom[2] for atom in problem.facts if atom[0] == "on" and len(atom) == 3}
    upper = {atom[1] for atom in problem.facts if len(atom) > 1 and atom[0] == "on"}
    grounded = {atom[1] for atom in problem.facts if len(atom) == 2 and usual_relation(atom[0]) == ("ontable", True)}
    return next((name for name in named if name in under and name not in upper | grounded), None)


def _bystanders(problem: ProblemText, known: set[str | None]) -> Iterator[str]:
    """Yield the objects that no relation is said of, and whose type is none of a block's."""
    standing = {name for atom in problem.facts if usual_relation(atom[0]) is not None for name in atom[1:]}
    types = {name for block in standing - known if block in problem.objects for name in problem.objects[block]}
    for name, own in problem.objects.items():
        if name not in standing and name not in known and OBJECT not in own and types.isdisjoint(own):
            yield name


def _goal_atoms(expression: Expression) -> Iterator[Atom]:
    """Yield the atoms of a goal, whatever stands around them."""
    if not isinstance(expression, list) or not expression:
        return
    if isinstance(expression[0], str) and all(isinstance(part, str) for part in expression):
        yield tuple(part for part in expression if isinstance(part, str))
    for part in expression:
        yield from _goal_atoms(part)
