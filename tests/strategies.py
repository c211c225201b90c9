"""Hypothesis strategies: small instances of every goal kind, with blocks on the table and on buffers, odd names."""

import itertools

from hypothesis import strategies as st

from smash.problem import (
    TABLE,
    Carrier,
    Costs,
    Instance,
    OnGoal,
    PlanOptions,
    PositionsGoal,
    StacksGoal,
    make_instance,
)

EVERY_KIND = ("stacks", "positions", "on", "resting")
"""The kinds of goals; `resting` ones are `on` goals that say `ontable` and `clear` too."""
ODD_NAMES = ["b 1", "", "größe", "quote'\"", "s1", "-", "(x)", "42", "B1", "b1"]


@st.composite
def arrangements(draw, blocks, locations, leave_out=False):
    """Draw piles per location (and, with `leave_out`, blocks that lie in none)."""
    piles = {location: [] for location in locations}
    rest = []
    for block in draw(st.permutations(blocks)):
        places = [*locations, None] if leave_out else list(locations)
        place = draw(st.sampled_from(places))
        (rest if place is None else piles[place]).append(block)
    return piles, rest


@st.composite
def goals(draw, blocks, stacks, kinds=("stacks", "positions", "on")):
    """Draw a goal of one of the kinds."""
    kind = draw(st.sampled_from(kinds))
    if kind == "stacks":
        piles, _ = draw(arrangements(blocks, stacks))
        return StacksGoal({location: tuple(pile) for location, pile in piles.items()})
    piles, _ = draw(arrangements(blocks, stacks, leave_out=True))
    if kind == "positions":
        return PositionsGoal(
            {block: (at, height) for at, pile in piles.items() for height, block in enumerate(pile, start=1)}
        )
    on = {upper: under for pile in piles.values() for under, upper in itertools.pairwise(pile)}
    bases = [pile[0] for pile in piles.values() if pile]
    bottom = tuple(base for base in bases if draw(st.booleans()))
    if kind == "on":
        return OnGoal(on, bottom)
    loaded = frozenset(on.values())
    ontable = tuple(block for block in blocks if block not in on and draw(st.booleans()))
    return OnGoal(on, bottom, ontable, tuple(block for block in blocks if block not in loaded and draw(st.booleans())))


@st.composite
def instances(
    draw,
    max_blocks=4,
    min_blocks=0,
    max_stacks=3,
    max_buffers=2,
    kinds=("stacks", "positions", "on"),
    buffer_start=True,
    table_start=True,
    odd_names=False,
    hand=False,
) -> Instance:
    """Draw a small instance; with `hand` the hand may be full at the start."""
    count = draw(st.integers(min_blocks, max_blocks))
    blocks = ODD_NAMES[:count] if odd_names else [f"b{number}" for number in range(1, count + 1)]
    stacks = [f"s{number}" for number in range(1, draw(st.integers(1, max_stacks)) + 1)]
    buffers = [f"u{number}" for number in range(1, draw(st.integers(0, max_buffers)) + 1)]
    places = [*stacks, *buffers] if buffer_start else stacks
    held = draw(st.sampled_from([None, *blocks])) if hand else None
    others = [block for block in blocks if block != held]
    start, table = draw(arrangements(others, places, leave_out=table_start))
    return make_instance(
        name="drawn",
        blocks=blocks,
        stacks=stacks,
        buffers=buffers,
        start=start,
        table=table,
        goal=draw(goals(blocks, stacks, kinds)),
        hand=held,
    )


def plan_options() -> st.SearchStrategy[PlanOptions]:
    """Draw plan options: topple or not, capped or not."""
    return st.sampled_from([PlanOptions(), PlanOptions(topple=False), PlanOptions(True, 1), PlanOptions(True, 2)])


@st.composite
def family_instances(draw, max_capacity=3, max_carriers=2, max_blocks=3, max_buffers=1, **shape) -> Instance:
    """Draw a small instance with carriers (some loaded), lifts and costs, any of them left out at times."""
    plain = draw(instances(max_blocks=max_blocks, max_buffers=max_buffers, **shape))
    start = {location: list(pile) for location, pile in plain.start.items()}
    stations = [f"p{number}" for number in range(1, draw(st.integers(max_carriers, 3)) + 1)]
    carriers = []
    for number in range(draw(st.integers(0, max_carriers))):
        capacity = draw(st.integers(1, 2))
        full = [location for location, pile in start.items() if pile]
        holds = [start[draw(st.sampled_from(full))].pop()] if full and draw(st.booleans()) else []
        own = [stations[number], *(at for at in stations if at != stations[number] and draw(st.booleans()))]
        carriers.append(Carrier(f"tray {number}", tuple(own), stations[number], capacity, tuple(holds)))
    lift = draw(st.one_of(st.none(), st.integers(1, max_capacity)))
    used = [station for carrier in carriers for station in carrier.stations]
    return make_instance(
        name="drawn",
        blocks=plain.blocks,
        stacks=plain.stacks,
        buffers=plain.buffers,
        start=start,
        table=plain.table,
        goal=plain.goal,
        hand=plain.hand,
        carriers=carriers,
        capacities={} if lift is None else {"lift": lift},
        costs=draw(costs([*plain.locations, *used])),
    )


@st.composite
def costs(draw, places):
    """Draw a cost model: counts, a cost per kind, distances, or both."""
    kinds = ("pick", "place", "topple", "carry", "lift")
    actions = {kind: draw(st.integers(1, 6)) for kind in kinds} if draw(st.booleans()) else {}
    if draw(st.booleans()):
        return Costs(actions)
    point = st.tuples(*[st.integers(0, 4)] * 2)
    positions = {place: draw(point) for place in [*places, TABLE]}
    return Costs(actions, draw(st.sampled_from([1.0, 2.5])), positions)


def family_options() -> st.SearchStrategy[PlanOptions]:
    """Draw plan options that leave any of the aggregating actions out."""
    without = st.sets(st.sampled_from(["carry", "lift"])).map(lambda names: tuple(sorted(names)))
    return st.builds(PlanOptions, st.booleans(), st.sampled_from([None, None, 1, 2]), without=without)
