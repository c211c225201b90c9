"""Hypothesis strategies: small instances of every goal kind, with blocks on the table and on buffers, odd names."""

import itertools

from hypothesis import strategies as st

from smash.problem import TABLE, Carrier, Costs, Instance, OnGoal, PlanOptions, PositionsGoal, StacksGoal, make_instance

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
    return OnGoal(on, tuple(base for base in bases if draw(st.booleans())))


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
) -> Instance:
    """Draw a small instance."""
    count = draw(st.integers(min_blocks, max_blocks))
    blocks = ODD_NAMES[:count] if odd_names else [f"b{number}" for number in range(1, count + 1)]
    stacks = [f"s{number}" for number in range(1, draw(st.integers(1, max_stacks)) + 1)]
    buffers = [f"u{number}" for number in range(1, draw(st.integers(0, max_buffers)) + 1)]
    places = [*stacks, *buffers] if buffer_start else stacks
    start, table = draw(arrangements(blocks, places, leave_out=table_start))
    return make_instance(
        name="drawn",
        blocks=blocks,
        stacks=stacks,
        buffers=buffers,
        start=start,
        table=table,
        goal=draw(goals(blocks, stacks, kinds)),
    )


@st.composite
def family_instances(draw, max_blocks=3, max_stacks=3, max_buffers=1, kinds=("stacks", "positions", "on")) -> Instance:
    """Draw a small instance with, perhaps, a carrier, lifts and costs."""
    plain = draw(instances(max_blocks=max_blocks, max_stacks=max_stacks, max_buffers=max_buffers, kinds=kinds))
    carriers, held = [], ()
    if draw(st.booleans()):
        held = plain.table[: draw(st.integers(0, 1))]
        stations = ("left", "right", "far")[: draw(st.integers(1, 3))]
        carriers = [Carrier("tray", stations, draw(st.sampled_from(stations)), draw(st.integers(1, 2)), held)]
    places = [*plain.locations, TABLE, *(station for carrier in carriers for station in carrier.stations)]
    positions = {place: (draw(st.integers(0, 9)) / 10, draw(st.integers(0, 9)) / 10) for place in places}
    prices = {name: draw(st.integers(1, 6)) for name in ("pick", "place", "topple", "carry", "lift")}
    costs = draw(
        st.sampled_from([Costs(), Costs(prices), Costs(prices, draw(st.sampled_from([5.0, 20.0])), positions)])
    )
    return make_instance(
        name="family",
        blocks=plain.blocks,
        stacks=plain.stacks,
        buffers=plain.buffers,
        start=plain.start,
        table=[block for block in plain.table if block not in held],
        goal=plain.goal,
        carriers=carriers,
        capacities={"lift": draw(st.integers(1, 3))} if draw(st.booleans()) else {},
        costs=costs,
    )


def family_options() -> st.SearchStrategy[PlanOptions]:
    """Draw plan options that leave out some of the family."""
    return st.sampled_from(
        [
            PlanOptions(),
            PlanOptions(topple=False),
            PlanOptions(True, 1),
            PlanOptions(without=("carry",)),
            PlanOptions(topple=False, without=("lift",)),
        ]
    )


def plan_options() -> st.SearchStrategy[PlanOptions]:
    """Draw plan options: topple or not, capped or not."""
    return st.sampled_from([PlanOptions(), PlanOptions(topple=False), PlanOptions(True, 1), PlanOptions(True, 2)])
