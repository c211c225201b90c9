"""Moves that no plan asks for: the order in which they are tried. The world is made up."""

from types import SimpleNamespace

import pytest

from smash.execution.errors import Slip
from smash.execution.readback import read_state
from smash.execution.recovery import Recovery
from smash.execution.scene.block_pose import standing
from smash.execution.scene.geometry import Geometry
from smash.execution.scene.scene_file import default_scene
from smash.motion.errors import NoMotion
from smash.problem import Law, Pick, Place, PlanOptions, PositionsGoal, Topple, make_instance

SCENE = default_scene()
SIDE = SCENE.side


class MadeUp:
    """A table on which picks and places work at once, but for the actions in `refused`."""

    def __init__(self, start, loose=None, refused=()):
        loose = loose or {}
        blocks = [block for pile in start.values() for block in pile] + list(loose)
        self.instance = make_instance(
            name="made up",
            blocks=blocks,
            stacks=["s1", "s2"],
            buffers=["u1", "u2"],
            start=start,
            table=list(loose),
            goal=PositionsGoal({}),
        )
        self.slots = SCENE.bind(self.instance)
        self.blocks = {block: standing(x, y, SIDE / 2, 0.0) for block, (x, y) in loose.items()}
        for location, pile in start.items():
            for level, block in enumerate(pile):
                self._stand(block, location, level)
        self.law = Law(self.instance, PlanOptions())
        self.hand, self.done, self.refused = None, [], list(refused)
        self.performer = SimpleNamespace(observe=self.observe, look=self.look, table=Geometry(self.slots), hand=None)
        self.recovery = Recovery(self.instance, self.performer, self.perform)

    def _stand(self, block, location, level):
        slot = self.slots[location]
        self.blocks[block] = standing(slot.x, slot.y, (level + 0.5) * SIDE, slot.angle)

    def look(self):
        return Geometry(self.slots, blocks=dict(self.blocks))

    def observe(self):
        return read_state(self.look(), SCENE, self.performer.hand)

    def perform(self, action):
        self.done.append(action)
        if action in self.refused:
            raise NoMotion("made up")
        state = self.observe()
        assert self.law.refusal(state, action) is None
        if isinstance(action, Pick):
            self.performer.hand = action.block
        else:
            self._stand(action.block, action.target, len(state.piles[action.target]))
            self.performer.hand = None


def beside(location, distance, height=0.0):
    slot = SCENE.stacks[{"s1": 0, "s2": 1}[location]]
    return slot.x + distance, slot.y + height


def test_a_held_block_goes_on_an_empty_buffer_first_then_an_empty_stack_then_any_pile():
    world = MadeUp({"s1": ["a", "b"], "u1": ["c"]}, refused=[Place("b", "u2"), Place("b", "s2")])
    world.perform(Pick("b", "s1"))
    world.done.clear()
    assert world.recovery.put_down()
    assert world.done == [Place("b", "u2"), Place("b", "s2"), Place("b", "u1")]


def test_a_block_that_can_be_put_nowhere_stays_in_the_hand():
    world = MadeUp({"s1": ["a"]}, refused=[Place("a", name) for name in ("u1", "u2", "s1", "s2")])
    world.perform(Pick("a", "s1"))
    assert not world.recovery.put_down()
    assert world.performer.hand == "a"


def test_a_block_lost_on_the_way_is_out_of_the_hand():
    world = MadeUp({"s1": ["a"]})
    world.perform(Pick("a", "s1"))

    def slip(action):
        world.performer.hand = None
        raise Slip("made up")

    world.recovery._perform = slip
    assert world.recovery.put_down()


@pytest.mark.parametrize("action", [Place("a", "s2"), Topple("s2", 1)])
def test_the_nearest_loose_block_is_set_aside_and_none_that_lies_far_off(action):
    loose = {"near": beside("s2", 0.06), "nearer": beside("s2", -0.05), "far": beside("s2", 0.4)}
    world = MadeUp({"s1": ["a"]}, loose)
    world.recovery.clear(action)
    assert world.done == [Pick("nearer", "table"), Place("nearer", "u1")]


def test_where_the_nearest_cannot_be_picked_the_next_one_is():
    loose = {"near": beside("s2", 0.06), "nearer": beside("s2", -0.05)}
    world = MadeUp({"s1": ["a"]}, loose, refused=[Pick("nearer", "table")])
    world.recovery.clear(Place("a", "s2"))
    assert world.done == [Pick("nearer", "table"), Pick("near", "table"), Place("near", "u1")]


def test_the_pile_beside_a_loose_block_is_taken_down_until_the_block_can_be_picked():
    world = MadeUp({"s2": ["a", "b", "c"]}, {"x": beside("s2", 0.06)}, refused=[Pick("x", "table")])
    perform = world.perform

    def relent(action):
        if action == Place("b", "u2"):
            world.refused.clear()
        perform(action)

    world.recovery._perform = relent
    world.recovery.clear(Pick("x", "table"))
    picked = [action.block for action in world.done if isinstance(action, Pick)]
    assert picked == ["c", "x", "b", "x"]
    assert world.observe().piles["s2"] == ["a"]
