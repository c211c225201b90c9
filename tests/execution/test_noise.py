"""What an episode does not know exactly: how it is said, how it is drawn, what is seen through it."""

import json

import numpy as np
import pytest

from smash.execution.executor import Executor
from smash.execution.policy import OPEN
from smash.execution.readback import read_state
from smash.execution.scene.block_pose import standing
from smash.execution.scene.geometry import Geometry
from smash.execution.scene.noise import Chance, noise_words, parse_noise
from smash.execution.scene.scene_file import default_scene, scene_from_document, scene_of
from smash.execution.scene.start import starting_poses
from smash.execution.scene.tabletop import Noise
from smash.execution.sight import MEMORY, Sight
from smash.execution.viewing.recording import Recording
from smash.problem import MalformedFile, Pick, Place, PositionsGoal, SmashError, make_instance
from smash.records.episodes import Episode, episode_text
from smash.records.record import decoded
from tests.execution.episodes import buried_target, plan_of, swapped_pair
from tests.execution.scooping import scoop_scene


def run(instance, plan, noise, **options):
    return Executor(instance, plan, scene_of(noise=noise), **options).run()


def moved():
    """One block to another stack."""
    instance = make_instance(
        name="one", blocks=["a"], stacks=["s1", "s2"], start={"s1": ["a"]}, goal=PositionsGoal({"a": ("s2", 1)})
    )
    return instance, plan_of("one", Pick("a", "s1"), Place("a", "s2"))


def test_a_text_and_a_scene_file_say_the_same():
    document = {"format": "smash-scene/1", "name": "default", "base": "default", "noise": {"pose": 0.003, "yaw": 2.0}}
    assert scene_from_document(document) == scene_of(noise="pose=3mm, yaw=2deg")
    assert noise_words(parse_noise("friction=0.1,size=.5mm,pose=0.3cm")) == "pose=3mm,friction=10%,size=0.5mm"


@pytest.mark.parametrize(
    ("text", "word"),
    [
        ("", "KIND=AMOUNT"),
        ("pose", "a number"),
        ("pose=3", "in mm or cm or m"),
        ("pose=3deg", "in mm or cm or m"),
        ("pose=-3mm", "0 or more"),
        ("pose=nanmm", "a number"),
        ("pose=1mm,pose=2mm", "twice"),
        ("shape=1mm", "KIND=AMOUNT of pose, yaw"),
        ("pose=1m", "0 to 50mm"),
        ("friction=90%", "0 to 50%"),
    ],
)
def test_a_noise_that_is_none_is_refused_in_one_line(text, word):
    with pytest.raises(SmashError, match=word) as refusal:
        parse_noise(text)
    assert "\n" not in str(refusal.value)
    assert refusal.value.exit_code == 2


@pytest.mark.parametrize("noise", [{"pose": -0.001}, {"yaw": 90.0}, {"mass": float("nan")}, {"shape": 1.0}])
def test_a_scene_with_a_noise_that_is_none_is_refused(noise):
    document = {"format": "smash-scene/1", "name": "n", "base": "default", "noise": noise}
    with pytest.raises(MalformedFile, match="noise"):
        scene_from_document(document)


def test_a_pace_is_a_share_of_the_limits_and_noise_tells_scenes_apart():
    assert (scene_of(pace=0.1).velocity, scene_of(pace=0.1).acceleration) == (0.1, 0.1)
    with pytest.raises(SmashError, match=r"0\.01 to 1"):
        scene_of(pace=0.0)
    assert scene_of(noise="pose=0mm").fingerprint == default_scene().fingerprint
    assert scene_of(noise="pose=1mm").fingerprint != default_scene().fingerprint


def test_no_noise_is_what_was_before():
    episodes = [run(*moved(), noise, seed=3) for noise in (None, "pose=0mm,friction=0%")]
    assert episodes[0].without_measured_times() == episodes[1].without_measured_times()
    assert episodes[0].noise == {}


def test_the_seed_draws_the_same_noise_again_and_another_kind_changes_none_of_it():
    chances = [Chance(scene_of(noise=text), buried_target(), 5) for text in ("mass=20%", "mass=20%,friction=10%")]
    masses = [[made.mass for made in chance.made.values()] for chance in chances]
    assert masses[0] == masses[1] != [0.1] * 4
    assert {made.friction for made in chances[0].made.values()} == {default_scene().friction.block}
    assert chances[1].scene().friction != default_scene().friction


def test_blocks_of_other_sizes_stand_on_one_another_at_the_start():
    instance = buried_target()
    scene = scene_of(noise="size=1mm,placement=3mm")
    chance = Chance(scene, instance, 0)
    poses = chance.at_start(starting_poses(instance, scene.bind(instance), scene, np.random.default_rng(0)))
    sides = [chance.made[block].height for block in "abcd"]
    assert max(sides) > min(sides)
    assert all(abs(side - scene.side) <= 0.001 for side in sides)
    tops = [float(poses[block].position[2]) + side / 2 for block, side in zip("abcd", sides, strict=True)]
    assert tops == pytest.approx(np.cumsum(sides))
    assert len({float(poses[block].position[0]) for block in "abcd"}) == 4


class StillWorld:
    """Blocks that stand where they are told, and time that passes when it is told."""

    def __init__(self, **poses):
        self.tabletop, self.time, self.shown, self.trays = scoop_scene(), 0.0, poses, {}

    def poses(self):
        return dict(self.shown)

    def carriers(self):
        return self.trays


