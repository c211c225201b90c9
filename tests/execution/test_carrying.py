"""The tray: its geometry, level ways, what the scene refuses, and a carry in physics."""

import dataclasses
from math import acos, pi

import numpy as np
import pytest

from smash.execution.actions.arm_motions import ArmMotions
from smash.execution.actions.registry import MOTIONS
from smash.execution.executor import Executor, observed_instance
from smash.execution.grounding import Grounder
from smash.execution.policy import OPEN
from smash.execution.readback import NOWHERE, read_state
from smash.execution.scene.block_pose import BlockPose, standing
from smash.execution.scene.geometry import Geometry
from smash.execution.scene.scene_file import default_scene
from smash.execution.scene.start import starting_carriers, starting_poses
from smash.execution.scene.tabletop import DoesNotFit, Slot
from smash.execution.scene.tray import Tray, heading
from smash.motion.errors import NoIk
from smash.motion.move import Move
from smash.problem import Carrier, Carry, Law, Pick, Place, PositionsGoal, State
from smash.problem.actions.registry import FAMILY
from tests.execution.episodes import plan_of
from tests.execution.scooping import scoop, scoop_scene
from tests.robots import PANDA, READY

LOADED = Carrier("tray", ("left", "right"), "left", 2, ("a", "c"))


def loaded(**changes):
    return scoop(**{"start": {"s1": ["b"], "s2": ["d"]}, "carriers": [LOADED]} | changes)


def laid_out(instance, scene):
    slots, stations = scene.bind(instance), scene.bind_stations(instance)
    carriers = starting_carriers(instance, stations, scene)
    blocks = starting_poses(instance, slots, scene, np.random.default_rng(0), carriers)
    return Geometry(slots, stations, blocks, carriers)


def carried(scene, instance):
    where = laid_out(instance, scene)
    return MOTIONS[Carry].plan(ArmMotions(scene), READY, Carry("tray", "right"), State.start_of(instance), where)


@pytest.mark.parametrize("rows", [1, 2, 3])
@pytest.mark.parametrize("side", [0.03, 0.045, 0.06])
def test_a_block_in_any_cell_is_told_from_one_beside_the_tray(rows, side):
    tray = Tray(side, rows=rows)
    pose = tray.at(0.4, -0.1, 0.7)
    for index in range(tray.capacity):
        block = tray.cell(pose, index)
        assert tray.cell_of(pose, block) == index
        assert tray.cell_of(pose, BlockPose(block.position + np.array([0, 0, side]), block.rotation)) is None
    assert tray.cell_of(pose, standing(0.4, 0.4, side / 2, 0.0)) is None
    assert tray.free_cells(pose, {"a": tray.cell(pose, 0)}) == list(range(1, tray.capacity))
    assert heading(pose) == pytest.approx(0.7)


def test_the_hand_at_the_post_is_above_the_blocks():
    tray = Tray(0.045)
    pose = tray.at(0.0, 0.0, 0.0)
    fingertips = tray.grip(pose)[2] - 0.0072
    assert fingertips > tray.cell(pose, 0).position[2] + 0.045 / 2 + 0.005


def test_a_carried_tray_stays_level_all_the_way():
    moves = [segment for segment in carried(scoop_scene(), loaded()) if isinstance(segment, Move)]
    held = [move for move in moves if move.hand.attached is not None]
    assert held
    for move in held:
        samples = move.trajectory.sample(0.01)
        tilts = [acos(min(1.0, -PANDA.forward(joints).rotation[2, 2])) for joints in samples]
        assert max(tilts) < 0.01


def test_a_carried_tray_is_accelerated_less_than_friction_bears():
    scene = scoop_scene()
    moves = [segment for segment in carried(scene, loaded()) if isinstance(segment, Move)]
    step, bears = 0.02, scene.tray.friction * scene.friction.block * 9.81
    for move in (move for move in moves if move.hand.attached is not None):
        offset = move.hand.attached.translations[-1]
        frames = [PANDA.forward(joints) for joints in move.trajectory.sample(step)]
        points = np.array([frame.position + frame.rotation @ offset for frame in frames])
        accelerations = np.linalg.norm(np.diff(points, 2, axis=0), axis=1) / step**2
        assert accelerations.max(initial=0.0) < 0.6 * bears


