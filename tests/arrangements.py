"""Larger instances than hypothesis draws, from a seed."""

import random

from smash.problem import StacksGoal, make_instance
from smash.problem.sets.generators import block_names


def wide(blocks, stacks, seed, buffers=0):
    """Draw start and goal uniformly over `stacks` stacks."""
    draw = random.Random(seed)
    names, places = list(block_names(blocks)), [f"s{number}" for number in range(stacks)]

    def arrangement():
        draw.shuffle(names)
        piles = {place: [] for place in places}
        for name in names:
            piles[draw.choice(places)].append(name)
        return {place: tuple(pile) for place, pile in piles.items()}

    return make_instance(
        name=f"wide-{blocks}-{stacks}-{seed}",
        blocks=sorted(names),
        stacks=places,
        buffers=[f"u{number}" for number in range(buffers)],
        start=arrangement(),
        goal=StacksGoal(arrangement()),
    )
