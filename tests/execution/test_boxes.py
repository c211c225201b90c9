"""Blocks with a footprint and a height of their own: where they stand, how they are held, how they are read back."""

import dataclasses
from math import pi
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest

from smash.execution.actions.arm_motions import ArmMotions
from smash.execution.actions.grasps import CENTRED, GRASPS
from smash.execution.actions.lift import LiftMotion
from smash.execution.actions.pick_and_place import PickAndPlace
from smash.execution.actions.topple import BOX_CUT, cubes_high, fall_of, first_cut, pushes_needed
from smash.execution.executor import Executor
from smash.execution.grounding import Grounder
from smash.execution.layout.conditions import violations
from smash.execution.policy import OPEN
from smash.execution.readback import read_state
from smash.execution.scene.block_pose import BlockPose, standing
from smash.execution.scene.block_size import BlockSize, levels
from smash.execution.scene.geometry import Geometry
from smash.execution.scene.noise import Chance, Noise
from smash.execution.scene.piles import misfits, needs_of
from smash.execution.scene.scene_file import default_scene, read_scene, scene_from_document
from smash.execution.scene.start import starting_carriers, starting_poses
from smash.execution.scene.tabletop import Slot
from smash.execution.scene.tray import Tray
from smash.execution.sight import Sight
from smash.execution.trials.outcome_model import _random_actions, _random_problem, require_modelled
from smash.execution.trials.topple_map import pile_of
from smash.motion.move import Move
from smash.problem import (
    Carrier,
    Lift,
    MalformedFile,
    Pick,
    Place,
    PositionsGoal,
    StacksGoal,
    State,
    Topple,
    make_instance,
)
from smash.problem.errors import SmashError
from smash.problem.rules import Law
from tests.execution.episodes import piles_of, plan_of
from tests.robots import PANDA, READY

ROOT = Path(__file__).parents[2]
FLAT, TALL = BlockSize(0.05, 0.03, 0.1), BlockSize(0.04, 0.06, 0.1)
SCENE = dataclasses.replace(default_scene(), name="boxes", sizes={"a": FLAT, "b": TALL})
ON_ITS_SIDE = np.array([[0.0, 0.0, 1.0], [0.0, 1.0, 0.0], [-1.0, 0.0, 0.0]])
"""The height lies along the world's x axis."""


def laid_out(instance, scene=SCENE):
    slots = scene.bind(instance)
    return Geometry(slots, blocks=starting_poses(instance, slots, scene, np.random.default_rng(0)))


def scene_with(**parts):
    return scene_from_document({"format": "smash-scene/1", "name": "test", "base": "default", **parts}, "scene.toml")


def test_a_box_on_its_side_is_as_high_as_its_footprint_and_as_long_as_its_height():
    upright, lying = standing(0.4, 0.0, 0.03, 0.3), BlockPose(np.array([0.4, 0.0, 0.02]), ON_ITS_SIDE)
    assert TALL.upright(upright) == 0.06
    assert TALL.stands(upright)
    assert TALL.extents(upright) == (0.04, 0.04, 0.06)
    assert TALL.upright(lying) == 0.04
    assert not TALL.stands(lying)
    assert TALL.extents(lying) == (0.06, 0.04, 0.04)


@pytest.mark.parametrize("turn", [0.1, pi / 2 + 0.1, -pi / 2 + 0.1, pi + 0.1])
def test_the_extents_of_a_lying_box_are_told_along_its_yaw(turn):
    c, s = np.cos(turn), np.sin(turn)
    lying = BlockPose(np.zeros(3), np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]]) @ ON_ITS_SIDE)
    along = np.array([np.cos(lying.yaw), np.sin(lying.yaw), 0.0])
    length = 2 * np.abs(along @ lying.rotation) @ TALL.half
    assert TALL.extents(lying)[0] == pytest.approx(length)


def test_equal_blocks_are_as_many_levels_as_there_are():
    assert levels([0.045] * 7, 0.045) == 7
    assert levels([0.03, 0.06], 0.045) == pytest.approx(2.0)


def test_a_pile_of_unlike_boxes_stands_as_high_as_its_blocks_and_is_read_back():
    instance = piles_of(s1="abc")
    where = laid_out(instance)
    assert [where.blocks[b].position[2] for b in "abc"] == pytest.approx([0.015, 0.06, 0.09 + 0.0225])
    assert read_state(where, SCENE).piles["s1"] == list("abc")
    where.blocks["c"] = standing(*where.point("s1"), 2.5 * 0.045, 0.0)
    assert read_state(where, SCENE).piles["s1"] == list("abc")
    where.blocks["c"] = standing(*where.point("s1"), 0.13, 0.0)
    assert read_state(where, SCENE).piles["s1"] == ["a", "b"]


