"""Small instances and plans for episodes, as in the paper's Fig. 1: the target lies under other blocks."""

from smash.problem import (
    Pick,
    Place,
    Plan,
    PlanOptions,
    PositionsGoal,
    StacksGoal,
    Topple,
    make_instance,
)


def buried_target():
    """Three blocks above the target, which is wanted on an empty stack."""
    return make_instance(
        name="buried",
        blocks="abcd",
        stacks=["s1", "s2", "s3", "g"],
        buffers=[f"u{number}" for number in range(12)],
        start={"s1": "abcd"},
        goal=PositionsGoal({"a": ("g", 1)}),
    )


def buried_plan():
    return plan_of("buried", Topple("s1", 2), Pick("a", "s1"), Place("a", "g"))


def swapped_pair():
    """Two blocks on each other, wanted the other way round: both must be picked from where they fell."""
    return make_instance(
        name="swapped",
        blocks=["a", "b"],
        stacks=["s1", "s2", "s3"],
        start={"s2": ["a", "b"]},
        goal=StacksGoal({"s2": ("b", "a")}),
    )


def swapped_plan():
    return plan_of(
        "swapped", Topple("s2", 1), Pick("b", "table"), Place("b", "s2"), Pick("a", "table"), Place("a", "s2")
    )


def plan_of(instance, *actions):
    return Plan(instance, "by hand", PlanOptions(), "feasible", actions)


def piles_of(**start):
    """Piles of one-letter blocks on three stacks, which may be lifted four at a time; nothing is wanted."""
    return make_instance(
        name="piles",
        blocks=[block for pile in start.values() for block in pile],
        stacks=["s1", "s2", "s3"],
        buffers=["u1"],
        start=start,
        goal=PositionsGoal({}),
        capacities={"lift": 4},
    )
