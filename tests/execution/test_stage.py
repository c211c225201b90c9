"""The two stages, PyBullet's and MuJoCo's: one picture, whoever paints it."""

from dataclasses import replace
from importlib import import_module
from operator import itemgetter

import numpy as np
import pytest

from smash.execution.physics.window import furnish
from smash.execution.scene.marks import slot_marks
from smash.execution.scene.scene_file import default_scene
from smash.execution.viewing import painters
from smash.execution.viewing.stage import block_colours
from smash.problem.errors import Unsupported
from tests.execution.made_up import recording_of

pytest.importorskip("mujoco")
SIZE = (320, 240)


def taken(kind, names):
    module = import_module(f"smash.execution.viewing.{kind}_stage")
    stage = {"pybullet": "PyBulletStage", "mujoco": "MujocoStage"}[kind]
    try:
        with getattr(module, stage)(default_scene(), names, coarse=True) as opened:
            opened.pose(recording_of(len(names), 0.3), 0)
            return opened.photograph(SIZE).astype(int)
    except Unsupported as refusal:
        pytest.skip(str(refusal))


def hues(picture):
    """Shares of red, green and blue."""
    return picture / np.maximum(picture.sum(axis=2, keepdims=True), 1)


def middle(picture, colour):
    """Where a colour lies in a picture, told by its hue."""
    wanted = np.array(colour) / sum(colour)
    found = np.argwhere(np.abs(hues(picture) - wanted).max(axis=2) < 0.06)
    assert len(found) > 4
    return np.median(found, axis=0)


def test_both_stages_show_a_block_at_the_same_place():
    pytest.importorskip("pybullet")
    colour = block_colours(1)[0]
    first, second = (middle(taken(kind, ["b0"]), colour) for kind in ("pybullet", "mujoco"))
    assert np.abs(first - second).max() <= 2


def test_the_table_that_a_film_paints_once_is_the_one_that_each_still_paints():
    pytest.importorskip("pybullet")
    from smash.execution.viewing.pybullet_stage import PyBulletStage
    from smash.execution.viewing.stage import CAMERA, Camera

    closer = Camera(CAMERA.yaw, CAMERA.pitch, 1.0)
    recording = recording_of(2, 0.3)
    with PyBulletStage(default_scene(), "ab", coarse=True) as film, PyBulletStage(default_scene(), "ab") as still:
        for camera in (CAMERA, closer, CAMERA):
            for stage in (film, still):
                stage.pose(recording, 0)
            shown, known = (stage.photograph(SIZE, camera).astype(int) for stage in (film, still))
            # Shadows and the light on the table change how bright a still is, and no hue.
            assert (np.abs(hues(shown) - hues(known)).max(axis=2) > 0.03).mean() < 0.01


def test_without_opengl_pictures_are_refused_in_one_line_before_the_episode(monkeypatch):
    module = import_module("smash.execution.viewing.mujoco_stage")

    def none(name):
        raise AttributeError("'NoneType' object has no attribute 'glGetError'\nand more")

    monkeypatch.setattr(module, "import_module", none)
    monkeypatch.setattr(painters, "is_there", lambda module: module != "pybullet")
    with pytest.raises(Unsupported, match="MuJoCo draws by OpenGL, and egl cannot be had here") as refusal:
        painters.require_painter()
    assert "\n" not in str(refusal.value)


class Drawn:
    """PyBullet's window, as far as marks on the table are asked of it."""

    GEOM_BOX, COV_ENABLE_GUI = 3, 1

    def __init__(self):
        self.colours = []

    def createVisualShape(self, kind, *, rgbaColor, **size):  # noqa: N802, N803
        self.colours.append(tuple(rgbaColor[:3]))

    def __getattr__(self, name):
        return lambda *arguments: None


def test_the_window_marks_slots_as_pictures_do():
    window = Drawn()
    furnish(window, default_scene())
    assert window.colours == [colour for _, _, colour in slot_marks(default_scene())]


def test_a_stack_that_nothing_topples_looks_like_a_stack():
    scene = default_scene()
    still = replace(scene, stacks=tuple(replace(slot, directions=()) for slot in scene.stacks))
    assert list(map(itemgetter(2), slot_marks(still))) == list(map(itemgetter(2), slot_marks(scene)))
