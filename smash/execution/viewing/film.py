"""Films of a recorded episode: its frames one after another, each with a caption."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np

from smash.execution.scene.tabletop import Tabletop
from smash.execution.viewing.painters import stage_class
from smash.execution.viewing.recording import Recording
from smash.execution.viewing.stage import CAMERA, Camera, Image
from smash.problem.errors import SmashError
from smash.records.episodes import Episode

CAPTION_HEIGHT = 28
FRAME_TIME = 80
"""[ms]: whole hundredths of a second, as a GIF stores it; 12.5 frames a second."""
GRAIN = 16
"""Width and height are multiples of this, as the codec of .mp4 wants [pixels]."""
SIZES = (160, 1920)
"""The least and the most of width and height [pixels]."""
SPEEDS = (0.25, 64.0)
"""The least and the most of speed."""


@dataclass(frozen=True, slots=True)
class Film:
    """How an episode is filmed.

    Attributes:
        size: Width and height with the caption [pixels].
        speed: It runs so many times as fast as simulated time.
        camera: Where it is filmed from.

    Raises:
        SmashError: where one of them is not allowed.
    """

    size: tuple[int, int] = (480, 368)
    speed: float = 4.0
    camera: Camera = CAMERA

    def __post_init__(self) -> None:
        """Refuse what cannot be filmed."""
        (least, most), words = SIZES, "x".join(map(str, self.size))
        if any(not least <= side <= most or side % GRAIN for side in self.size):
            raise SmashError(f"size of a film: {words} is not allowed; multiples of {GRAIN}, {least} to {most}")
        if not SPEEDS[0] <= self.speed <= SPEEDS[1]:
            raise SmashError(f"speed of a film: {self.speed:g} is not allowed; {SPEEDS[0]:g} to {SPEEDS[1]:g}")
        turned = -180.0 <= self.camera.yaw <= 360.0 and -89.0 <= self.camera.pitch <= 0.0
        if not turned or not 0.3 <= self.camera.distance <= 4.0:
            given = ",".join(f"{part:g}" for part in (self.camera.yaw, self.camera.pitch, self.camera.distance))
            allowed = "yaw -180 to 360 degrees, pitch -89 to 0 degrees, distance 0.3 to 4 m"
            raise SmashError(f"camera of a film: {given} is not allowed; {allowed}")


FILM = Film()


def film_of(size: str | None = None, speed: str | None = None, camera: str | None = None) -> Film:
    """Return how an episode is filmed, from words; as usual where there are none.

    Args:
        size: as in `480x368`.
        speed: as in `4`.
        camera: yaw, pitch and distance, as in `28,-40,1.45`.

    Raises:
        SmashError: where one of them is not allowed.
    """
    try:
        width, height = FILM.size if size is None else map(int, size.split("x"))
        view = CAMERA if camera is None else Camera(*map(float, camera.split(",", 2)))
        return Film((width, height), FILM.speed if speed is None else float(speed), view)
    except ValueError:
        words = " ".join(word for word in (size, speed, camera) if word is not None)
        raise SmashError(f"film: {words!r} is not allowed; like {'480x368'!r}, {'4'!r} and {'28,-40,1.45'!r}") from None


def write_film(path: Path, recording: Recording, tabletop: Tabletop, episode: Episode, film: Film = FILM) -> None:
    """Write an episode as a film, .mp4 or .gif, several times faster than it was; captions say when and what."""
    import imageio.v2 as imageio

    options: dict[str, Any] = {
        "fps": 1000 / FRAME_TIME,
        "ffmpeg_log_level": "quiet",
        "output_params": ["-preset", "veryfast"],
    }
    if path.suffix == ".gif":
        options = {"duration": FRAME_TIME, "loop": 0}
    writer: Any = imageio.get_writer(path, **options)
    with writer:
        for image in _images(recording, tabletop, episode, film):
            writer.append_data(image)


def film_frames(times: Sequence[float], speed: float = FILM.speed) -> list[int]:
    """The frames of a recording that are nearest to the moments of a film, which are evenly apart."""
    taken = np.asarray(times)
    moments = np.arange(taken[0], taken[-1] + 1e-6, speed * FRAME_TIME / 1000)
    return [int(frame) for frame in np.searchsorted((taken[1:] + taken[:-1]) / 2, moments)]


def _images(recording: Recording, tabletop: Tabletop, episode: Episode, film: Film) -> Iterator[Image]:
    width, height = film.size
    with stage_class()(tabletop, recording.names, len(recording.trays[0]), coarse=True) as stage:
        for frame in film_frames(recording.times, film.speed):
            stage.pose(recording, frame)
            moment = recording.times[frame]
            strip = _caption(action_at(episode, moment), f"{moment:.1f} s   {film.speed:g}x", width)
            yield np.concatenate([stage.photograph((width, height - CAPTION_HEIGHT), film.camera), strip])


def action_at(episode: Episode, moment: float) -> str:
    """What the robot is doing at a simulated time [s], in words."""
    begun = [row for row in episode.actions if row.begun <= moment + 1e-6]
    if not begun:
        return ""
    row = begun[-1]
    failed = "" if row.outcome == "done" else f": {row.outcome}"
    return f"{row.step}. {' '.join(map(str, row.action))}{failed}"


def _caption(left: str, right: str, width: int) -> Image:
    """A strip of a film's width [pixels] with words at both ends; those on the left are cut where they are too many."""
    from PIL import Image as Pillow
    from PIL import ImageDraw

    strip = Pillow.new("RGB", (width, CAPTION_HEIGHT), (244, 243, 240))
    pen, font = ImageDraw.Draw(strip), _font()
    edge, middle = 10, CAPTION_HEIGHT // 2
    left = _cut(" ".join(left.split()), font, width - 4 * edge - font.getlength(right))
    pen.text((edge, middle), left, (35, 38, 43), font, anchor="lm")
    pen.text((width - edge, middle), right, (95, 100, 108), font, anchor="rm")
    return np.asarray(strip)


def _cut(text: str, font: Any, room: float) -> str:
    """The text, or as much of its beginning as has room [pixels], and an ellipsis."""
    if font.getlength(text) <= room:
        return text
    lengths = (length for length in range(len(text)) if font.getlength(text[:length] + "…") > room)
    return text[: max(0, next(lengths, len(text)) - 1)] + "…"


@cache
def _font() -> Any:
    """Matplotlib's font, which knows many scripts; without matplotlib Pillow's own, which knows few letters."""
    from PIL import ImageFont

    try:
        from matplotlib import get_data_path
    except ImportError:
        return ImageFont.load_default(15)
    return ImageFont.truetype(f"{get_data_path()}/fonts/ttf/DejaVuSans.ttf", 14)
