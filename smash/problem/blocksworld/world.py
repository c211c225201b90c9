"""The classical blocks world: its states, its moves and the relations that a PDDL file may tell of them.

There are two: with a hand a block is taken (`Take`) and put (`Put`), without one it is moved (`Move`). All places are a
block or the table, which is `None` here and holds any number of blocks.
"""

from __future__ import annotations

import itertools
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Literal

Kind = Literal["take", "put", "move"]
TAKE: Kind = "take"
PUT: Kind = "put"
MOVE: Kind = "move"


@dataclass(frozen=True)
class Arrangement:
    """What every block lies on (`None`: the table), but for the held one."""

    below: Mapping[str, str | None]
    held: str | None = None

    @cached_property
    def above(self) -> dict[str, str]:
        """The block on each block that carries one."""
        return {under: upper for upper, under in self.below.items() if under is not None}

    def over(self, block: str) -> Iterator[str]:
        """Yield the blocks above a block, upwards."""
        while block in self.above:
            block = self.above[block]
            yield block

    def towers(self) -> list[tuple[str, ...]]:
        """Return the towers, bottom first, in the order of `below`."""
        return [(base, *self.over(base)) for base, under in self.below.items() if under is None]

    def key(self) -> tuple[frozenset[tuple[str, str | None]], str | None]:
        """Return what equal arrangements have in common."""
        return frozenset(self.below.items()), self.held


@dataclass(frozen=True, slots=True)
class Step:
    """One action of a blocks world: `block` is taken from, put on or moved from `source` to `target`."""

    kind: Kind
    block: str
    source: str | None = None
    target: str | None = None


def steps(state: Arrangement, *, hand: bool) -> Iterator[tuple[Step, Arrangement]]:
    """Yield every step that a state allows, and the state after it."""
    tops = [block for block in state.below if block not in state.above]
    if state.held is not None:
        for target in (None, *tops):
            below = {**state.below, state.held: target}
            yield Step(PUT, state.held, target=target), Arrangement(below)
        return
    for block in tops:
        source = state.below[block]
        if hand:
            below = {other: under for other, under in state.below.items() if other != block}
            yield Step(TAKE, block, source), Arrangement(below, block)
            continue
        for target in (None, *tops):
            if target not in (block, source):
                yield Step(MOVE, block, source, target), Arrangement({**state.below, block: target})


def arrangements(blocks: Sequence[str], *, hand: bool) -> Iterator[Arrangement]:
    """Yield every state of a few blocks."""
    for places in itertools.product(*((None, *(b for b in blocks if b != block)) for block in blocks)):
        state = Arrangement(dict(zip(blocks, places, strict=True)))
        carried = [under for under in places if under is not None]
        if len(set(carried)) == len(carried) and sum(map(len, state.towers())) == len(blocks):
            yield state
    if hand:
        for held in blocks:
            for state in arrangements([block for block in blocks if block != held], hand=False):
                yield Arrangement(state.below, held)


@dataclass(frozen=True, slots=True)
class Relation:
    """A thing that a predicate may say of a state.

    Attributes:
        name: what it is called here.
        arity: of how many blocks it is said.
        holds: whether it is true of a state and blocks.
        count: of how many (distinct) blocks it is true in a state; None: nobody counts it.
        only_hand: whether it says nothing where there is no hand.
    """

    name: str
    arity: int
    holds: Callable[..., bool]
    count: Callable[[Arrangement], int] | None = None
    only_hand: bool = False


def _is_above(state: Arrangement, upper: str, under: str) -> bool:
    return upper in state.over(under)


RELATIONS = {
    relation.name: relation
    for relation in (
        Relation(
            "on",
            2,
            lambda state, upper, under: state.below.get(upper) == under,
            lambda state: sum(under is not None for under in state.below.values()),
        ),
        Relation("above", 2, _is_above),
        Relation(
            "ontable",
            1,
            lambda state, block: block in state.below and state.below[block] is None,
            lambda state: sum(under is None for under in state.below.values()),
        ),
        Relation(
            "clear",
            1,
            lambda state, block: block != state.held and block not in state.above,
            lambda state: len(state.below) - len(state.above),
        ),
        Relation(
            "uncovered",
            1,
            lambda state, block: block not in state.above,
            lambda state: len(state.below) - len(state.above) + (state.held is not None),
            only_hand=True,
        ),
        Relation(
            "lying",
            1,
            lambda state, block: state.below.get(block) is not None,
            lambda state: sum(under is not None for under in state.below.values()),
            only_hand=True,
        ),
        Relation(
            "holding",
            1,
            lambda state, block: block == state.held,
            lambda state: int(state.held is not None),
            only_hand=True,
        ),
        Relation(
            "handempty", 0, lambda state: state.held is None, lambda state: int(state.held is None), only_hand=True
        ),
    )
}
"""Name -> relation. `clear` is not said of the held block, `uncovered` is; `lying`: on another block."""


@dataclass(frozen=True, slots=True)
class Meaning:
    """What a predicate says: a relation or its opposite, of the blocks at some of its arguments.

    Attributes:
        relation: the relation's name.
        places: which argument is its first block, its second.
        positive: False where the opposite of the relation is said.
        fixed: the other arguments: place and the thing (a table, a hand) that stands there.
    """

    relation: str
    places: tuple[int, ...]
    positive: bool = True
    fixed: tuple[tuple[int, str], ...] = ()

    def blocks_of(self, arguments: Sequence[str]) -> tuple[str, ...]:
        """Return the blocks that a fact is about, in the relation's order."""
        return tuple(arguments[place] for place in self.places)

    def atom(self, predicate: str, blocks: Sequence[str]) -> tuple[str, ...]:
        """Return the fact that says this of `blocks`."""
        arguments = dict(self.fixed) | dict(zip(self.places, blocks, strict=True))
        return (predicate, *(arguments[place] for place in sorted(arguments)))

    def true_of(self, state: Arrangement, blocks: Sequence[str]) -> bool:
        """Return whether the predicate holds of `blocks` in a state."""
        return RELATIONS[self.relation].holds(state, *blocks) == self.positive

    def count(self, state: Arrangement, blocks: int) -> int | None:
        """Return how many facts of the predicate are true in a state of so many blocks; None: nobody counts."""
        relation = RELATIONS[self.relation]
        if relation.count is None:
            return None
        whole = (1, blocks, blocks * (blocks - 1))[relation.arity]
        return relation.count(state) if self.positive else whole - relation.count(state)
