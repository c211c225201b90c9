"""Layouts: whatever the search finds is judged by what knows nothing of the search."""

import dataclasses
import subprocess
import sys
import tomllib
from math import hypot, pi
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from smash.execution.actions.topple import strip
from smash.execution.executor import Executor
from smash.execution.layout.bounds import impossible
from smash.execution.layout.candidates import SPACINGS, candidates
from smash.execution.layout.conditions import violations
from smash.execution.layout.judging import problems_of_plan
from smash.execution.layout.laying import NoLayout, NotFound, lay_out
from smash.execution.layout.rectangles import Rectangles
from smash.execution.layout.wanted import Place, in_cubes, places_of_instance, places_of_plan
from smash.execution.policy import OPEN
from smash.execution.scene.piles import misfits, needs_of, piles_of_ends
from smash.execution.scene.scene_file import (
    DEFAULT_SCENE,
    default_scene,
    read_scene,
    scene_document,
    scene_from_document,
    scene_of,
)
from smash.execution.scene.scene_writing import scene_toml, with_slots
from smash.execution.scene.tabletop import DIRECTIONS, DoesNotFit, Slot
from smash.motion.robots import load_robot
from smash.problem import (
    Carrier,
    Law,
    Pick,
    PlanOptions,
    PositionsGoal,
    StacksGoal,
    Topple,
    make_instance,
    write_instance,
    write_plan,
)
from smash.problem import Place as Put
from smash.problem.errors import Unsupported
from smash.problem.files.plans import read_plan
from smash.problem.sets.generators import generate
from tests.execution.episodes import buried_plan, buried_target, plan_of
from tests.six_joints import written

SIDE = default_scene().side
ROBOT = load_robot()
PLANS = Path(__file__).parent / "plans"
angles = st.floats(-pi, pi)
kinds = st.builds(Place, st.just(""), st.integers(1, 9), st.integers(0, 6))


def rectangle(x, y, turn, length, width):
    return Rectangles(np.array([[x, y]]), np.array([[np.cos(turn), np.sin(turn)]]), np.array([length, width]))


rectangles = st.builds(rectangle, *(st.floats(-0.5, 0.5),) * 2, angles, st.floats(0.05, 0.4), st.floats(0.05, 0.4))


def corners(one):
    along, across = one.axes[0] * one.half[0], np.array([-one.axes[0, 1], one.axes[0, 0]]) * one.half[1]
    return [one.centres[0] + a * along + b * across for a in (-1, 1) for b in (-1, 1)]


@given(rectangles, rectangles, st.floats(-1, 1), st.floats(-1, 1))
def test_rectangles_that_share_a_point_meet_whichever_is_asked(one, other, along, across):
    assert one.meet(other)[0] == other.meet(one)[0]
    across_axis = np.array([-one.axes[0, 1], one.axes[0, 0]])
    point = one.centres[0] + along * one.half[0] * one.axes[0] + across * one.half[1] * across_axis
    if other.hold(point, -1e-9)[0]:
        assert one.meet(other)[0]


@given(rectangles, rectangles)
def test_rectangles_that_a_side_separates_do_not_meet(one, other):
    beyond = [(corner - one.centres[0]) @ one.axes[0] > one.half[0] for corner in corners(other)]
    if all(beyond):
        assert not one.meet(other)[0]


@settings(max_examples=10, deadline=None)
@given(kinds, kinds, st.integers(0, 2**31), st.sampled_from(SPACINGS))
def test_two_candidates_that_stand_together_lie_in_none_of_each_other_s_strips(one, other, seed, spacing):
    draw = np.random.default_rng(seed)
    ones, others = candidates(one, SIDE, ROBOT), candidates(other, SIDE, ROBOT)
    if not ones.slots or not others.slots:
        return
    chosen = others.only(int(draw.integers(len(others.slots))))
    together = np.flatnonzero(ones.beside(chosen, SIDE, spacing))
    for which in draw.permutation(together)[:20]:
        pair = (ones.slots[which], chosen.slots[0])
        assert hypot(pair[0].x - pair[1].x, pair[0].y - pair[1].y) > 2 * SIDE
        for slot, there in (pair, pair[::-1]):
            for direction in slot.directions:
                along, aside = slot.coordinates(there.x, there.y, direction)
                room = strip(slot.falling)
                assert not (0 < along < room.length + SIDE / 2 and abs(aside) < room.half_width + SIDE / 2)


@given(kinds)
@settings(max_examples=10, deadline=None)
def test_every_candidate_s_pile_is_within_the_arm_s_reach(kind):
    for slot in candidates(kind, SIDE, ROBOT).slots:
        assert kind.height * SIDE <= ROBOT.highest(slot.radius) + 1e-9
        assert bool(slot.directions) == bool(kind.falling)


