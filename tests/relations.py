"""Random `on` goals with `ontable` and `clear`, some of which contradict themselves; starts with a full hand."""

import itertools
import random

from smash.problem import OnGoal, PlanOptions, make_instance
from smash.problem.problem import Problem


def related(seed, *, most_blocks=4, hand=0.25, contradictory=0.15, stacks=3, topple=None):
    """Draw a small problem.

    Args:
        seed: the same seed draws the same problem.
        most_blocks: in it.
        hand: share of the problems that start with a block in the hand.
        contradictory: share of the goals that are drawn without a look at what they say together.
        stacks: most stacks; there are up to two buffers beside them.
        topple: whether topple is allowed; None: in six of ten.
    """
    draw = random.Random(seed)
    names = [f"b{number}" for number in range(1, draw.randint(1, most_blocks) + 1)]
    places = [f"s{number}" for number in range(1, draw.randint(1, stacks) + 1)]
    buffers = [f"u{number}" for number in range(1, draw.randint(0, 2 if len(places) < 3 else 1) + 1)]
    order = draw.sample(names, len(names))
    held = order.pop() if draw.random() < hand else None
    piles = {place: [] for place in places + buffers}
    piles["table"] = []
    lying = draw.random() < 0.4
    for block in order:
        piles[draw.choice([*places, *buffers, *(["table"] if lying else [])])].append(block)
    table = piles.pop("table")
    goal = _contradictory(draw, names) if draw.random() < contradictory else _consistent(draw, names)
    instance = make_instance(
        piles, goal, name=f"related-{seed}", blocks=names, stacks=places, buffers=buffers, table=table, hand=held
    )
    return Problem(
        instance, PlanOptions(draw.random() < 0.6 if topple is None else topple, draw.choice([None, None, 1, 2]))
    )


def _contradictory(draw, names):
    on = {block: draw.choice(names) for block in names if draw.random() < 0.35}
    some = [[block for block in names if draw.random() < 0.25] for _ in range(3)]
    return OnGoal(on, *map(tuple, some))


def _consistent(draw, names):
    towers = [[] for _ in range(draw.randint(1, len(names)))]
    for block in draw.sample(names, len(names)):
        draw.choice(towers).append(block)
    on, bottom, ontable, clear = {}, [], [], []
    for tower in filter(None, towers):
        on |= {upper: under for under, upper in itertools.pairwise(tower) if draw.random() < 0.6}
        bottom += [tower[0]] * (draw.random() < 0.3)
    loaded = set(on.values())
    ontable = [block for block in names if block not in on and draw.random() < 0.5]
    clear = [block for block in names if block not in loaded and draw.random() < 0.4]
    return OnGoal(on, tuple(bottom), tuple(ontable), tuple(clear))