def test_a_box_that_stands_on_a_lying_one_is_read_back_too():
    where = laid_out(piles_of(s1="ba"))
    x, y = where.point("s1")
    where.blocks["b"] = BlockPose(np.array([x, y, 0.02]), ON_ITS_SIDE)
    where.blocks["a"] = standing(x, y, 0.055, 0.0)
    assert read_state(where, SCENE).piles["s1"] == ["b", "a"]
    assert Grounder(ArmMotions(SCENE)).stand("c", "s1", State({"s1": ["b"]}, set()), where).position[2] == (
        pytest.approx(0.04 + 0.0225)
    )


def test_a_lying_box_is_held_across_either_side_and_what_is_between_the_fingers_is_known():
    arm = ArmMotions(SCENE)
    lying = BlockPose(np.array([0.45, 0.1, 0.02]), ON_ITS_SIDE)
    _, grasp = PickAndPlace(arm).pick(READY, "b", lying, arm.scene({"b": lying}))
    assert grasp.extents in ((0.06, 0.04, 0.04), (0.04, 0.06, 0.04))
    assert np.allclose(sorted(2 * grasp.hand().attached.half_extents[0]), [0.04, 0.04, 0.06])
    assert grasp.hand().opening == grasp.width / 2


def test_what_would_meet_the_palm_is_not_held_by_a_leaning_hand():
    steep = GRASPS[-1]
    assert steep.of(FLAT.edges).clears(PANDA.hand.palm_depth)
    assert not steep.of((0.06, 0.06, 0.065)).clears(PANDA.hand.palm_depth)
    assert CENTRED.of((0.06, 0.06, 0.07)).clears(PANDA.hand.palm_depth)


def test_after_a_topple_what_is_done_with_a_box_is_a_gap_task_without_a_promise():
    """A cube's place keeps its promise: it is as high on any face."""
    instance = piles_of(s1="ac")
    actions = [Topple("s1", 1), Pick("c", "table"), Place("c", "s2"), Pick("a", "table"), Place("a", "s3")]
    actions += [Pick("a", "s3"), Place("a", "u1"), Pick("c", "s2"), Place("c", "u1")]
    tasks = Grounder(ArmMotions(SCENE)).ground(actions, Law(instance), laid_out(instance), READY)
    assert [task.segments is None for task in tasks] == [False] + 8 * [True]
    assert [task.approach is not None for task in tasks if isinstance(task.action, Place)] == [
        True,
        False,
        False,
        False,
    ]


def test_a_scene_of_cubes_with_sizes_keeps_its_promises():
    instance = piles_of(s1="cd")
    actions = [Topple("s1", 1), Pick("d", "table"), Place("d", "s2"), Pick("c", "table"), Place("c", "s3")]
    tasks = Grounder(ArmMotions(SCENE)).ground(actions, Law(instance), laid_out(instance), READY)
    assert [task.approach is not None for task in tasks if isinstance(task.action, Place)] == [True, True]


def test_without_a_topple_everything_is_planned_with_boxes_too():
    instance = piles_of(s1="ab")
    actions = [Pick("b", "s1"), Place("b", "s2"), Pick("a", "s1"), Place("a", "s2")]
    tasks = Grounder(ArmMotions(SCENE)).ground(actions, Law(instance), laid_out(instance), READY)
    assert all(task.segments for task in tasks)
    assert tasks[3].approach.line is not None


def test_a_push_comes_in_above_the_blocks_that_stay_and_before_the_widest_that_falls():
    arm, where = ArmMotions(SCENE), laid_out(piles_of(s1="abc"))
    fall = fall_of(arm, list("abc"), 2, where)
    assert fall.blocks == ("b", "c")
    assert fall.tip == pytest.approx(0.03 + 0.2 * 0.06)
    assert fall.height == pytest.approx(0.105)
    assert fall.manner == BOX_CUT
    assert fall.follow_through == pytest.approx(2.0 * (0.045 + 0.05) / 2 + (0.045 - 0.04) / 2)
    assert (fall.lowest, fall.widest, fall.rest, fall.longest) == pytest.approx((0.04, 0.045, 0.05, 0.06))