def low(blocks=4, stacks=2, buffers=1, height=2, **options):
    instance = generate("multi", blocks, stacks=stacks, buffers=buffers)[0]
    return lay_out(Law(instance, PlanOptions(**options)), default_scene(), height=height)


def strips_of(tabletop):
    for slot in tabletop.stacks:
        for direction in slot.directions:
            room, heading = strip(slot.falling), slot.heading(direction)
            x, y = slot.point(room.length / 2, 0.0, direction)
            yield rectangle(x, y, heading, room.length / 2, room.half_width)


def judged(found):
    tabletop = found.tabletop
    assert violations(tabletop) == []
    strips = list(strips_of(tabletop))
    for index, one in enumerate(strips):
        assert not any(one.meet(other)[0] for other in strips[:index])
    for place, slot in zip(found.places, tabletop.slots, strict=True):
        assert slot.highest == place.height <= tabletop.room(slot)
        assert (slot.falling or 0) == place.falling
        assert bool(slot.directions) == bool(place.falling)


@pytest.mark.slow
@pytest.mark.timeout(600)
@settings(max_examples=6, deadline=None)
@given(st.integers(1, 6), st.integers(0, 6), st.integers(1, 4), st.booleans(), st.integers(0, 1000))
def test_whatever_layout_is_found_keeps_both_conditions_and_overlaps_nowhere(stacks, buffers, height, topple, seed):
    instance = generate("multi", stacks + 3, stacks=stacks, buffers=buffers)[0]
    try:
        found = lay_out(Law(instance, PlanOptions(topple)), default_scene(), height=height, attempts=6, seed=seed)
    except NotFound:
        return
    judged(found)


@pytest.mark.slow
def test_the_same_arguments_give_the_same_layout_and_another_seed_another():
    assert low() == low()
    judged(low())
    assert [slot.directions for slot in low(topple=False).tabletop.stacks] == [(), ()]


@pytest.mark.slow
def test_another_arm_has_layouts_within_its_own_reach(tmp_path):
    robot = written(tmp_path, ("heights = [[0.20, 12], [0.50, 12], [0.70, 6]]", "heights = [[0.25, 3], [0.55, 3]]"))
    instance = generate("multi", 4, stacks=2, buffers=1)[0]
    scene = scene_of(None, robot=robot)
    found = lay_out(Law(instance, PlanOptions(max_topple=1)), scene, height=3, buffer_height=2)
    judged(found)
    assert all(0.25 < slot.radius < 0.55 for slot in found.tabletop.slots)
    with pytest.raises(NoLayout, match="no higher than 3"):
        lay_out(Law(instance), scene, height=4)


def test_a_plan_s_places_have_its_highest_piles_and_a_block_to_spare():
    law = Law(buried_target())
    places = {place.location: place for place in places_of_plan(law, buried_plan().actions, 12)}
    assert places["s1"] == Place("s1", 5, 3)
    assert places["g"] == Place("g", 2)
    assert places["u0"] == Place("u0", 1)
    assert {place.height for place in places_of_plan(law, buried_plan().actions, 4)} == {4, 2, 1}


def test_without_a_plan_stacks_may_be_toppled_whole_as_far_as_plans_may():
    instance = buried_target()
    falls = [places_of_instance(instance, options, 4, 2)[0].falling for options in OPTIONS]
    assert falls == [4, 2, 0]
    assert places_of_instance(instance, OPTIONS[0], 4, 2)[-1] == Place("u11", 2)


def test_no_place_is_lower_than_the_piles_of_start_and_goal():
    places = {place.location: place for place in places_of_instance(buried_target(), OPTIONS[1], 1, 1)}
    assert (places["s1"], places["s2"]) == (Place("s1", 4, 2), Place("s2", 1, 1))


OPTIONS = (PlanOptions(), PlanOptions(max_topple=2), PlanOptions(topple=False))


def test_piles_are_counted_as_the_law_carries_a_plan_out():
    law, actions = Law(buried_target()), buried_plan().actions
    assert needs_of(law, actions).highest == {"s1": 4, "g": 1}
    assert needs_of(law, actions).topples == {"s1": 3}
    assert piles_of_ends(law.instance)["g"] == 1


def tower(height, stacks=2, buffers=0):
    names = [f"b{number}" for number in range(height)]
    return make_instance(
        name="tower",
        blocks=names,
        stacks=[f"s{number}" for number in range(stacks)],
        buffers=[f"u{number}" for number in range(buffers)],
        start={"s0": names},
        goal=StacksGoal({"s1": tuple(reversed(names))}),
    )


