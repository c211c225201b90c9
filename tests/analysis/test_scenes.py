"""What the records of episodes tell of scene, noise and pace."""

import pytest
from smash_analysis.tables.scenes import Conditions, scene_options, scene_words

from smash.experiments.episodes.series import scene_name
from smash.records.scenes import MixedScenes, require_one_scene


@pytest.mark.parametrize(
    ("scene", "found"),
    [
        (None, Conditions("default", {}, None)),
        ("default pace=0.25", Conditions("default", {}, (0.25, 0.25))),
        ("default pose=3mm,yaw=2.5deg pace=0.1", Conditions("default", {"pose": 3.0, "yaw": 2.5}, (0.1, 0.1))),
        ("default friction=25%", Conditions("default", {"friction": 25.0}, None)),
        ("my table exact", Conditions("my table", {}, None)),
        ("my table", Conditions("my table", None, None)),
        ("a pace=e", Conditions("a pace=e", None, None)),
        ("two\nlines", Conditions("two\nlines", None, None)),
    ],
)
def test_words_of_a_scene_are_read(scene, found):
    assert scene_words(scene) == found


@pytest.mark.parametrize(
    ("scene", "options"),
    [
        (None, ""),
        ("default pose=3mm,yaw=2.5deg pace=0.1", "--noise pose=3mm,yaw=2.5deg --pace 0.1"),
        ("my table exact", "--scene 'my table.toml' --noise pose=0mm"),
    ],
)
def test_the_options_that_a_scene_comes_from_are_said(scene, options):
    assert scene_options(scene) == options


def test_words_that_the_records_get_are_read():
    pytest.importorskip("pinocchio")
    name = scene_name("rough.toml", "pose=.3cm,yaw=0.0349066rad,size=1mm", 0.5)
    assert scene_words(name) == Conditions("rough", {"pose": 3.0, "yaw": 2.0, "size": 1.0}, (0.5, 0.5))


def test_several_scenes_are_refused_in_one_line():
    require_one_scene("runs/x", ["a", "a"])
    with pytest.raises(MixedScenes, match=r"runs/x: episodes in several scenes \(2 in a, 1 in b\) make no table"):
        require_one_scene("runs/x", ["a", "b", "a"])
