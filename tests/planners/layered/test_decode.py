"""A solution of the relaxation becomes a plan: what it leaves open is chosen, what no pile allows is refused."""

import numpy as np
import pytest

from smash.planners.layered.network.decode import read_relaxed
from smash.planners.layered.network.moving import Moving
from smash.planners.layered.network.relaxed import build_relaxed
from smash.problem import Carrier, Carry, IllegalAction, Lift, OnGoal, Pick, Place, PositionsGoal, Topple
from smash.problem.model import TABLE
from tests.planners.layered.made import NO_TOPPLE, priced, problem


class Chosen:
    """A relaxation and a solution written by hand."""

    def __init__(self, made, horizon=2):
        self.made, self.moving = made, Moving.of(made)
        self.model = build_relaxed(made, self.moving, horizon)
        self.vector = np.zeros(self.model.milp.columns)

    def take(self, columns, *place):
        assert columns[place] >= 0
        self.vector[columns[place]] = 1

    def plan(self):
        return read_relaxed(self.made, self.model, self.vector)


def test_a_topple_falls_from_the_lowest_that_it_takes():
    chosen = Chosen(priced({"s": "abc"}, PositionsGoal({"a": ("t", 1)})))
    chosen.take(chosen.model.topple, 0, 0, 0)
    for block in (1, 2):
        chosen.take(chosen.model.fall, 0, block, 2)
    chosen.take(chosen.model.move, 1, 0, chosen.moving.start, chosen.moving.home)
    assert chosen.plan() == (Topple("s", 2), Pick("a", "s"), Place("a", "t"))


def test_a_lift_takes_the_lowest_that_it_holds_and_a_carry_comes_last():
    tray = Carrier("tray", ("p", "q"), "p", 1)
    chosen = Chosen(problem({"s": "abc"}, PositionsGoal({"b": ("t", 1)}), capacities={"lift": 2}, carriers=(tray,)))
    chosen.take(chosen.model.lift, 0, 0, 0, 1)
    chosen.take(chosen.model.lifted, 0, 0, 2, 2)
    chosen.take(chosen.model.lifted, 0, 1, 2, 1)
    chosen.take(chosen.model.carry, 0, 0, 1)
    assert chosen.plan() == (Lift("s", 2, "t"), Carry("tray", "q"))


def test_a_block_of_an_on_goal_goes_onto_the_one_under_it():
    chosen = Chosen(priced({"s": "ab", "u": "c"}, OnGoal({"b": "c"}), "s t u", options=NO_TOPPLE))
    block = chosen.moving.blocks.names.index("b")
    chosen.take(chosen.model.move, 0, block, chosen.moving.start, chosen.moving.home)
    assert chosen.plan() == (Pick("b", "s"), Place("b", "u"))


def test_a_block_of_the_table_is_picked_from_there():
    chosen = Chosen(priced({}, {"s": "a"}, table=("a",)))
    chosen.take(chosen.model.move, 0, 0, chosen.moving.places.table, chosen.moving.home)
    assert chosen.plan() == (Pick("a", TABLE), Place("a", "s"))


def test_an_order_that_no_pile_allows_is_refused():
    chosen = Chosen(priced({"s": "ab"}, {"t": "ab"}, options=NO_TOPPLE))
    chosen.take(chosen.model.move, 0, 0, chosen.moving.start, chosen.moving.home)
    with pytest.raises(IllegalAction):
        chosen.plan()
