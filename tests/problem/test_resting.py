"""`ontable` and `clear` goals, goals that contradict themselves, a block in the hand at the start: law and files."""

import pytest

from smash.problem import IllegalAction, OnGoal, Pick, Place, PlanOptions, State, Topple, make_instance
from smash.problem.errors import MalformedFile
from smash.problem.files.instances import instance_document, instance_from_document, read_instance, write_instance
from smash.problem.hand import after_place, distinct_locations
from smash.problem.model import shown_goal
from smash.problem.problem import Problem
from smash.problem.rules import Law
from tests.oracle import optimal_cost
from tests.relations import related

NO_TOPPLE = PlanOptions(topple=False)


def tower(*blocks, goal, **more):
    return make_instance({"s1": blocks}, goal, **({"stacks": 3} | more))


def test_one_topple_leaves_all_blocks_on_the_table():
    instance = tower("p", "q", "r", "s", goal=OnGoal({}, ontable=("p", "q", "r", "s")))
    assert Law(instance).check([Topple("s1", 1)]).accepted
    assert Law(instance).check([Topple("s1", 2)]).accepted
    verdict = Law(instance).check([Topple("s1", 3)])
    assert (
        verdict.reason == "goal not reached: block 'q' is neither at the bottom of a location nor in the table region"
    )


def test_a_clear_block_carries_nothing_at_the_end():
    instance = tower("p", "q", "r", goal=OnGoal({}, clear=("q",)))
    assert Law(instance).check([Topple("s1", 3)]).accepted
    assert Law(instance).check([Topple("s1", 2)]).accepted
    assert Law(instance).check([]).reason == "goal not reached: block 'q' is not clear, 'r' lies on it"


def test_a_held_block_is_placed_first():
    instance = make_instance({"s1": ["q"]}, OnGoal({"p": "q"}), hand="p", stacks=2)
    law = Law(instance)
    assert State.start_of(instance).hand == "p"
    assert law.check([Place("p", "s1")]).cost == 1
    assert law.check([Pick("q", "s1")]).reason == "pick 'q' from 's1': the hand holds 'p'"
    with pytest.raises(IllegalAction):
        list(law.states([Topple("s1", 1)]))


@pytest.mark.parametrize(
    ("goal", "words"),
    [
        (OnGoal({"a": "b", "b": "a"}), "'a' to stand on itself"),
        (OnGoal({"a": "a"}), "'a' to stand on itself"),
        (OnGoal({"a": "c", "b": "c"}), "both 'a' and 'b' directly on 'c'"),
        (OnGoal({"a": "b"}, bottom=("a",)), "'a' at the bottom of a location and on 'b'"),
        (OnGoal({"a": "b"}, ontable=("a",)), "'a' on the table and on 'b'"),
        (OnGoal({"a": "b"}, clear=("b",)), "'b' clear and 'a' on it"),
    ],
)
def test_a_goal_that_contradicts_itself_is_infeasible_not_malformed(goal, words):
    instance = make_instance({"s1": ["a", "b", "c"]}, goal, stacks=3)
    assert instance_from_document(instance_document(instance)) == instance
    for options in (PlanOptions(), NO_TOPPLE):
        assert words in Problem(instance, options).infeasible


@pytest.mark.parametrize("part", range(6))
def test_what_has_a_plan_is_decided_as_exhaustive_search_does(part):
    for seed in range(100 * part, 100 * part + 100):
        problem = related(seed)
        assert (problem.infeasible is None) == (optimal_cost(problem.instance, problem.options) is not None), seed


@pytest.mark.slow
@pytest.mark.parametrize("part", range(20))
def test_what_has_a_plan_is_decided_as_exhaustive_search_does_in_thousands_of_cases(part):
    for seed in range(1000 * part + 10_000, 1000 * part + 11_000):
        problem = related(seed, most_blocks=5)
        assert (problem.infeasible is None) == (optimal_cost(problem.instance, problem.options) is not None), seed


def test_clear_tops_need_piles_of_their_own():
    instance = make_instance({"s1": ["b", "a", "d", "c"]}, OnGoal({"a": "b", "c": "d"}, clear=("a", "c")))
    assert Problem(instance).infeasible == "the goal wants 2 piles with a clear top, there is 1 location"