def test_more_blocks_than_the_arm_can_pile_up_are_no_hindrance_where_no_pile_is_so_high():
    instance = make_instance(
        name="wide",
        blocks=[f"b{number}" for number in range(20)],
        stacks=["s1", "s2"],
        start={"s1": [f"b{n}" for n in range(10)], "s2": [f"b{n}" for n in range(10, 20)]},
        goal=PositionsGoal({}),
    )
    assert set(default_scene().bind(instance)) == {"s1", "s2"}
    law = Law(instance)
    higher = [action for n in range(3) for action in (Pick(f"b{19 - n}", "s2"), Put(f"b{19 - n}", "s1"))]
    assert list(misfits(default_scene(), instance, needs_of(law, higher[:4]))) == []
    (problem,) = misfits(default_scene(), instance, needs_of(law, higher))
    assert "13 blocks on 's1'" in problem
    assert "room for 12" in problem


def with_stacks(*slots):
    return dataclasses.replace(default_scene(), stacks=slots, buffers=())


def test_a_plan_that_topples_where_no_strip_is_or_piles_higher_than_a_slot_takes_is_refused():
    instance = tower(2)
    bare = with_stacks(Slot(0.45, 0.0, (), 2), Slot(0.45, 1.0, (), 1))
    with pytest.raises(DoesNotFit, match="no landing strip"):
        Executor(instance, plan_of("tower", Topple("s0", 1)), bare)
    moved = [Pick("b1", "s0"), Put("b1", "s1"), Pick("b0", "s0"), Put("b0", "s1")]
    with pytest.raises(DoesNotFit, match="room for 1"):
        Executor(instance, plan_of("tower", *moved), bare)


def test_a_new_plan_that_does_not_fit_the_scene_is_asked_for_again_without_topples():
    instance = tower(2)
    plain = [Pick("b1", "s0"), Put("b1", "s1"), Pick("b0", "s0"), Put("b0", "s1")]
    toppled = [Topple("s0", 1), Pick("b1", "table"), Put("b1", "s1"), Pick("b0", "table"), Put("b0", "s1")]
    asked = []

    def replanner(instance, options):
        asked.append(options.topple)
        return toppled if options.topple else plain

    bare = with_stacks(Slot(0.45, 0.0), Slot(0.45, 1.0))
    executor = Executor(instance, plan_of("tower", *plain), bare, replanner=replanner)
    assert executor._ask(instance) == plain
    assert asked == [True, False]


@pytest.mark.parametrize(
    ("places", "words"),
    [
        ([Place("s1", 13)], "no higher than 12"),
        ([Place(f"s{n}", 1) for n in range(700)], "700 places"),
        ([Place(f"s{n}", 4, 4) for n in range(30)], "landing strips take"),
    ],
)
def test_what_cannot_be_laid_out_is_proven(places, words):
    assert words in impossible(places, SIDE, ROBOT)
    assert impossible(places[:1] if len(places) > 1 else [Place("s1", 12)], SIDE, ROBOT) is None


def test_carriers_are_not_laid_out():
    instance = make_instance(
        name="tray",
        blocks=["a"],
        stacks=["s1"],
        start={"s1": ["a"]},
        carriers=[Carrier("t", ("p", "q"), "p", capacity=2)],
        goal=PositionsGoal({}),
    )
    with pytest.raises(Unsupported, match="carriers"):
        lay_out(Law(instance), default_scene())


slots = st.builds(
    Slot,
    st.integers(300, 700).map(lambda number: number / 1000),
    st.integers(-179, 179).map(lambda degrees: degrees / 180 * pi),
    st.lists(st.sampled_from(sorted(DIRECTIONS)), unique=True).map(tuple),
    st.none() | st.integers(1, 12),
    st.none() | st.integers(1, 12),
)


DOCUMENT = scene_document(DEFAULT_SCENE)


@settings(max_examples=50, deadline=None)
@given(slots, st.text())
def test_a_scene_that_is_written_is_read_again(slot, name):
    document = with_slots(DOCUMENT, name, [slot], [])
    read = scene_from_document(tomllib.loads(scene_toml(document, "A comment.\nIn two lines.")))
    assert read.name == name
    assert (read.side, read.friction, read.velocity) == (SIDE, default_scene().friction, 0.5)
    (again,) = read.stacks
    assert (again.radius, again.directions, again.highest, again.falling) == (
        *(slot.radius, slot.directions, slot.highest, slot.falling),
    )
    assert again.angle == pytest.approx(slot.angle, abs=1e-6)


