"""The precedence graph: per block a removal and a final placement, and what must come before what.

Nodes: `R(b)` is the first removal of a leaving block from its start pile, `P(b)` its final placement.
Edges (each holds in every plan): `R(upper) -> R(lower)` within a start pile; `P(under) -> P(upper)` within a
goal chain; `R(lowest leaving) -> P(first of the chain)` at a location; `R(b) -> P(b)`. A block that moves
once, straight to its place, has one event for both, which is the *back edge* `P(b) -> R(b)`. Hence on
every cycle at least one of the blocks whose back edge it uses does not move directly: it is *freed* by a
topple that removes it, or by being put aside first. The choices are those of `Choice`, and the fewest
actions that hit all cycles bound the cost of every plan from below (`docs/theory.md`).
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np
import numpy.typing as npt

from smash.problem.problem import Problem
from smash.problem.views.demands import Demands

Floats = npt.NDArray[np.float64]
Ints = npt.NDArray[np.int64]

ASIDE_COST = 2
TOPPLE_COST = 1
MOVE_COST = 2


class Choice(NamedTuple):
    """One way to free blocks of a start pile from moving directly.

    `low` and `high` are heights at the start, both included. A topple (cost 1) frees all of them; without
    it (`topple` false, cost 2) the one block is put aside.
    """

    location: str
    low: int
    high: int
    topple: bool

    @property
    def cost(self) -> int:
        """Actions on top of those that every plan needs."""
        return TOPPLE_COST if self.topple else ASIDE_COST


@dataclass(frozen=True, slots=True)
class PrecedenceGraph:
    """The graph as arrays, and the choices that break its cycles.

    Blocks are numbered by start pile, top first, then those of the table region (no removal event).

    Attributes:
        demands: what the goal asks.
        blocks: names by number.
        piles: `(location, first number, end)` of each start pile with a leaving block, top first.
        chains: numbers of each goal chain, bottom first.
        first: per pile the number of the first block placed on its kept part, or -1.
        placed: per block, whether it has a final placement.
        choices: what can be chosen; `choice_low[b]:choice_high[b]` are those that free block b.
        must_free: loose blocks that only a topple removes without a move of their own.
        base_cost: the actions that every plan needs, whatever is chosen.
    """

    demands: Demands
    blocks: tuple[str, ...]
    piles: tuple[tuple[str, int, int], ...]
    chains: tuple[Ints, ...]
    first: tuple[int, ...]
    placed: npt.NDArray[np.bool_]
    choices: tuple[Choice, ...]
    choice_low: Ints
    choice_high: Ints
    must_free: tuple[int, ...]
    base_cost: int

    @property
    def costs(self) -> Floats:
        """Cost of each choice."""
        return np.array([choice.cost for choice in self.choices], dtype=float)

    def freedom(self, values: Floats) -> Floats:
        """Return per block the sum of the values of the choices that free it.

        Args:
            values: one value per choice.
        """
        sums = np.concatenate(([0.0], np.cumsum(values)))
        free: Floats = sums[self.choice_high] - sums[self.choice_low]
        return free

    def row(self, blocks: Any) -> frozenset[int]:
        """Return the choices of which one must be taken, so that one of `blocks` does not move directly."""
        return frozenset(c for b in blocks for c in range(int(self.choice_low[b]), int(self.choice_high[b])))


def build_graph(problem: Problem, demands: Demands | None = None) -> PrecedenceGraph:
    """Build the precedence graph of a problem and the choices that its options allow.

    Args:
        problem: a plain one.
        demands: what is asked of the blocks, where that is more than what the goal does.
    """
    instance, options, demands = problem.instance, problem.options, demands or problem.demands
    blocks: list[str] = []
    piles: list[tuple[str, int, int]] = []
    for location, pile in demands.leaving.items():
        if pile:
            piles.append((location, len(blocks), len(blocks) + len(pile)))
            blocks.extend(reversed(pile))
    blocks.extend(block for block in instance.table if block in demands.placed)
    number = {block: index for index, block in enumerate(blocks)}
    located = {location: _numbers(chain, number) for location, chain in demands.build.items()}
    chains = [*located.values(), *(_numbers(chain.blocks, number) for chain in demands.floating)]
    first = tuple(int(located[location][0]) if location in located else -1 for location, _, _ in piles)
    placed = np.array([block in demands.placed for block in blocks], dtype=bool)
    choices: list[Choice] = []
    low = np.zeros(len(blocks), dtype=np.int64)
    high = np.zeros(len(blocks), dtype=np.int64)
    must_free: list[int] = []
    loose_moves = 0
    toppled = frozenset(instance.stacks) if options.topple else frozenset()
    for location, begin, end in piles:
        keep = demands.keep[location]
        if location in toppled:
            _windows(choices, low, high, location, keep, (begin, end), options.max_topple)
            must_free.extend(index for index in range(begin, end) if not placed[index])
            continue
        for index in range(begin, end):
            low[index] = high[index] = len(choices)
            if placed[index]:
                height = keep + end - index
                choices.append(Choice(location, height, height, topple=False))
                high[index] += 1
            else:
                loose_moves += 1
    return PrecedenceGraph(
        demands=demands,
        blocks=tuple(blocks),
        piles=tuple(piles),
        chains=tuple(chains),
        first=first,
        placed=placed,
        choices=tuple(choices),
        choice_low=low,
        choice_high=high,
        must_free=tuple(must_free),
        base_cost=MOVE_COST * (len(demands.placed) + loose_moves),
    )


def _numbers(chain: tuple[str, ...], number: dict[str, int]) -> Ints:
    return np.array([number[block] for block in chain], dtype=np.int64)


def _windows(
    choices: list[Choice],
    low: Ints,
    high: Ints,
    location: str,
    keep: int,
    span: tuple[int, int],
    cap: int | None,
) -> None:
    """Add one choice per run of as many leaving blocks as one topple takes; shorter runs free no more for the price."""
    begin, end = span
    count = end - begin
    size = count if cap is None else min(cap, count)
    base = len(choices)
    for offset in range(count - size + 1):  # blocks begin+offset .. begin+offset+size-1, top first
        top = keep + count - offset
        choices.append(Choice(location, top - size + 1, top, topple=True))
    for position in range(count):
        low[begin + position] = base + max(0, position - size + 1)
        high[begin + position] = base + min(position, count - size) + 1
