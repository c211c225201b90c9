"""Who plays in a domain: which arguments are of one sort, which objects are blocks, what tells blocks apart.

Two arguments are of one sort where a variable of an action stands at both. The sort of the blocks is that of a
predicate that two of them share and actions change. Blocks that no action can tell apart are of one kind.
"""

from __future__ import annotations

from collections import Counter, defaultdict
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from math import perm

from smash.problem.blocksworld.domain import Domain
from smash.problem.blocksworld.formula import Atom
from smash.problem.blocksworld.typed import OBJECT, Types
from smash.problem.errors import Unsupported

Place = tuple[str, int]
"""A predicate, and which of its arguments."""
Objects = Mapping[str, Types]
"""Object -> its types."""
MOST_KINDS = 8
BLOCK = "?"
"""What stands for a block in what is said of one."""


class Sorts:
    """The arguments of a domain's predicates, by sort."""

    def __init__(self, domain: Domain) -> None:
        self.domain = domain
        self._parent: dict[Place, Place] = {}
        self._of_variable: dict[tuple[str, str], Place] = {}
        owners = [(action.name, action.atoms) for action in domain.actions]
        owners += [(f":derived {atoms[0][0]}", atoms) for atoms in domain.rule_atoms]
        for owner, atoms in owners:
            for predicate, *names in atoms:
                for number, name in enumerate(names):
                    place = self.find((predicate, number))
                    if name.startswith("?"):
                        self._parent[place] = self.find(self._of_variable.setdefault((owner, name), place))

    def find(self, place: Place) -> Place:
        """Return the sort of an argument: one argument that stands for all of it."""
        self._parent.setdefault(place, place)
        while self._parent[place] != place:
            self._parent[place] = place = self._parent[self._parent[place]]
        return place

    def of_variable(self, action: str, variable: str) -> Place | None:
        """Return the sort of an action's variable; None where it stands in no atom."""
        place = self._of_variable.get((action, variable))
        return None if place is None else self.find(place)

    @cached_property
    def types(self) -> dict[Place, list[Types]]:
        """The types that actions ask for, by sort."""
        asked: dict[Place, list[Types]] = defaultdict(list)
        for action in self.domain.actions:
            for variable, types in action.parameters:
                place = self.of_variable(action.name, variable)
                if place is not None:
                    asked[place].append(types)
        return asked

    @cached_property
    def of_blocks(self) -> tuple[Place, ...]:
        """The sorts that the blocks may be: those of changing predicates that two of them share."""
        fluents = self.domain.fluents
        found = (self.find((name, 0)) for name, arity in fluents.items() if arity == 2)
        return tuple(dict.fromkeys(sort for sort in found if self._twice(sort)))

    def _twice(self, sort: Place) -> bool:
        fluents = self.domain.fluents
        return any(
            arity == 2 and self.find((name, 0)) == self.find((name, 1)) == sort for name, arity in fluents.items()
        )

    def members(self, sort: Place, objects: Objects, facts: Iterable[Atom]) -> tuple[str, ...]:
        """Return the objects of a sort: facts say it of them, or a type that is not everybody's."""
        tree = self.domain.types
        told = {
            name for predicate, *names in facts for at, name in enumerate(names) if self.find((predicate, at)) == sort
        }
        asked = {name for types in self.types[sort] for name in types} - {OBJECT}
        fitting = {types: tree.fits(types, asked) for types in set(objects.values())}
        admitted = {
            types: all(tree.fits(types, wanted) for wanted in self.types[sort]) for types in set(objects.values())
        }
        return tuple(
            name
            for name, types in objects.items()
            if fitting[types] or (name in told and (admitted[types] or not asked))
        )


@dataclass(frozen=True)
class BlockKind:
    """Blocks that no action tells apart: by the types that fit them, and by what never changes of them."""

    types: Types
    said: frozenset[Atom]


@dataclass(frozen=True)
class Cast:
    """The objects of a problem, as the actions of its domain see them.

    Attributes:
        sort: the sort of the blocks.
        table: the block-like object that is the table; None where there is none.
        others: the objects that are neither a block nor the table, with their types.
        kinds: the kinds of blocks.
        pairs: what always holds of all distinct blocks of some kinds: (fact with numbers for blocks, their kinds).
        always: what always holds without a block in it.
        of_table: the changing facts about the table alone, as they are at the start.
        table_types: the types of the table.
        rest: the objects of each other sort that changing predicates have arguments of: the hand.
    """

    sort: Place
    table: str | None
    others: tuple[tuple[str, Types], ...]
    kinds: tuple[BlockKind, ...]
    pairs: frozenset[tuple[Atom, tuple[int, ...]]]
    always: frozenset[Atom]
    of_table: frozenset[Atom]
    table_types: Types
    rest: tuple[tuple[Place, tuple[str, ...]], ...]