def test_a_block_that_lies_still_is_known_better_with_each_look_and_one_that_moves_anew():
    world = StillWorld(a=standing(0.4, 0.0, 0.0225, 0.2))
    sight = Sight(world, Chance(scene_of(noise="pose=5mm,yaw=3deg"), buried_target(), 1))
    first = sight.blocks()["a"].position
    assert np.array_equal(sight.blocks()["a"].position, first)
    assert sight.spread("a") > 0.005
    for _ in range(2 * MEMORY):
        world.time += 0.1
        seen = sight.blocks()["a"]
    assert seen.distance(0.4, 0.0) < 0.004
    assert abs(seen.yaw - 0.2) < 0.03
    assert seen.position[2] == 0.0225
    assert sight.spread("a") < 0.002
    world.shown["a"] = standing(0.5, 0.0, 0.0225, 0.2)
    world.time += 0.1
    assert sight.blocks()["a"].distance(0.5, 0.0) < 0.025
    assert sight.spread("a") > 0.005


def test_a_block_on_a_tray_is_seen_as_high_as_the_tray_is():
    world = StillWorld()
    tray = world.tabletop.tray
    world.trays = {"t": tray.at(0.4, 0.1, 0.5)}
    world.shown = {"a": tray.cell(world.trays["t"], 0), "b": standing(0.2, -0.3, 0.0675, 0.0)}
    sight = Sight(world, Chance(scene_of(noise="pose=4mm"), buried_target(), 1))
    assert [sight.blocks()[block].position[2] for block in "ab"] == pytest.approx(
        [world.shown[block].position[2] for block in "ab"]
    )


def test_a_camera_that_is_off_is_off_in_the_same_way_at_every_look():
    world = StillWorld(a=standing(0.4, 0.0, 0.0225, 0.0), b=standing(0.5, 0.1, 0.0225, 0.0))
    sight = Sight(world, Chance(scene_of(noise="camera=3mm"), buried_target(), 1))
    off = [sight.blocks()[block].position - world.shown[block].position for block in "ab"]
    assert off[0] == pytest.approx(off[1])
    assert 0 < np.abs(off[0]).max() <= 0.009 + 1e-12
    assert sight.spread("a") == pytest.approx(0.003)


def test_a_block_may_be_seen_further_off_its_place_where_it_is_not_seen_exactly():
    scene, instance = default_scene(), buried_target()
    slot = scene.stacks[0]
    beside = {"a": standing(slot.x + 0.019, slot.y, scene.side / 2, slot.angle)}
    where = Geometry(scene.bind(instance), blocks=beside)
    assert read_state(where, scene).piles["s1"] == []
    assert read_state(where, scene, noise=Noise(pose=0.004)).piles["s1"] == ["a"]


def test_a_noisy_episode_succeeds_says_its_noise_and_is_the_same_again():
    noise = "pose=3mm,yaw=2deg,placement=1mm,friction=10%,mass=20%,size=0.3mm"
    episodes = [run(*moved(), noise, seed=4) for _ in range(2)]
    assert episodes[0].success, episodes[0].failure
    assert sorted(episodes[0].noise) == ["friction", "mass", "placement", "pose", "size", "yaw"]
    assert episodes[0].without_measured_times() == episodes[1].without_measured_times()
    assert json.loads(episode_text(episodes[0]))["noise"] == episodes[0].noise


def test_blocks_that_are_not_known_well_enough_are_not_grasped_blindly_nor_planned_for_again():
    asked = []
    episode = run(*moved(), "camera=10mm", replanner=lambda *given: asked.append(given))
    assert (episode.failure.name, episode.failure.step) == ("blind", 0)
    assert "30.0 mm beside where it is seen" in episode.failure.reason
    assert (asked, episode.replans) == ([], 0)


def test_success_is_judged_by_where_the_blocks_are_and_not_by_where_they_are_seen():
    executor = Executor(swapped_pair(), plan_of("swapped"), default_scene(), policy=OPEN)
    executor._judge = lambda: None
    episode = executor.run()
    assert not episode.success
    assert "was not seen" in episode.failure.reason


def test_a_hand_that_is_astray_puts_a_block_beside_its_place_without_knowing():
    recording = Recording()
    executor = Executor(*moved(), scene_of(noise="placement=4mm"), policy=OPEN, on_frame=recording.take)
    assert executor.run().success
    offsets = [Chance(executor.tabletop, moved()[0], 0).astray() for _ in range(30)]
    assert np.abs(offsets).max() <= 0.008
    chance = Chance(executor.tabletop, moved()[0], 0)
    chance.astray()  # at the start
    slot = default_scene().stacks[1]
    assert recording.blocks[-1][0, :2] == pytest.approx(np.array([slot.x, slot.y]) + chance.astray(), abs=0.002)


def test_older_records_of_episodes_have_no_noise():
    episode = run(swapped_pair(), plan_of("swapped"), None, policy=OPEN)
    document = episode.without_measured_times()
    del document["noise"], document["speed"]
    document["times"] = dict.fromkeys(("offline", "offline_cpu", "online", "online_cpu", "execution", "task"), 0.0)
    again = decoded(json.dumps(document).encode(), Episode)
    assert (again.noise, again.speed) == ({}, None)
