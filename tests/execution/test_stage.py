"""The two stages, PyBullet's and MuJoCo's: one picture, whoever paints it."""

from importlib import import_module

import numpy as np
import pytest

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


def middle(picture, colour):
    """Where a colour lies in a picture, told by its share of red, green and blue."""
    shares = picture / np.maximum(picture.sum(axis=2, keepdims=True), 1)
    wanted = np.array(colour) / sum(colour)
    found = np.argwhere(np.abs(shares - wanted).max(axis=2) < 0.06)
    assert len(found) > 4
    return np.median(found, axis=0)


def test_both_stages_show_a_block_at_the_same_place():
    pytest.importorskip("pybullet")
    colour = block_colours(1)[0]
    first, second = (middle(taken(kind, ["b0"]), colour) for kind in ("pybullet", "mujoco"))
    assert np.abs(first - second).max() <= 2


def test_without_opengl_pictures_are_refused_in_one_line_before_the_episode(monkeypatch):
    module = import_module("smash.execution.viewing.mujoco_stage")

    def none(name):
        raise AttributeError("'NoneType' object has no attribute 'glGetError'\nand more")

    monkeypatch.setattr(module, "import_module", none)
    monkeypatch.setattr(painters, "is_there", lambda module: module != "pybullet")
    with pytest.raises(Unsupported, match="MuJoCo draws by OpenGL, and egl cannot be had here") as refusal:
        painters.require_painter()
    assert "\n" not in str(refusal.value)
