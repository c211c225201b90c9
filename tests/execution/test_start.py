"""Where blocks are when an episode begins."""

from itertools import combinations

import numpy as np
import pytest

from smash.execution.scene.region import REGION_APART
from smash.execution.scene.scene_file import default_scene
from smash.execution.scene.start import JITTER, LARGEST, TURN, starting_carriers, starting_poses
from smash.execution.scene.tabletop import DoesNotFit
from smash.problem import Carrier, PositionsGoal, make_instance
from tests.execution.scooping import scoop, scoop_scene

SCENE = default_scene()


def strewn(table, **start):
    blocks = [block for pile in start.values() for block in pile] + list(table)
    return make_instance(
        name="start", blocks=blocks, stacks=["s1", "s2"], start=start, table=list(table), goal=PositionsGoal({})
    )


def poses(instance, seed=0):
    return starting_poses(instance, SCENE.bind(instance), SCENE, np.random.default_rng(seed))


def test_piles_stand_on_their_slots_with_a_little_disorder():
    placed = poses(strewn("", s1="abc", s2="d"))
    for location, pile in (("s1", "abc"), ("s2", "d")):
        slot = SCENE.bind(strewn("", s1="abc", s2="d"))[location]
        for level, block in enumerate(pile):
            assert placed[block].position[2] == pytest.approx((level + 0.5) * SCENE.side)
            assert placed[block].distance(slot.x, slot.y) <= 2**0.5 * LARGEST * JITTER
            assert placed[block].tilt < 1e-9
            quarter = np.pi / 2
            turned = (placed[block].yaw - slot.angle + quarter / 2) % quarter - quarter / 2
            assert abs(turned) <= LARGEST * TURN + 1e-9


def test_the_seed_decides_and_blocks_come_in_the_instances_order():
    instance = strewn("xy", s1="ab")
    first, again, other = poses(instance, 3), poses(instance, 3), poses(instance, 4)
    assert list(first) == list(instance.blocks)
    assert all(np.array_equal(first[block].position, again[block].position) for block in instance.blocks)
    assert not np.array_equal(first["x"].position, other["x"].position)


def test_blocks_of_the_table_region_lie_on_the_table_apart_from_all_else():
    instance = strewn("uvwxyz", s1="abc")
    placed = poses(instance)
    assert all(placed[block].position[2] == pytest.approx(SCENE.side / 2) for block in "uvwxyz")
    for one, other in combinations("uvwxyza", 2):
        apart = placed[one].distance(*placed[other].position[:2])
        assert apart > REGION_APART * SCENE.side


def test_more_blocks_than_the_table_region_has_room_for_are_refused():
    names = [f"b{number}" for number in range(60)]
    instance = make_instance(name="many", blocks=names, stacks=["s"], table=names, start={}, goal=PositionsGoal({}))
    slots = {"s": SCENE.stacks[0]}
    with pytest.raises(DoesNotFit, match="no room"):
        starting_poses(instance, slots, SCENE, np.random.default_rng(0))


def test_carriers_stand_at_their_stations_and_hold_their_blocks_in_cells():
    scene = scoop_scene()
    instance = scoop(
        start={"s1": ["b"], "s2": ["d"]}, carriers=[Carrier("tray", ("left", "right"), "right", 2, ("a", "c"))]
    )
    stations = scene.bind_stations(instance)
    carriers = starting_carriers(instance, stations, scene)
    assert carriers["tray"].distance(stations["right"].x, stations["right"].y) < 1e-9
    placed = starting_poses(instance, scene.bind(instance), scene, np.random.default_rng(0), carriers)
    assert [scene.tray.cell_of(carriers["tray"], placed[block]) for block in "ac"] == [0, 1]