def test_a_block_that_no_place_is_left_for_makes_it_infeasible_without_topple_alone():
    instance = make_instance(
        {"s1": ["a"], "s2": ["b"], "s3": ["d", "c"]}, OnGoal({}, ("a", "b", "c"), clear=("a", "b", "c"))
    )
    assert Problem(instance).infeasible is None
    assert "more blocks need a place" in Problem(instance, NO_TOPPLE).infeasible


def test_what_the_goal_says_of_the_table_comes_to_bottoms_where_nothing_falls():
    goal = OnGoal({"b": "a"}, ontable=("a", "c", "d"), clear=("b", "c"))
    instance = make_instance({"s1": ["c", "b", "a"]}, goal, table=["d"], stacks=4)
    assert Problem(instance, NO_TOPPLE).posed.goal == OnGoal({"b": "a"}, ("a", "c"))
    assert Problem(instance).posed.goal == OnGoal({"b": "a"}, ("a",), ("c", "d"))


class TestFiles:
    def document(self, **more):
        instance = make_instance({"s1": ["a", "b"]}, OnGoal({}, (), ("a",), ("b",)), hand="c", stacks=2)
        return instance_document(instance) | more

    def test_version_2_holds_them(self, tmp_path):
        instance = instance_from_document(self.document())
        assert (instance.hand, instance.goal.ontable, instance.goal.clear) == ("c", ("a",), ("b",))
        write_instance(instance, tmp_path / "i.json")
        assert read_instance(tmp_path / "i.json") == instance
        assert self.document()["format"] == "smash-instance/2"

    def test_version_1_is_written_where_it_suffices(self):
        instance = make_instance({"s1": ["a"]}, OnGoal({}, ("a",)))
        assert instance_document(instance)["format"] == "smash-instance/1"

    @pytest.mark.parametrize(
        ("change", "words"),
        [
            ({"hand": "z"}, "`hand`: 'z' is not one of `blocks`"),
            ({"hand": 3}, "hand"),
            ({"hand": "a"}, "'a' stands twice"),
            ({"hand": None}, "'c' is nowhere"),
            ({"goal": {"kind": "on", "on": {}, "ontable": ["z"]}}, "`goal.ontable`: 'z' is not one of `blocks`"),
            ({"goal": {"kind": "on", "on": {}, "clear": ["a", "a"]}}, "`goal.clear`: 'a' stands twice"),
            ({"goal": {"kind": "stacks", "stacks": {}, "clear": []}}, "unknown key 'clear'"),
            ({"format": "smash-instance/1"}, "'ontable' needs 'smash-instance/2'"),
        ],
    )
    def test_what_is_malformed_is_said_in_one_line(self, change, words):
        with pytest.raises(MalformedFile) as caught:
            instance_from_document(self.document(**change))
        assert words in str(caught.value)
        assert "\n" not in str(caught.value)


def test_equal_locations_stand_for_each_other():
    instance = make_instance({"s1": ["a"]}, OnGoal({}, ("b",)), stacks=3, buffers=2, hand="b")
    assert list(distinct_locations(instance)) == ["s1", "s2", "u1"]
    assert after_place(instance, "s1").start["s1"] == ("a", "b")
    placed = make_instance({"s1": ["a"]}, {"s2": ["b", "a"]}, stacks=3, buffers=2, hand="b")
    assert list(distinct_locations(placed)) == ["s1", "s2", "s3", "u1"]


def test_pictures_show_the_hand_and_what_lies_on_the_table():
    goal = OnGoal({"p": "q", "x": "t"}, (), ("q", "r", "u"), ("p", "u"))
    instance = make_instance({"s1": ["p", "q", "r"], "s2": ["t"]}, goal, table=["u"], hand="x")
    piles, columns, remark = shown_goal(instance)
    assert piles == {"floor 0": ("q", "p"), "any 1": ("t", "x"), "table 2": ("r",), "table 3": ("u",)}
    assert columns == tuple(piles)
    assert remark == " (any location; table: a floor or the table region; clear: p u)"
    assert ">hand<" in instance._repr_svg_()
    assert "'x' in the hand" in repr(instance)
