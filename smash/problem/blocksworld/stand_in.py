"""Objects and facts that stand in for a problem file, where a domain is all that is given."""

from __future__ import annotations

import itertools
from collections.abc import Sequence
from dataclasses import replace

from smash.problem.blocksworld.cast import Place, Sorts
from smash.problem.blocksworld.domain import Domain
from smash.problem.blocksworld.formula import Atom
from smash.problem.blocksworld.reading import Reading
from smash.problem.blocksworld.typed import OBJECT, Types

ENOUGH = 4
"""So many blocks stand for all of them."""


def stand_in(
    domain: Domain, sorts: Sorts, sort: Place, blocks: Sequence[str], *, whole: bool, of_table: str | None
) -> tuple[dict[str, Types], list[Atom]]:
    """Return objects with their types, and facts, for a domain of which no problem is known.

    Args:
        domain: the domain.
        sorts: its sorts.
        sort: the sort of the blocks.
        blocks: the names of all blocks; constants of the domain may be among them.
        whole: whether what never changes holds of all distinct objects, or of none.
        of_table: the changing predicate that is said of constants that actions name (the table); None: none.
    """
    constants = dict(domain.constants)
    ours = [name for name in blocks if name not in constants][:ENOUGH]
    objects = {name: _type_for(domain, sorts, sort) for name in ours}
    named = frozenset().union(*(action.names for action in domain.actions))
    fixed = [name for name in constants if name in named]
    members = {sort: [*ours, *(name for name in constants if name in named or name in blocks)]}
    reads = frozenset().union(*(action.reads for action in domain.actions), *domain.rule_reads.values())
    arity = {atom[0]: len(atom) - 1 for action in domain.actions for atom in action.atoms}
    for predicate in (*domain.fluents, *sorted(reads & set(arity))):
        for number in range(arity[predicate]):
            other = sorts.find((predicate, number))
            if other not in members:
                name = f"(the {len(members)}.)"
                objects[name] = _type_for(domain, sorts, other)
                members[other] = [name]
    facts: list[Atom] = [] if of_table is None else [(of_table, name) for name in fixed]
    for predicate in sorted(reads & set(arity)) if whole else []:
        if predicate not in domain.fluents and predicate not in domain.rules:
            columns = [members[sorts.find((predicate, number))] for number in range(arity[predicate])]
            facts += [(predicate, *names) for names in itertools.product(*columns) if len(set(names)) == len(names)]
    for predicate, count in domain.fluents.items():
        if count == 2 and sorts.find((predicate, 0)) == sort == sorts.find((predicate, 1)):
            facts += [(predicate, ours[0], name) for name in members[sort]] if ours else []
            facts += [(predicate, name, name) for name in ours]
    return objects, facts


def _type_for(domain: Domain, sorts: Sorts, sort: Place) -> Types:
    """Return a type that fits wherever actions ask for a sort; `object` where none does."""
    asked = sorts.types[sort]
    known = [name for types in asked for name in types] + list(domain.types.parents)
    fitting = (name for name in known if all(domain.types.fits((name,), wanted) for wanted in asked))
    return (next(fitting, OBJECT),)


def without_names(reading: Reading, objects: frozenset[str]) -> Reading:
    """Return a reading in which the objects that stood in are not asked for by name."""
    templates = tuple(
        replace(one, fixed=tuple((place, thing) for place, thing in one.fixed if thing not in objects))
        for one in reading.templates
    )
    return replace(reading, templates=templates)
