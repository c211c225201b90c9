"""The blocks that move, by number, and the piles that they leave and the chains that they fill."""

from __future__ import annotations

from dataclasses import dataclass

from smash.problem.problem import Problem
from smash.problem.views.demands import Demands


@dataclass(frozen=True, slots=True)
class MovingBlocks:
    """The moving blocks and the chains that they leave and fill, by number.

    Attributes:
        demands: what the goal asks of the start.
        names: moving blocks: the leaving ones, those that lie on the table and have a place, those on a carrier.
        piles: per location with a leaving block: its name and the numbers of those blocks, bottom first.
        chains: per goal chain: its location (None: any free one) and the numbers of its blocks, bottom first.
        lying: numbers of the blocks that lie on the table at the start.
        held: numbers of the blocks that are on a carrier at the start, with that carrier's number.
        placed: numbers of the blocks with a goal place.
        toppled: locations beside which there is a topple region.
    """

    demands: Demands
    names: tuple[str, ...]
    piles: tuple[tuple[str, tuple[int, ...]], ...]
    chains: tuple[tuple[str | None, tuple[int, ...]], ...]
    lying: frozenset[int]
    held: dict[int, int]
    placed: frozenset[int]
    toppled: frozenset[str]

    @classmethod
    def of(cls, problem: Problem) -> MovingBlocks:
        """Number the moving blocks of a problem."""
        instance, demands = problem.instance, problem.demands
        lying = [block for block in instance.table if block in demands.placed]
        held = {block: number for number, carrier in enumerate(instance.carriers) for block in carrier.holds}
        names = (*(block for pile in demands.leaving.values() for block in pile), *lying, *held)
        number = {block: index for index, block in enumerate(names)}

        def numbers(pile: tuple[str, ...]) -> tuple[int, ...]:
            return tuple(number[block] for block in pile)

        chains: list[tuple[str | None, tuple[int, ...]]] = [(at, numbers(pile)) for at, pile in demands.build.items()]
        chains += [(None, numbers(chain.blocks)) for chain in demands.floating]
        return cls(
            demands=demands,
            names=names,
            piles=tuple((at, numbers(pile)) for at, pile in demands.leaving.items() if pile),
            chains=tuple(chains),
            lying=frozenset(number[block] for block in lying),
            held={number[block]: carrier for block, carrier in held.items()},
            placed=frozenset(number[block] for block in demands.placed),
            toppled=frozenset(instance.stacks) if problem.options.topple else frozenset(),
        )

    def __len__(self) -> int:
        return len(self.names)

    @property
    def located(self) -> bool:
        """Whether the goal says at which location each chain is to be built."""
        return all(location is not None for location, _ in self.chains)
