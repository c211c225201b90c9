"""The moving blocks by number: the leaving ones pile by pile, then those on the table, then those on a carrier."""

from smash.planners.layered.blocks import MovingBlocks
from smash.problem import Carrier, OnGoal, PositionsGoal
from tests.planners.layered.made import NO_TOPPLE, problem


def test_kept_blocks_have_no_number():
    blocks = MovingBlocks.of(problem({"s": "abc", "t": "d"}, {"s": "ac", "t": "db"}))
    assert blocks.names == ("b", "c")
    assert blocks.piles == (("s", (0, 1)),)
    assert blocks.chains == (("s", (1,)), ("t", (0,)))
    assert blocks.placed == {0, 1}
    assert blocks.located


def test_blocks_without_a_place_leave_and_have_no_chain():
    blocks = MovingBlocks.of(problem({"s": "ab"}, PositionsGoal({"a": ("t", 1)})))
    assert (blocks.names, blocks.placed, blocks.chains) == (("a", "b"), {0}, (("t", (0,)),))


def test_blocks_of_the_table_and_of_carriers_come_last():
    tray = Carrier("tray", ("p",), "p", 1, ("z",))
    blocks = MovingBlocks.of(problem({"s": "a"}, {"t": "amz"}, table=("m",), carriers=(tray,)))
    assert blocks.names == ("a", "m", "z")
    assert (blocks.lying, blocks.held) == ({1}, {2: 0})


def test_a_block_of_the_table_without_a_place_stays_there():
    assert MovingBlocks.of(problem({"s": "a"}, PositionsGoal({"a": ("t", 1)}), table=("m",))).names == ("a",)


def test_towers_of_an_on_goal_float_where_no_part_of_them_stands():
    blocks = MovingBlocks.of(problem({"s": "abc"}, OnGoal({"a": "c"}, ("c",))))
    assert not blocks.located
    assert [[blocks.names[block] for block in chain] for _, chain in blocks.chains] == [["c", "a"]]


def test_buffers_are_not_toppled_and_nothing_is_without_topple():
    start, goal = {"s": "ab"}, {"s": "ba"}
    assert MovingBlocks.of(problem(start, goal, buffers="u")).toppled == {"s", "t"}
    assert MovingBlocks.of(problem(start, goal, buffers="u", options=NO_TOPPLE)).toppled == frozenset()
