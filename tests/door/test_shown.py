"""Notebook manners: hashes, copies, states as piles, pictures that need no library and raise nothing."""

import copy
import pickle
from dataclasses import replace
from xml.etree import ElementTree

from hypothesis import given

import smash
from smash.problem import Carrier, Carry, Lift, Pick, Place, StacksGoal, Topple
from tests.strategies import instances

INSTANCE = smash.make_instance({"s1": ["a", "b"], "s2": ["c"]}, {"s2": ["c", "a", "b"]}, buffers=2)


def words(svg):
    return [element.text for element in ElementTree.fromstring(svg).iter() if element.tag.endswith("text")]


def test_an_instance_is_kept_in_a_set_copied_and_pickled():
    for again in (
        copy.copy(INSTANCE),
        copy.deepcopy(INSTANCE),
        pickle.loads(pickle.dumps(INSTANCE)),
        replace(INSTANCE),
    ):
        assert again == INSTANCE
        assert again in {INSTANCE}
    assert replace(INSTANCE, goal=StacksGoal({"s1": ("c", "a", "b")})) not in {INSTANCE}


def test_an_instance_and_a_plan_say_what_they_are_in_a_line():
    assert repr(INSTANCE) == "<Instance 'instance': 3 blocks on 2 stacks and 2 buffers, StacksGoal>"
    assert repr(smash.plan(INSTANCE)) == "<Plan for 'instance' by smash: optimal, cost 5, lower bound 5>"
    assert repr(smash.plan(INSTANCE, topple=False)) == "<Plan for 'instance' by smash: optimal, cost 6, lower bound 6>"


def test_a_state_prints_as_piles():
    state = smash.State.start_of(INSTANCE)
    assert str(state) == "s1: a b\ns2: c\nempty: u1 u2\nhand: empty"
    state.piles["s1"].pop()
    state.hand, state.table = "b", {"x y", "d"}
    assert str(state) == "s1: a\ns2: c\nempty: u1 u2\ntable region: d 'x y'\nhand: b"


def test_a_state_prints_its_carriers():
    tray = Carrier("tray", ("left", "right"), "left", 2, ("b",))
    instance = smash.make_instance({"s1": ["a"]}, {"s1": ["a", "b"]}, carriers=[tray])
    assert str(smash.State.start_of(instance)) == "s1: a\ntray at left: b\nhand: empty"


def test_the_picture_of_an_instance_shows_start_and_goal():
    shown = words(INSTANCE._repr_svg_())
    assert shown[:3] == ["start (2 empty buffers beside)", "s1", "a"]
    assert shown[shown.index("goal") :] == ["goal", "s1", "s2", "c", "a", "b"]


@given(instance=instances(max_blocks=6))
def test_every_instance_has_a_picture(instance):
    assert len(words(instance._repr_svg_())) >= 2


def test_an_instance_without_a_goal_has_no_picture_and_raises_nothing():
    assert replace(INSTANCE, goal="none")._repr_svg_() is None


def test_the_picture_of_a_plan_numbers_its_steps_as_the_law_does():
    actions = (
        Topple("s1", 2),
        Pick("b", "table"),
        Place("b", "s2"),
        Lift("s1", 1, "s2"),
        Carry("tray", "left"),
        Pick("a", "s1"),
    )
    plan = replace(smash.plan(INSTANCE), actions=actions, stated_cost=None)
    assert words(plan._repr_svg_())[1:] == [
        "1 · topple s1 from height 2",
        "2–3 · b: table → s2",
        "4 · lift s1 from height 1 to s2",
        "5 · carry tray to left",
        "6 · pick a from s1",
    ]


def test_a_plan_without_actions_shows_its_status():
    plan = replace(smash.plan(INSTANCE), actions=None, status="unknown", lower_bound=None)
    assert words(plan._repr_svg_()) == ["Plan for 'instance' by smash: unknown, no plan"]
