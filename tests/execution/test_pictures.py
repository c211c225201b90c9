"""Films of recordings made by hand: how fast they run and what their captions say."""

import numpy as np
import pytest

from smash.execution.scene.scene_file import default_scene
from smash.execution.viewing.film import FILM, action_at, film_frames, film_of, write_film
from smash.problem import SmashError
from tests.execution.made_up import episode_of, recording_of

imageio = pytest.importorskip("imageio.v3")
SECONDS = 2.4


@pytest.fixture(scope="module")
def films(tmp_path_factory):
    folder = tmp_path_factory.mktemp("films")
    episode = episode_of("one", ("pick", "a name\nof " + "many words " * 50, "s1"), ("place", "b1", "s2"))
    for name in ("film.gif", "film.mp4"):
        write_film(folder / name, recording_of(1, SECONDS), default_scene(), episode)
    return folder


def test_a_gif_plays_as_fast_as_its_caption_says(films):
    from PIL import Image, ImageSequence

    with Image.open(films / "film.gif") as gif:
        assert gif.size == FILM.size
        assert gif.info["loop"] == 0
        total = sum(frame.info["duration"] for frame in ImageSequence.Iterator(gif)) / 1000
    assert SECONDS / total == pytest.approx(FILM.speed, rel=0.1)


def test_an_mp4_plays_as_fast_as_its_caption_says(films):
    about = imageio.immeta(films / "film.mp4")
    assert about["size"] == FILM.size
    assert SECONDS / about["duration"] == pytest.approx(FILM.speed, rel=0.1)


def test_an_mp4_is_written_without_a_word(capfd, caplog, tmp_path):
    write_film(tmp_path / "film.mp4", recording_of(1, 0.3), default_scene(), episode_of("one"))
    assert capfd.readouterr() == ("", "")
    assert caplog.messages == []


def test_size_speed_and_camera_are_chosen(tmp_path):
    write_film(
        tmp_path / "film.mp4",
        recording_of(1, SECONDS),
        default_scene(),
        episode_of("one"),
        film_of("192x160", "2", "90,-60,1"),
    )
    about = imageio.immeta(tmp_path / "film.mp4")
    assert about["size"] == (192, 160)
    assert SECONDS / about["duration"] == pytest.approx(2, rel=0.1)


@pytest.mark.parametrize("size", ["480", "481x368", "16x16"])
def test_a_size_that_no_film_has_is_refused(size):
    with pytest.raises(SmashError, match="is not allowed"):
        film_of(size)


@pytest.mark.parametrize(
    "given",
    [
        (None, "0", None),
        (None, "nan", None),
        (None, None, "1,2"),
        (None, None, "0,10,1"),
        (None, None, "0,-10,inf"),
    ],
)
def test_a_film_that_cannot_be_is_refused_in_one_line(given):
    with pytest.raises(SmashError, match="is not allowed") as refusal:
        film_of(*given)
    assert "\n" not in str(refusal.value)


def test_the_caption_changes_with_the_action(films):
    frames = imageio.imread(films / "film.mp4").astype(int)
    strips = frames[:, -20:, : FILM.size[0] // 2]
    early, late = strips[1], strips[-1]
    assert np.abs(early - late).max() > 100
    assert np.abs(strips[0] - early).max() < 60
    assert frames[0, -20:].min() < 120


@pytest.mark.parametrize("interval", [0.02, 0.05, 0.08, 0.3])
def test_frames_are_evenly_apart_however_often_an_episode_was_recorded(interval):
    times = recording_of(1, 6.0, interval).times
    shown = np.array(times)[film_frames(times)]
    assert np.abs(shown - np.arange(len(shown)) * 0.32).max() <= interval / 2 + 1e-6
    assert shown[-1] > 6.0 - 0.32 - interval


def test_one_frame_is_a_film():
    assert film_frames([0.1]) == [0]


def test_what_is_done_is_said_from_its_beginning_on():
    episode = episode_of("one", ("topple", "s1", 2), ("pick", "b1", "s1"))
    episode.actions[0].begun, episode.actions[1].outcome = 0.1, "slipped"
    assert action_at(episode, 0.0) == ""
    assert action_at(episode, 0.1) == "1. topple s1 2"
    assert action_at(episode, 9.0) == "2. pick b1 s1: slipped"