def test_a_strip_is_as_long_as_the_highest_boxes_of_the_scene_ask_for():
    tall = dataclasses.replace(default_scene(), height=0.07)
    place = in_cubes(Place("s1", 4, 3), tall)
    assert (place.strip, place.judged) == (strip(5), strip(5))
    assert in_cubes(Place("s1", 4, 3), default_scene()) == Place("s1", 4, 3)
    pool = candidates(place, tall.longest, ROBOT)
    assert pool.strips is None or pool.strips.half[1] == strip(5).half_width
    assert len(pool.slots) < len(candidates(Place("s1", 4, 3), tall.longest, ROBOT).slots)


@pytest.mark.slow
def test_a_layout_of_boxes_keeps_both_conditions_as_the_boxes_are():
    tall = dataclasses.replace(default_scene(), height=0.06)
    found = lay_out(Law(buried_target()), tall, buried_plan().actions)
    assert violations(found.tabletop) == []


def test_what_is_null_in_a_scene_of_json_is_left_out_of_its_toml():
    document = {**DOCUMENT, "robot": None, "block": {"side": 0.04, "height": None}, "blocks": {"a": {"mass": None}}}
    text = scene_toml(with_slots(document, "x", default_scene().stacks, []))
    assert scene_from_document(tomllib.loads(text)) == dataclasses.replace(
        scene_from_document(document), name="x", buffers=()
    )


def test_a_layout_in_which_blocks_that_lie_on_the_table_have_no_room_is_judged_bad():
    instance = make_instance(
        name="lying", blocks=list("ab"), stacks=["s1"], start={"s1": ["a"]}, table=["b"], goal=PositionsGoal({})
    )
    (problem,) = problems_of_plan(with_stacks(Slot(0.45, 0.0)), Law(instance), ())
    assert problem.startswith("the table region of scene")


def layout(folder, *arguments):
    command = [sys.executable, "-m", "smash", "layout", *arguments]
    return subprocess.run(command, capture_output=True, text=True, cwd=folder, timeout=100)


@pytest.mark.slow
def test_the_command_writes_a_scene_that_execute_and_draw_scene_read(tmp_path):
    write_instance(buried_target(), tmp_path / "instance.json")
    write_plan(buried_plan(), tmp_path / "plan.json")
    ended = layout(tmp_path, "instance.json", "plan.json", "--out", "scene.toml")
    assert ended.returncode == 0, ended.stderr
    assert "s1: " in ended.stdout
    assert "3 fall" in ended.stdout
    scene = read_scene(tmp_path / "scene.toml")
    assert len(scene.slots) == 16
    assert violations(scene) == []
    assert Executor(buried_target(), buried_plan(), scene, policy=OPEN).run().success


@pytest.mark.slow
@pytest.mark.parametrize(
    ("instance", "arguments", "code", "words"),
    [
        (tower(20), (), 3, "give the PLAN, or --height"),
        (tower(3, stacks=700), (), 3, "no layout for 'tower' exists: 700 places"),
        (tower(3, stacks=14), ("--attempts", "1"), 4, "was found in 1 attempts"),
        (tower(3), ("--no-topple", "--max-topple", "2"), 2, "--no-topple goes without"),
        (tower(3), ("--out", "scene.json"), 2, ".toml"),
    ],
)
def test_what_the_command_cannot_do_is_one_line(instance, arguments, code, words, tmp_path):
    write_instance(instance, tmp_path / "instance.json")
    ended = layout(tmp_path, "instance.json", "--out", "scene.toml", *arguments)
    assert (ended.returncode, ended.stdout, ended.stderr.count("\n")) == (code, "", 1)
    assert words in ended.stderr
    assert not (tmp_path / "scene.toml").exists()


def test_a_scene_with_too_few_stacks_names_the_command_that_makes_another():
    with pytest.raises(DoesNotFit, match="smash layout") as refusal:
        default_scene().bind(tower(3, stacks=5))
    assert "\n" not in str(refusal.value)


@pytest.mark.slow
@pytest.mark.timeout(900)
@pytest.mark.parametrize(("blocks", "stacks", "buffers"), [(20, 5, 6), (16, 8, 4)])
@pytest.mark.parametrize("kind", ["topple", "plain"])
def test_five_stacks_of_20_and_eight_of_16_are_laid_out_and_carried_out(blocks, stacks, buffers, kind):
    pytest.importorskip("mujoco")
    name = f"multi-{blocks}x{stacks}-000"
    instance = generate("multi", blocks, stacks=stacks, buffers=buffers, seed=1)[0]
    plan = read_plan(PLANS / f"{name}.{kind}.plan.json")
    law = Law(instance, plan.options)
    found = lay_out(law, default_scene(), plan.actions)
    judged(found)
    episode = Executor(instance, plan, found.tabletop, policy=OPEN, engine="mujoco").run()
    assert episode.success, episode.failure
