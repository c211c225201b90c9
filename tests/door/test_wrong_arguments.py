"""Whatever a user can get wrong at the door is one line of a `SmashError`."""

import pytest

import smash

INSTANCE = smash.make_instance(start={"s1": ["a", "b"]}, goal={"s1": ["b", "a"]}, buffers=1)
OTHER = smash.make_instance(start={"s1": ["a", "b"]}, goal={"s1": ["b", "a"]}, buffers=1, name="other")


@pytest.mark.parametrize(
    "call",
    [
        lambda: smash.plan(INSTANCE, 3),
        lambda: smash.plan(INSTANCE, None),
        lambda: smash.plan(INSTANCE, ["smash"]),
        lambda: smash.plan(INSTANCE, topple="no"),
        lambda: smash.plan(INSTANCE, budget="3"),
        lambda: smash.plan(INSTANCE, budget=True),
        lambda: smash.plan(INSTANCE, isolated="yes"),
        lambda: smash.plan(INSTANCE, max_topple=1.5),
        lambda: smash.plan(INSTANCE, seed=-1),
        lambda: smash.read_instance(None),
        lambda: smash.read_plan(7),
        lambda: smash.suite(4),
        lambda: smash.generate("multi", "4"),
        lambda: smash.generate("multi", 4.5),
        lambda: smash.generate("multi", 4, seed="x"),
        lambda: smash.generate("multi", 4, seed=-1),
        lambda: smash.make_instance(start={"s1": ["a"]}, goal={"s2": ["a"]}, name=5),
        *(
            lambda given=given: smash.make_instance({"s1": ["a"]}, {"s2": ["a"]}, **given)
            for given in (
                {"table": 5},
                {"table": "a"},
                {"carriers": 5},
                {"carriers": ["a"]},
                {"capacities": [1]},
                {"costs": {"pick": 2}},
                {"buffers": True},
                {"stacks": False},
            )
        ),
        lambda: smash.compare([INSTANCE], [None]),
        lambda: smash.compare(3, ["greedy"]),
        lambda: smash.write_instance(3, "x.json"),
        lambda: smash.write_plan(None, "x.json"),
        *(
            lambda action=action: smash.check(INSTANCE, [action])
            for action in (
                smash.Topple("s1", "2"),
                smash.Topple("s1", 2.0),
                smash.Topple("s1", True),
                smash.Topple("s1", float("nan")),
                smash.Pick(None, "s1"),
                smash.Place("a", object()),
            )
        ),
        lambda: smash.draw(OTHER, smash.plan(INSTANCE, "greedy", budget=1)),
    ],
)
def test_a_wrong_argument_is_one_line(call):
    with pytest.raises(smash.SmashError) as caught:
        call()
    assert "\n" not in str(caught.value)


def test_one_variant_may_stand_alone():
    table = smash.compare([INSTANCE], "greedy", budget=1, variants="no-topple")
    assert table["variant"].tolist() == ["no-topple"]
