"""A domain's actions tried on a few blocks, against the steps of the classical blocks world.

Three blocks show all that an action of three blocks does; a fourth one stands by, so that conditions over all blocks
are seen to be about the right ones. What actions cannot tell apart they do to ten thousand blocks as they do to four.
"""

from __future__ import annotations

import itertools
from collections.abc import Hashable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from math import prod

from smash.problem.blocksworld.cast import BLOCK, Cast, Place, Sorts
from smash.problem.blocksworld.domain import Action, Domain
from smash.problem.blocksworld.formula import Atom, Facts, after
from smash.problem.blocksworld.typed import Types
from smash.problem.blocksworld.world import RELATIONS, Arrangement, Meaning, Step, arrangements, steps
from smash.problem.errors import Unsupported

MOST_GROUNDED = 2_000
"""The most combinations of arguments of one action; four blocks, a table and a hand make some hundred."""
MOST_CHANGES = 20_000
"""The most changes that one action makes with all its arguments together."""
Meanings = Mapping[str, Meaning | None]
"""Predicate -> what it says; None: it says nothing that matters."""


@dataclass(frozen=True)
class Grounded:
    """An action with its arguments."""

    action: Action
    binding: Mapping[str, str]

    @property
    def arguments(self) -> tuple[str, ...]:
        """The arguments, in order."""
        return tuple(self.binding.values())


@dataclass(frozen=True)
class Misfit:
    """What an action does, or fails to do, that a blocks world does not."""

    words: str
    assigned: int = 0