@dataclass
class CastMaker:
    """Makes the casts of one problem of a domain.

    Attributes:
        domain: the domain.
        sorts: its sorts.
        objects: the problem's objects, the domain's constants among them.
        facts: the facts of its start.
    """

    domain: Domain
    sorts: Sorts
    objects: Objects
    facts: Sequence[Atom]

    def tables(self, sort: Place) -> Iterator[str | None]:
        """Yield the objects that may be the table, the likeliest first; None for none."""
        members = self.sorts.members(sort, self.objects, self.facts)
        named = frozenset().union(*(action.names for action in self.domain.actions))
        constants = [name for name, _ in self.domain.constants if name in named and name in members]
        yield from constants
        yield None
        upper = {
            atom[1]
            for atom in self.facts
            if len(atom) == 3 and atom[0] in self.domain.fluents and self.sorts.find((atom[0], 0)) == sort
        }
        never = [name for name in members if name not in upper and name not in constants]
        yield from never if len(never) <= 2 else []

    def cast(self, sort: Place, table: str | None) -> Cast:
        """Return the cast with a given sort of blocks and a given table.

        Raises:
            Unsupported: where blocks are told apart in more ways than are looked at.
        """
        listed = [name for name in self.sorts.members(sort, self.objects, self.facts) if name != table]
        blocks = frozenset(listed)
        others = [(name, types) for name, types in self.objects.items() if name not in blocks and name != table]
        single, pairs, always = self._never_changing(blocks)
        kinds: dict[BlockKind, int] = {}
        of_block: dict[str, int] = {}
        seen: dict[Types, Types] = {}
        for block in listed:
            types = self.objects[block]
            if types not in seen:
                seen[types] = self._told_apart(types)
            kind = BlockKind(seen[types], frozenset(single.get(block, ())))
            of_block[block] = kinds.setdefault(kind, len(kinds))
        if len(kinds) > MOST_KINDS:
            raise Unsupported(f"{self.domain.where}: its actions tell blocks apart in {len(kinds)} ways")
        about_table = frozenset(
            atom for atom in self.facts if table in atom[1:] and atom[0] in self.domain.fluents and len(atom) == 2
        )
        return Cast(
            sort=sort,
            table=table,
            others=tuple(others),
            kinds=tuple(kinds),
            pairs=self._of_all(pairs, of_block),
            always=frozenset(always),
            of_table=about_table,
            table_types=(OBJECT,) if table is None else self.objects[table],
            rest=self._rest(sort),
        )

    def _rest(self, sort: Place) -> tuple[tuple[Place, tuple[str, ...]], ...]:
        fluents = self.domain.fluents
        places = (self.sorts.find((name, number)) for name, arity in fluents.items() for number in range(arity))
        others = dict.fromkeys(place for place in places if place != sort)
        return tuple((place, self.sorts.members(place, self.objects, self.facts)) for place in others)

    def _told_apart(self, types: Types) -> Types:
        """Return those types of a block that some action asks for."""
        asked = {name for action in self.domain.actions for _, wanted in action.parameters for name in wanted}
        return tuple(sorted((self.domain.types.all_of(types) | {OBJECT}) & (asked | {OBJECT})))

    def _never_changing(self, blocks: frozenset[str]) -> tuple[dict[str, list[Atom]], list[Atom], list[Atom]]:
        """Return what actions ask for and never change: of one block each, of several, of none."""
        asked = frozenset().union(
            *(action.reads for action in self.domain.actions), *self.domain.rule_reads.values()
        ) - set(self.domain.fluents)
        single: dict[str, list[Atom]] = defaultdict(list)
        several: list[Atom] = []
        none: list[Atom] = []
        for atom in self.facts:
            if atom[0] not in asked:
                continue
            about = {name for name in atom[1:] if name in blocks}
            if len(about) == 1:
                (block,) = about
                single[block].append(tuple(BLOCK if name == block else name for name in atom))
            else:
                (several if about else none).append(atom)
        return single, several, none

    def _of_all(self, facts: Sequence[Atom], kinds: Mapping[str, int]) -> frozenset[tuple[Atom, tuple[int, ...]]]:
        """Return what is said of all distinct blocks of some kinds.

        Raises:
            Unsupported: where something is said of some and not of others.
        """
        counts: Counter[tuple[Atom, tuple[int, ...]]] = Counter()
        example: dict[tuple[Atom, tuple[int, ...]], Atom] = {}
        for atom in dict.fromkeys(facts):
            numbers: dict[str, int] = {}
            shape = [atom[0]]
            for name in atom[1:]:
                shape.append(f"{BLOCK}{numbers.setdefault(name, len(numbers))}" if name in kinds else name)
            key = (tuple(shape), tuple(kinds[name] for name in numbers))
            counts[key] += 1
            example[key] = atom
        sizes = Counter(kinds.values())
        for key, count in counts.items():
            whole = 1
            for kind, times in Counter(key[1]).items():
                whole *= perm(sizes[kind], times)
            if count != whole:
                fact = f"({' '.join(example[key])})"
                raise Unsupported(f"`:init`: {fact} is said of some blocks and not of others; not supported")
        return frozenset(counts)
