"""Hypothesis strategies: small instances with carriers, lifts and costs, on top of those of `tests.strategies`."""

from hypothesis import strategies as st

from smash.problem import TABLE, Carrier, Costs, Instance, PlanOptions, make_instance
from tests.strategies import instances

KINDS = ("pick", "place", "topple", "carry", "lift")


@st.composite
def carriers(draw, blocks) -> tuple[list[Carrier], set[str]]:
    """Draw up to two carriers with stations of their own, and the blocks that start on them."""
    drawn, held = [], set()
    for name in ["c", "größe (c)"][: draw(st.integers(0, 2))]:
        stations = [f"{name} {number}" for number in range(draw(st.integers(1, 3)))]
        capacity = draw(st.integers(1, 3))
        free = [block for block in blocks if block not in held]
        holds = [block for block in free if draw(st.booleans()) and draw(st.booleans())][:capacity]
        held.update(holds)
        drawn.append(Carrier(name, tuple(stations), draw(st.sampled_from(stations)), capacity, tuple(holds)))
    return drawn, held


@st.composite
def costs(draw, places) -> Costs:
    """Draw costs per kind and per metre; every second time every action costs 1."""
    if draw(st.booleans()):
        return Costs()
    actions = {kind: draw(st.integers(1, 9)) for kind in KINDS if draw(st.booleans())}
    if draw(st.booleans()):
        return Costs(actions)
    points = st.tuples(st.sampled_from([0.0, 0.5, 1.25]), st.sampled_from([0.0, 0.3]))
    return Costs(actions, draw(st.sampled_from([0.5, 7.0, 10])), {place: draw(points) for place in places}, "ms")


@st.composite
def family_instances(draw, **shape) -> Instance:
    """Draw a small instance of version 2: any mix of carriers, lifts and costs."""
    plain = draw(instances(**shape))
    moved, held = draw(carriers(plain.blocks))
    stations = [station for carrier in moved for station in carrier.stations]
    return make_instance(
        name=plain.name,
        blocks=plain.blocks,
        stacks=plain.stacks,
        buffers=plain.buffers,
        start={at: [block for block in pile if block not in held] for at, pile in plain.start.items()},
        table=[block for block in plain.table if block not in held],
        goal=plain.goal,
        carriers=moved,
        capacities={"lift": draw(st.integers(1, 3))} if draw(st.booleans()) else {},
        costs=draw(costs([*plain.locations, TABLE, *stations])),
    )


def family_options() -> st.SearchStrategy[PlanOptions]:
    """Draw plan options: with and without each of the actions."""
    return st.builds(
        PlanOptions,
        st.booleans(),
        st.sampled_from([None, None, 1, 2]),
        without=st.sampled_from([(), (), ("carry",), ("lift",), ("carry", "lift")]),
    )
