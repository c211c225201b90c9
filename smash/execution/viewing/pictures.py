"""Pictures and films of a recorded episode, drawn by PyBullet's software renderer in a connection of their own."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from functools import cache
from pathlib import Path
from types import TracebackType
from typing import Any, Self

import numpy as np
from numpy.typing import NDArray

from smash.execution.physics.world import ARM, FINGERS, connect
from smash.execution.scene.tabletop import Tabletop
from smash.execution.viewing.recording import Recording
from smash.problem.pictures import PALETTE
from smash.records.episodes import Episode

SIZE = (960, 640)
"""Width and height of a picture [pixels]."""
FILM_SIZE = (640, 432)
"""Of a film with its caption: multiples of 16, as its codec wants."""
CAPTION_HEIGHT = 28
SPEED_UP = 4
"""A film runs this much faster than simulated time."""
FRAME_TIME = 40
"""Of a film [ms]: whole hundredths of a second, as a GIF stores it."""
TRAY_COLOUR = (0.62, 0.47, 0.30)

Image = NDArray[np.uint8]


def block_colours(count: int) -> list[tuple[float, float, float]]:
    """Red, green, blue in 0..1 for each block, in order: the colours that it has in every other picture."""
    paints = [PALETTE[number % len(PALETTE)] for number in range(count)]
    return [(int(p[1:3], 16) / 255, int(p[3:5], 16) / 255, int(p[5:7], 16) / 255) for p in paints]


class Stage:
    """Robot, table, slots and blocks to be posed and photographed; use as a context manager."""

    def __init__(self, tabletop: Tabletop, blocks: int, carriers: int = 0) -> None:
        import pybullet_data

        self.client: Any = connect(gui=False)
        c = self.client
        c.setAdditionalSearchPath(pybullet_data.getDataPath())
        self.robot: int = c.loadURDF("franka_panda/panda.urdf", useFixedBase=True)
        self._box([0.85, 0.85, 0.01], [0, 0, -0.01], (0.90, 0.88, 0.84))
        half = tabletop.side / 2
        for slot in tabletop.slots:
            colour = (0.62, 0.70, 0.82) if slot.directions else (0.78, 0.78, 0.76)
            turn = c.getQuaternionFromEuler([0, 0, slot.angle])
            self._box([half * 1.15, half * 1.15, 0.0005], [slot.x, slot.y, 0.0005], colour, turn)
        self.blocks = [self._box([half] * 3, [0, 0, 0], colour) for colour in block_colours(blocks)]
        self.trays = [self._tray(tabletop) for _ in range(carriers)]

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.client.disconnect()

    def _box(
        self,
        half: Sequence[float],
        position: Sequence[float],
        colour: Sequence[float],
        turn: Sequence[float] = (0, 0, 0, 1),
    ) -> int:
        c = self.client
        shape = c.createVisualShape(c.GEOM_BOX, halfExtents=half, rgbaColor=[*colour, 1])
        return int(c.createMultiBody(0, -1, shape, position, turn))

    def _tray(self, tabletop: Tabletop) -> int:
        c = self.client
        assert tabletop.tray is not None
        centres, half = (array.tolist() for array in tabletop.tray.boxes)
        shape = c.createVisualShapeArray(
            shapeTypes=[c.GEOM_BOX] * len(half),
            halfExtents=half,
            visualFramePositions=centres,
            rgbaColors=[[*TRAY_COLOUR, 1]] * len(half),
        )
        return int(c.createMultiBody(0, -1, shape, [0, 0, 0]))

    def pose(self, recording: Recording, frame: int) -> None:
        """Move everything to where it was in a frame."""
        for joint, value in zip((*ARM, *FINGERS), recording.joints[frame], strict=True):
            self.client.resetJointState(self.robot, joint, float(value))
        moved = np.concatenate([recording.blocks[frame], recording.trays[frame]])
        for body, row in zip((*self.blocks, *self.trays), moved, strict=True):
            self.client.resetBasePositionAndOrientation(body, row[:3].tolist(), row[3:].tolist())

    def photograph(self, size: tuple[int, int]) -> Image:
        """A picture of the table, shape (height, width, 3)."""
        c, (width, height) = self.client, size
        view = c.computeViewMatrixFromYawPitchRoll([0.0, -0.02, 0.20], 1.45, 28.0, -40.0, 0.0, 2)
        lens = c.computeProjectionMatrixFOV(52.0, width / height, 0.1, 5.0)
        pixels = c.getCameraImage(
            width, height, view, lens, shadow=1, lightDirection=[0.6, 0.4, 1.4], renderer=c.ER_TINY_RENDERER
        )[2]
        return np.asarray(pixels, dtype=np.uint8).reshape(height, width, 4)[:, :, :3]


def write_stills(path: Path, recording: Recording, tabletop: Tabletop, moments: Sequence[tuple[str, float]]) -> None:
    """Draw several moments of an episode side by side, each with its caption.

    Args:
        path: A picture file.
        recording: The episode.
        tabletop: Its scene.
        moments: Caption and simulated time [s] of each picture.
    """
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure

    figure = Figure(figsize=(4.8 * len(moments), 3.5), layout="constrained")
    FigureCanvasAgg(figure)
    axes = figure.subplots(1, len(moments), squeeze=False)[0]
    with Stage(tabletop, len(recording.blocks[0]), len(recording.trays[0])) as stage:
        for axis, (caption, moment) in zip(axes, moments, strict=True):
            stage.pose(recording, recording.at(moment))
            axis.imshow(stage.photograph(SIZE))
            axis.set_title(caption)
            axis.set_axis_off()
    figure.savefig(path, dpi=150)


def write_film(path: Path, recording: Recording, tabletop: Tabletop, episode: Episode) -> None:
    """Write an episode as a film, .mp4 or .gif, several times faster than it was; captions say when and what."""
    import imageio.v2 as imageio

    options: dict[str, Any] = {"fps": 1000 / FRAME_TIME, "ffmpeg_log_level": "quiet"}
    if path.suffix == ".gif":
        options = {"duration": FRAME_TIME, "loop": 0}
    writer: Any = imageio.get_writer(path, **options)
    with writer:
        for image in _images(recording, tabletop, episode):
            writer.append_data(image)


def film_frames(times: Sequence[float]) -> list[int]:
    """The frames of a recording that are nearest to the moments of a film, which are evenly apart."""
    taken = np.asarray(times)
    moments = np.arange(taken[0], taken[-1] + 1e-6, SPEED_UP * FRAME_TIME / 1000)
    return [int(frame) for frame in np.searchsorted((taken[1:] + taken[:-1]) / 2, moments)]


def _images(recording: Recording, tabletop: Tabletop, episode: Episode) -> Iterator[Image]:
    width, height = FILM_SIZE
    with Stage(tabletop, len(recording.blocks[0]), len(recording.trays[0])) as stage:
        for frame in film_frames(recording.times):
            stage.pose(recording, frame)
            moment = recording.times[frame]
            strip = _caption(action_at(episode, moment), f"{moment:.1f} s   {SPEED_UP}x")
            yield np.concatenate([stage.photograph((width, height - CAPTION_HEIGHT)), strip])


def action_at(episode: Episode, moment: float) -> str:
    """What the robot is doing at a simulated time [s], in words."""
    begun = [row for row in episode.actions if row.begun <= moment + 1e-6]
    if not begun:
        return ""
    row = begun[-1]
    failed = "" if row.outcome == "done" else f": {row.outcome}"
    return f"{row.step}. {' '.join(map(str, row.action))}{failed}"


def _caption(left: str, right: str) -> Image:
    """A strip of a film's width with words at both ends; those on the left are cut where they are too many."""
    from PIL import Image as Pillow
    from PIL import ImageDraw

    strip = Pillow.new("RGB", (FILM_SIZE[0], CAPTION_HEIGHT), (244, 243, 240))
    pen, font = ImageDraw.Draw(strip), _font()
    edge, middle = 10, CAPTION_HEIGHT // 2
    left = _cut(" ".join(left.split()), font, FILM_SIZE[0] - 4 * edge - font.getlength(right))
    pen.text((edge, middle), left, (35, 38, 43), font, anchor="lm")
    pen.text((FILM_SIZE[0] - edge, middle), right, (95, 100, 108), font, anchor="rm")
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