def test_what_a_carry_leaves_is_known_before():
    scene, instance = scoop_scene(), loaded()
    where = laid_out(instance, scene)
    arm = ArmMotions(scene)
    tasks = Grounder(arm).ground([Carry("tray", "right"), Pick("a", "tray")], Law(instance), where, READY)
    assert all(task.segments for task in tasks)
    MOTIONS[Carry].foresee(arm, Carry("tray", "right"), State.start_of(instance), where)
    state = read_state(where, scene)
    assert state.stations == {"tray": "right"}
    assert state.carried == {"tray": {"a", "c"}}


@pytest.mark.parametrize(("turn", "stands"), [(0.0, True), (pi, True), (pi / 2, False), (0.3, False)])
def test_a_tray_stands_at_a_station_along_it_whichever_end_is_which(turn, stands):
    scene, where = scoop_scene(), laid_out(loaded(), scoop_scene())
    station = where.stations["left"]
    where.carriers["tray"] = scene.tray.at(station.x, station.y, station.angle + pi / 2 + turn)
    assert read_state(where, scene).stations == {"tray": "left" if stands else NOWHERE}


def test_a_tray_off_its_stations_is_nowhere():
    scene, instance = scoop_scene(), loaded()
    where = laid_out(instance, scene)
    where.carriers["tray"] = scene.tray.at(0.4, 0.0, pi / 2)
    assert read_state(where, scene).stations == {"tray": NOWHERE}


def test_a_post_out_of_reach_is_a_named_failure():
    scene = dataclasses.replace(scoop_scene(), stations=(Slot(0.95, 0.6), Slot(0.45, -1.0)))
    with pytest.raises(NoIk, match="post of carrier 'tray'"):
        carried(scene, loaded())


@pytest.mark.parametrize(
    ("scene", "carriers"),
    [
        (default_scene(), [dataclasses.replace(LOADED, holds=())]),
        (scoop_scene(), [Carrier("tray", ("left", "right", "middle"), "left", 2)]),
        (scoop_scene(), [Carrier("tray", ("left", "right"), "left", 3)]),
    ],
)
def test_carriers_that_a_scene_cannot_hold_are_refused_in_one_line(scene, carriers):
    with pytest.raises(DoesNotFit, match="room for") as refusal:
        scene.bind(scoop(carriers=carriers))
    assert "\n" not in str(refusal.value)


def test_the_arm_has_a_motion_for_every_aggregating_action():
    assert {kind.action for kind in FAMILY.values()} >= set(MOTIONS)


def test_the_observed_instance_keeps_what_stands_on_the_carriers():
    instance = loaded()
    state = list(Law(instance).states([Carry("tray", "right")]))[-1]
    again = observed_instance(instance, state)
    assert again.carriers == (dataclasses.replace(LOADED, at="right"),)


@pytest.mark.slow
@pytest.mark.parametrize(("engine", "seed"), [("pybullet", 0), ("pybullet", 1), ("pybullet", 2), ("mujoco", 0)])
def test_blocks_stay_on_a_carried_tray(engine, seed):
    pytest.importorskip(engine)
    instance = loaded(start={}, blocks=["a", "c"], goal=PositionsGoal({"a": ("g1", 1), "c": ("g2", 1)}))
    actions = [Carry("tray", "right"), Pick("a", "tray"), Place("a", "g1"), Pick("c", "tray"), Place("c", "g2")]
    episode = Executor(instance, plan_of("scoop", *actions), scoop_scene(), seed=seed, policy=OPEN, engine=engine).run()
    assert episode.success, episode.failure
    assert episode.final.stations == {"tray": "right"}


@pytest.mark.slow
def test_one_block_on_the_edge_of_the_tray_does_not_tip_it():
    carrier = dataclasses.replace(LOADED, holds=("a",))
    instance = loaded(start={}, blocks=["a"], carriers=[carrier], goal=PositionsGoal({}))
    actions = [Carry("tray", "right"), Carry("tray", "left")]
    episode = Executor(instance, plan_of("scoop", *actions), scoop_scene(), policy=OPEN).run()
    assert episode.success, episode.failure
    assert episode.final.carried == {"tray": ["a"]}