def test_pushes_are_counted_by_height_where_blocks_are_no_cubes():
    scene = dataclasses.replace(default_scene(), sizes={name: BlockSize(0.05, 0.07, 0.1) for name in "abcdef"})
    arm, where = ArmMotions(scene), laid_out(piles_of(s1="abcdef"), scene)
    tall = cubes_high(arm, "abcdef", where)
    assert sum(tall) == pytest.approx(0.42 / 0.045)
    assert first_cut(2, tall) == 5
    assert pushes_needed(2, tall) == 3
    assert pushes_needed(2, cubes_high(ArmMotions(default_scene()), "abcdef", where)) == 2


def test_a_lift_of_boxes_is_planned_and_foreseen():
    instance = piles_of(s1="cab", s2="d")
    where, state, arm = laid_out(instance), State.start_of(instance), ArmMotions(SCENE)
    action, motion = Lift("s1", 2, "s2"), LiftMotion()
    held = [part for part in motion.plan(arm, READY, action, state, where) if isinstance(part, Move)]
    assert any(move.hand.attached is not None and len(move.hand.attached.half_extents) == 2 for move in held)
    motion.foresee(arm, action, state, where)
    assert read_state(where, SCENE).piles["s2"] == ["d", "a", "b"]


def test_noise_in_size_changes_both_edges_alike_and_mass_follows_the_box():
    scene = dataclasses.replace(SCENE, noise=Noise(size=0.001))
    made = Chance(scene, piles_of(s1="abc"), 3).made
    for name, size in (("a", FLAT), ("b", TALL), ("c", scene.block)):
        assert made[name].footprint - size.footprint == pytest.approx(made[name].height - size.height)
        assert made[name].mass == size.mass


def test_sizes_are_read_by_name_with_defaults_and_density():
    scene = scene_with(
        block={"footprint": 0.05, "height": 0.04, "mass": 0.2},
        blocks={"a": {"height": 0.06}, "b": {"footprint": 0.04, "mass": 0.3}},
    )
    assert scene.size("z") == scene.block == BlockSize(0.05, 0.04, 0.2)
    assert scene.size("a") == BlockSize(0.05, 0.06, pytest.approx(0.3))
    assert scene.size("b") == BlockSize(0.04, 0.04, 0.3)


@pytest.mark.parametrize(
    ("parts", "words"),
    [
        ({"blocks": {"b1": {"footprint": 0.09}}}, "`blocks.b1.footprint`: 0.09 m is not allowed; 0.03 to 0.07"),
        ({"blocks": {"b1": {"height": 0.01}}}, "`blocks.b1.height`: 0.01 m is not allowed; 0.025 to 0.07"),
        ({"blocks": {"b1": {"height": float("nan")}}}, "`blocks.b1.height`: nan m is not allowed"),
        ({"blocks": {"b1": {"mass": 2.0}}}, "`blocks.b1.mass`: 2 is not allowed"),
        ({"blocks": {"b1": {"width": 0.05}}}, "width"),
        ({"block": {"footprint": 0.2}}, "`block.footprint`: 0.2 m"),
        ({"blocks": {"b1": {"footprint": 0.07}}}, "0.105 or more"),
    ],
)
def test_a_block_that_the_hand_cannot_hold_is_named_with_what_fits(parts, words):
    with pytest.raises(MalformedFile) as refusal:
        scene_with(**parts)
    assert words in str(refusal.value)
    assert "\n" not in str(refusal.value)


def test_sizes_are_part_of_the_fingerprint_and_a_scene_without_them_keeps_its_own():
    assert default_scene().fingerprint == "458188cd"
    taller = dataclasses.replace(SCENE, sizes={"a": FLAT, "b": BlockSize(0.04, 0.061, 0.1)})
    flat = dataclasses.replace(default_scene(), name="boxes", height=0.04)
    plain = dataclasses.replace(default_scene(), name="boxes")
    assert len({scene.fingerprint for scene in (plain, SCENE, taller, flat)}) == 4


def test_no_outcome_model_is_made_of_a_scene_of_boxes():
    with pytest.raises(SmashError, match="scene 'boxes' has boxes"):
        require_modelled(SCENE)


def test_no_outcome_model_is_made_where_the_robot_reaches_low_piles_alone(monkeypatch):
    monkeypatch.setattr(type(default_scene()), "highest", 3)
    with pytest.raises(SmashError, match="reaches no more than 3"):
        require_modelled(default_scene())


def test_what_is_rehearsed_for_a_model_topples_no_stack_without_a_strip():
    bare = [dataclasses.replace(slot, directions=()) for slot in default_scene().stacks[1:]]
    scene = dataclasses.replace(default_scene(), stacks=(default_scene().stacks[0], *bare))
    toppled = set()
    for seed in range(40):
        generator = np.random.default_rng(seed)
        problem = _random_problem(scene, generator)
        toppled |= {done.location for done in _random_actions(problem, scene, generator) if isinstance(done, Topple)}
    assert toppled == {"s1"}


