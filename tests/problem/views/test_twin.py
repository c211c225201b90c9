"""The plain twin: its plans are plans of the original, with blocks of carriers picked from their carrier."""

from hypothesis import assume, given, settings

from smash.problem import TABLE, Carrier, Costs, Law, Pick, Place, PositionsGoal, make_instance
from smash.problem.views.twin import from_twin, plain_twin
from tests.cheapest import cheapest_plan
from tests.strategies import family_instances


def loaded():
    return make_instance(
        name="x",
        blocks="ab",
        stacks=["s1", "s2"],
        start={"s1": "a"},
        goal=PositionsGoal({"b": ("s2", 1)}),
        carriers=[Carrier("scoop", ("p",), "p", 1, ("b",))],
        costs=Costs({"pick": 3}),
    )


def test_the_twin_counts_actions_and_knows_no_carrier():
    twin = plain_twin(loaded())
    assert (twin.table, twin.carriers, twin.costs.plain) == (("b",), (), True)


def test_a_block_of_a_carrier_is_picked_from_it_once_and_then_from_where_it_lies():
    plan = [Pick("b", TABLE), Place("b", "s1"), Pick("b", TABLE)]
    assert list(from_twin(loaded(), plan)) == [Pick("b", "scoop"), Place("b", "s1"), Pick("b", TABLE)]


@settings(max_examples=50, deadline=None)
@given(family_instances(max_blocks=3))
def test_a_plan_of_the_twin_is_a_plan_of_the_original(instance):
    best = cheapest_plan(plain_twin(instance))
    assume(best is not None)
    assert Law(instance).check(list(from_twin(instance, best[1]))).accepted
