"""The order of what rests on one another: who came later lies above, and leaves first or along with who is below.

It is left out of the relaxation at first: few solutions break it, and it takes a column for each pair of blocks,
location and layer.
"""

from __future__ import annotations

import itertools
from dataclasses import dataclass

from smash.planners.layered.network.moving import Moving
from smash.planners.milp.arrays import Ints, MilpBuilder


@dataclass(frozen=True, slots=True)
class OrderColumns:
    """The columns of the relaxation that the order speaks of (`RelaxedModel`); `rests`: (t+1, b, l)."""

    move: Ints
    fall: Ints
    lifted: Ints
    rests: Ints


def add_resting_order(milp: MilpBuilder, moving: Moving, columns: OrderColumns) -> None:
    """Add for each pair of blocks and location the state that one lies above the other, and what it forbids."""
    layers, n, locations = columns.rests.shape[0] - 1, *columns.rests.shape[1:]
    above = milp.add_columns(n * n * locations * (layers + 1), integral=False).reshape(n, n, locations, layers + 1, 1)
    for lower, upper in itertools.permutations(range(n), 2):
        for at in range(locations):
            _pair(milp, moving, columns, above[lower, upper], at, (lower, upper))


def _pair(
    milp: MilpBuilder, moving: Moving, columns: OrderColumns, above: Ints, at: int, pair: tuple[int, int]
) -> None:
    """Add the rows of a pair at a location; `above`: (locations, t+1, 1), `upper` rests above `lower` there."""
    lower, upper = pair
    rests, move, lifted = columns.rests, columns.move, columns.lifted
    here = above[at]
    comes = [(move[:, upper, :, at], 1.0), (lifted[:, upper, :, at], 1.0)]
    milp.add_sums([*comes, (rests[:-1, [lower], at], 1), (here[1:], -1)], upper=1)
    leaves = [(part[:, upper, at].reshape(len(move), -1), -1.0) for part in (move, columns.fall, lifted)]
    milp.add_sums([(here[:-1], 1), *leaves, (here[1:], -1)], upper=0)
    milp.add_sums([(move[:, lower, at], 1), (here[:-1], 1)], upper=1)
    for part in (columns.fall, lifted):
        taken = part[:, lower, at].reshape(len(move), -1)
        with_it = part[:, upper, at].reshape(len(move), -1)
        milp.add_sums([(taken, 1), (here[:-1], 1), (with_it, -1)], upper=1)
    _keep_in_lift(milp, moving, columns, above, at, pair)


def _keep_in_lift(
    milp: MilpBuilder, moving: Moving, columns: OrderColumns, above: Ints, at: int, pair: tuple[int, int]
) -> None:
    """A lift from a location keeps the order of a pair, where it rests next and where it is home."""
    lower, upper = pair
    lifted, locations = columns.lifted, len(moving.places.locations)
    pile = moving.piles[at]
    waiting = lower in pile and upper in pile and pile.index(lower) < pile.index(upper)
    chains = [chain for _, chain in moving.blocks.chains]
    chained = any(lower in chain and upper in chain and chain.index(lower) > chain.index(upper) for chain in chains)
    for target in range(locations):
        both = _both(lifted[:, :, at, target], pair)
        if both is not None:
            milp.add_sums([(both, 1), (above[at, :-1], 1), (above[target, 1:], -1)], upper=2)
        both = _both(lifted[:, :, locations, target], pair)
        if waiting and both is not None:
            milp.add_sums([(both, 1), (above[target, 1:], -1)], upper=1)
    both = _both(lifted[:, :, at, locations], pair)
    if chained and both is not None:
        milp.add_sums([(both, 1), (above[at, :-1], 1)], upper=2)


def _both(columns: Ints, pair: tuple[int, int]) -> Ints | None:
    """Return the columns (t, 2) of a pair, of (t, b), or None where one of them has none."""
    both = columns[:, pair]
    return both if (both >= 0).all() else None