def test_piles_of_a_map_are_drawn_from_the_boxes_of_the_scene():
    assert pile_of(default_scene(), 3, 5) == ["b1", "b2", "b3"]
    assert sorted(pile_of(SCENE, 2, 1)) == ["a", "b"]
    assert pile_of(SCENE, 4, 1)[2:] == ["b1", "b2"]


def test_a_pile_is_limited_by_its_height_as_the_boxes_may_lie():
    scene = dataclasses.replace(default_scene(), sizes={name: BlockSize(0.05, 0.07, 0.1) for name in "abcdefgh"})
    (problem,) = misfits(scene, piles_of(s1="abcdefgh"), needs_of(Law(piles_of(s1="abcdefgh")), ()))
    assert problem.startswith("the plan piles 8 blocks on 's1'; scene 'default' has room for 7 there")
    assert list(misfits(scene, piles_of(s1="abcdefg"), needs_of(Law(piles_of(s1="abcdefg")), ()))) == []


def test_the_conditions_hold_for_the_scene_of_boxes_and_not_for_wider_ones():
    scene = read_scene(ROOT / "examples" / "boxes-scene.toml")
    assert violations(scene, height=3, buffer_height=2) == []
    tall = dataclasses.replace(scene, sizes={name: BlockSize(0.06, 0.065, 0.1) for name in "abcdefghi"})
    assert {problem.condition for problem in violations(tall, height=3, buffer_height=2)} == {"monotone transformation"}


def test_boxes_stand_in_the_cells_of_a_tray_at_their_own_heights():
    scene = dataclasses.replace(SCENE, tray=Tray(SCENE.longest), stations=(Slot(0.45, 1.8),))
    instance = make_instance(
        name="tray",
        blocks=["a", "b"],
        stacks=["s1"],
        start={},
        goal=PositionsGoal({}),
        carriers=[Carrier("tray", ("left",), "left", 2, ("a", "b"))],
    )
    slots, stations = scene.bind(instance), scene.bind_stations(instance)
    carriers = starting_carriers(instance, stations, scene)
    where = Geometry(
        slots, stations, starting_poses(instance, slots, scene, np.random.default_rng(0), carriers), carriers
    )
    assert [where.blocks[block].position[2] for block in "ab"] == pytest.approx([0.01 + 0.015, 0.01 + 0.03])
    assert read_state(where, scene).carried == {"tray": {"a", "b"}}


def test_what_stands_upright_is_seen_as_high_as_what_is_below_it():
    scene = dataclasses.replace(SCENE, noise=Noise(pose=0.002))
    where = laid_out(piles_of(s1="abc"), scene)
    world = SimpleNamespace(tabletop=scene, time=0.0, poses=lambda: where.blocks, carriers=dict)
    seen = Sight(world, Chance(scene, piles_of(s1="abc"), 1)).blocks()
    assert [seen[block].position[2] for block in "abc"] == pytest.approx([0.015, 0.06, 0.1125])


def shuffled():
    """Two piles of unlike boxes: one is toppled whole, the other loses its top."""
    return make_instance(
        name="shuffled",
        blocks=["b1", "b2", "b3", "b4"],
        stacks=["s1", "s2", "s3"],
        buffers=["u1"],
        start={"s2": ["b1", "b2", "b3", "b4"]},
        goal=StacksGoal({"s2": ("b1",), "s3": ("b3", "b2", "b4")}),
    )


@pytest.mark.slow
@pytest.mark.parametrize("engine", ["pybullet", "mujoco"])
def test_unlike_boxes_are_toppled_and_piled_anew(engine):
    pytest.importorskip(engine)
    plan = plan_of(
        "shuffled",
        Topple("s2", 2),
        Pick("b3", "table"),
        Place("b3", "s3"),
        Pick("b2", "table"),
        Place("b2", "s3"),
        Pick("b4", "table"),
        Place("b4", "s3"),
    )
    scene = read_scene(ROOT / "examples" / "boxes-scene.toml")
    executor = Executor(shuffled(), plan, scene, policy=OPEN, engine=engine)
    episode = executor.run()
    assert episode.failure is None
    assert episode.final.piles == {"s2": ["b1"], "s3": ["b3", "b2", "b4"]}
    highest = max(pose.position[2] for pose in executor.ended.blocks.values())
    lying = [scene.size(b).upright(executor.ended.blocks[b]) for b in ("b3", "b2", "b4")]
    assert highest == pytest.approx(sum(lying) - lying[-1] / 2, abs=0.003)