@dataclass
class Trial:
    """A few blocks of given kinds, with everything else of a problem.

    Attributes:
        domain: the domain.
        sorts: its sorts.
        cast: who plays.
        kinds: the kinds of the blocks that are tried.
        hand: whether blocks are taken and put, or moved.
    """

    domain: Domain
    sorts: Sorts
    cast: Cast
    kinds: tuple[int, ...]
    hand: bool
    _fitting_types: dict[Types, list[str]] = field(default_factory=dict)
    _encoded: dict[tuple[str, Meaning, int], frozenset[Atom]] = field(default_factory=dict)

    @cached_property
    def blocks(self) -> tuple[str, ...]:
        """The blocks that are tried; no PDDL object is called so."""
        return tuple(f"({number})" for number in range(len(self.kinds)))

    @cached_property
    def graph(self) -> list[tuple[Arrangement, list[tuple[Step, int]]]]:
        """Every state, with its steps and the numbers of the states after them."""
        return [
            (state, [(step, self._number[later.key()]) for step, later in steps(state, hand=self.hand)])
            for state in self._states
        ]

    @cached_property
    def _states(self) -> list[Arrangement]:
        return list(arrangements(self.blocks, hand=self.hand))

    @cached_property
    def _number(self) -> dict[Hashable, int]:
        return {state.key(): at for at, state in enumerate(self._states)}

    @cached_property
    def _typed(self) -> dict[str, Types]:
        cast = self.cast
        typed = {block: cast.kinds[kind].types for block, kind in zip(self.blocks, self.kinds, strict=True)}
        table = {} if cast.table is None else {cast.table: cast.table_types}
        return typed | table | dict(cast.others)

    @cached_property
    def _always(self) -> frozenset[Atom]:
        facts = set(self.cast.always)
        for block, kind in zip(self.blocks, self.kinds, strict=True):
            facts |= {tuple(block if name == BLOCK else name for name in atom) for atom in self.cast.kinds[kind].said}
        for atom, kinds in self.cast.pairs:
            for chosen in itertools.permutations(range(len(self.blocks)), len(kinds)):
                if tuple(self.kinds[at] for at in chosen) == kinds:
                    names = {f"{BLOCK}{number}": self.blocks[at] for number, at in enumerate(chosen)}
                    facts.add(tuple(names.get(name, name) for name in atom))
        return frozenset(facts)

    @cached_property
    def grounded(self) -> list[Grounded]:
        """Every action with arguments that fit; no block stands twice in one (a move onto itself leads nowhere)."""
        found = []
        for action in self.domain.actions:
            choices = [
                self._fitting(types, self.sorts.of_variable(action.name, name)) for name, types in action.parameters
            ]
            changes = sum(prod(len(self._things(of)) for _, of in one.variables) for one in action.effects)
            if prod(map(len, choices)) > MOST_GROUNDED or prod(map(len, choices)) * changes > MOST_CHANGES:
                raise Unsupported(f"{self.domain.where}: no blocks world: {action.name!r} has too many arguments")
            names = [name for name, _ in action.parameters]
            for chosen in itertools.product(*choices):
                among = [name for name in chosen if name in self.blocks]
                if len(set(among)) == len(among):
                    found.append(Grounded(action, dict(zip(names, chosen, strict=True))))
        return found

    def _fitting(self, types: Types, sort: Place | None) -> list[str]:
        fitting = self._things(types)
        if sort is None:
            return fitting
        ours = {*self.blocks, self.cast.table}
        return [name for name in fitting if (name in ours) == (sort == self.cast.sort)]

    def _things(self, types: Types) -> list[str]:
        if types not in self._fitting_types:
            fits = self.domain.types.fits
            self._fitting_types[types] = [name for name, own in self._typed.items() if fits(own, types)]
        return self._fitting_types[types]

    def encoding(self, meanings: Meanings, at: int) -> frozenset[Atom]:
        """Return the facts of a state, of the predicates that have a meaning."""
        parts = [self._facts_of(name, meaning, at) for name, meaning in meanings.items() if meaning is not None]
        return frozenset().union(*parts)

    def _facts_of(self, predicate: str, meaning: Meaning, at: int) -> frozenset[Atom]:
        key = (predicate, meaning, at)
        if key not in self._encoded:
            self._encoded[key] = frozenset(self._said(predicate, meaning, self.graph[at][0]))
        return self._encoded[key]

    def _said(self, predicate: str, meaning: Meaning, state: Arrangement) -> Iterator[Atom]:
        for blocks in itertools.permutations(self.blocks, len(meaning.places)):
            if meaning.true_of(state, blocks):
                yield meaning.atom(predicate, blocks)
        table = self.cast.table
        if table is None:
            return
        if meaning.relation == "on":
            for block in self.blocks:
                if RELATIONS["ontable"].holds(state, block) == meaning.positive:
                    yield meaning.atom(predicate, (block, table))

    def _facts(self, meanings: Meanings, at: int, of_table: frozenset[Atom]) -> Facts:
        unknown = frozenset(name for name in self.domain.fluents if meanings.get(name) is None)
        known = frozenset(atom for atom in of_table if atom[0] not in unknown)
        return Facts(self.encoding(meanings, at) | known, self._always, unknown, self.domain.rules, self._things)

    def _parted(self, state: frozenset[Atom]) -> tuple[frozenset[Atom], frozenset[Atom]]:
        """Return what a state says of blocks, and what it says of the table alone, which says nothing of blocks."""
        of_table = frozenset(atom for atom in state if len(atom) == 2 and atom[1] == self.cast.table)
        return state - of_table, of_table

    def missing(self, meanings: Meanings) -> Step | None:
        """Return a step of the blocks world that no action can be, whatever the predicates say that have no meaning."""
        return next(filter(None, (self._missing_at(meanings, at, self.cast.of_table) for at in self._numbers)), None)

    @cached_property
    def _numbers(self) -> range:
        return range(len(self.graph))

    def _missing_at(self, meanings: Meanings, at: int, of_table: frozenset[Atom]) -> Step | None:
        facts = self._facts(meanings, at, of_table)
        reached: set[frozenset[Atom]] = set()
        for one in self.grounded:
            if one.action.condition(facts, one.binding) is False:
                continue
            state = after(facts, one.action.effects, one.binding)
            if state is None:
                return None
            reached.add(self._parted(state)[0])
        following = self.graph[at][1]
        return next((step for step, later in following if self.encoding(meanings, later) not in reached), None)

    def says(self, predicate: str, meaning: Meaning, meanings: Meanings) -> bool:
        """Return whether a derived predicate says in every state what `meaning` says."""
        return all(
            self._facts(meanings, at, self.cast.of_table).holds(meaning.atom(predicate, blocks))
            == meaning.true_of(state, blocks)
            for at, (state, _) in enumerate(self.graph)
            for blocks in itertools.permutations(self.blocks, len(meaning.places))
        )

    def transitions(self, meanings: Meanings) -> list[tuple[Grounded, Step]] | Misfit:
        """Return what every action does, or what one does that is no step of a blocks world.

        Args:
            meanings: of every changing predicate.
        """
        codes = [self.encoding(meanings, at) for at in self._numbers]
        if len(set(codes)) < len(codes):
            return Misfit("its predicates do not tell all arrangements apart")
        found: list[tuple[Grounded, Step]] = []
        waiting, seen = [self.cast.of_table], {self.cast.of_table}
        while waiting:
            of_table = waiting.pop()
            for at in self._numbers:
                if (missing := self._missing_at(meanings, at, of_table)) is not None:
                    return Misfit(f"no action {step_words(missing)} as soon as the table is another")
                by_code = {codes[later]: step for step, later in [*self._moves(at), *self.graph[at][1]]}
                for one, code, after_it in self._results(meanings, at, of_table):
                    if code not in by_code and code != codes[at]:
                        return Misfit(f"the action {one.action.name!r} does what no step of a blocks world does")
                    if code in by_code:
                        found.append((one, by_code[code]))
                    if after_it not in seen:
                        seen.add(after_it)
                        waiting.append(after_it)
        return found

    def _moves(self, at: int) -> list[tuple[Step, int]]:
        """Return what a hand does in two steps, and an action may do at once: a block is taken and put elsewhere."""
        state = self.graph[at][0]
        if not self.hand or state.held is not None:
            return []
        return [(step, self._number[later.key()]) for step, later in steps(state, hand=False)]

    def _results(
        self, meanings: Meanings, at: int, of_table: frozenset[Atom]
    ) -> Iterator[tuple[Grounded, frozenset[Atom], frozenset[Atom]]]:
        """Yield what applies to a state, with what is then said of blocks and of the table."""
        facts = self._facts(meanings, at, of_table)
        for one in self.grounded:
            if one.action.condition(facts, one.binding) is not False:
                state = after(facts, one.action.effects, one.binding)
                yield one, *self._parted(frozenset({("?",)}) if state is None else state)


def step_words(step: Step) -> str:
    """Return what a step does, in words."""
    source = "the table" if step.source is None else "another block"
    target = "the table" if step.target is None else "another block"
    match step.kind:
        case "take":
            return f"takes a block from {source} into the hand"
        case "put":
            return f"puts the block in the hand on {target}"
        case "move":
            return f"moves a block from {source} to {target}"


def samples(kinds: int, most: int) -> Sequence[tuple[int, ...]]:
    """Return which kinds of blocks to try together: every two kinds meet."""
    if kinds == 1:
        return [(0,) * most]
    return [tuple(sorted((one, other) * 2)) for one, other in itertools.combinations(range(kinds), 2)]
