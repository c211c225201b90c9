import copy
import dataclasses
import json
import tomllib

import pytest

from smash.execution.scene.scene_file import DEFAULT_SCENE, default_scene, read_scene, scene_from_document
from smash.execution.scene.tabletop import DIRECTIONS, DoesNotFit, Friction, Slot
from smash.problem import MalformedFile, StacksGoal, make_instance


@pytest.fixture
def document():
    return tomllib.loads(DEFAULT_SCENE.read_text())


def test_the_default_scene_has_four_stacks_and_twelve_buffers():
    assert len(default_scene().stacks) == 4
    assert len(default_scene().buffers) == 12


def test_json_and_toml_say_the_same(document, tmp_path):
    (tmp_path / "scene.json").write_text(json.dumps(document))
    assert read_scene(tmp_path / "scene.json") == default_scene()


def test_a_scene_with_a_base_differs_from_it_in_what_it_says():
    scene = scene_from_document(
        {"format": "smash-scene/1", "name": "rough", "base": "default", "friction": {"block": 0.7}}
    )
    assert scene == dataclasses.replace(default_scene(), name="rough", friction=Friction(0.7, 0.9, 1.0))


@pytest.mark.parametrize(
    ("path", "value", "word"),
    [
        (["format"], "smash-scene/2", "smash-scene/1"),
        (["colour"], "red", "colour"),
        (["base"], "other", "base"),
        (["block"], {"side": 0.2}, "0.06"),
        (["block"], {"edge": 0.04}, "edge"),
        (["friction"], {"table": 0}, "friction.table"),
        (["stacks"], [], "at least one"),
        (["stacks", 0, "topple"], ["up"], "topple"),
        (["stacks", 0, "topple"], ["clockwise", "clockwise"], "each once"),
        (["stacks", 0, "highest"], 0, "highest"),
        (["stacks", 0, "highest"], 10_000_000, "highest"),
        (["buffers", 0, "falling"], 2, "falling"),
        (["stacks", 1, "angle"], -160, "stands"),
        (["stacks", 1, "radius"], "far", "radius"),
        (["speed"], {"velocity": 2}, "speed.velocity"),
    ],
)
def test_a_malformed_scene_is_refused_in_one_line(document, path, value, word):
    changed = copy.deepcopy(document)
    part = changed
    for key in path[:-1]:
        part = part[key]
    part[path[-1]] = value
    with pytest.raises(MalformedFile, match=word) as refusal:
        scene_from_document(changed, "scene.toml")
    assert "\n" not in str(refusal.value)


@pytest.mark.parametrize(("stacks", "buffers", "blocks"), [(5, 0, 3), (4, 13, 3)])
def test_an_instance_that_does_not_fit_is_refused_in_one_line(stacks, buffers, blocks):
    names = [f"b{number}" for number in range(blocks)]
    instance = make_instance(
        name="big",
        blocks=names,
        stacks=[f"s{number}" for number in range(stacks)],
        buffers=[f"u{number}" for number in range(buffers)],
        start={"s0": names},
        goal=StacksGoal({"s0": tuple(names)}),
    )
    with pytest.raises(DoesNotFit, match="room for") as refusal:
        default_scene().bind(instance)
    assert "\n" not in str(refusal.value)


@pytest.mark.parametrize("direction", DIRECTIONS)
def test_a_slot_s_coordinates_invert_its_points(direction):
    slot = Slot(0.45, 1.1, (direction,))
    assert slot.coordinates(*slot.point(0.2, -0.03, direction), direction) == pytest.approx((0.2, -0.03))


def test_a_scene_names_its_engine_and_is_the_same_scene_in_every_engine():
    document = {"format": "smash-scene/1", "name": "default", "base": "default", "engine": "mujoco"}
    scene = scene_from_document(document)
    assert (scene.engine, default_scene().engine) == ("mujoco", None)
    assert scene.fingerprint == default_scene().fingerprint
    with pytest.raises(MalformedFile, match="engine"):
        scene_from_document({**document, "engine": "ode"})
