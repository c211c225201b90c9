"""A plan as pebbles that move on the gadget: an animated GIF, or a strip of frames."""

from __future__ import annotations

from collections import Counter
from collections.abc import Collection, Iterator, Sequence
from itertools import zip_longest
from pathlib import Path
from typing import TYPE_CHECKING, Any

from smash.gadget.decode import step_actions
from smash.gadget.drawing.figure import SCALE, frame, paint_gadget, vertical_extent
from smash.gadget.drawing.layout import DECK, Layout, Point, lay_out
from smash.gadget.drawing.style import BLUE, RADIUS, new_figure
from smash.gadget.elements import NodeKind
from smash.gadget.motion import PebbleMotion
from smash.problem.errors import MalformedFile
from smash.problem.model import Action, Instance, Pick, Place, State
from smash.problem.pictures import INK, block_colours, ink_on, short
from smash.problem.rules import Law

if TYPE_CHECKING:
    from matplotlib.artist import Artist
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

BETWEEN = 5
"""Animation frames from one layer to the next."""
REST = 3
"""Animation frames that rest at a layer after an action."""
MOST_FRAMES = 12
"""Frames of a strip."""


def motion_figure(motion: PebbleMotion, instance: Instance) -> Figure:
    """Return a figure of a motion of `instance`: a strip of frames.

    Raises:
        MissingExtra: where matplotlib is not installed.
    """
    return _strip(motion, step_captions(motion, instance))


def write_animation(motion: PebbleMotion, instance: Instance, path: Path) -> None:
    """Write a motion of `instance` as an animated GIF.

    Raises:
        SmashError: where matplotlib is not installed or the file cannot be written.
    """
    _animate(motion, step_captions(motion, instance), path)


def step_captions(motion: PebbleMotion, instance: Instance) -> list[str]:
    """Return the actions of each step in words; an empty text where there is none."""
    law, state = Law(instance), State.start_of(instance)
    captions = []
    for step in range(motion.steps):
        actions = step_actions(motion, step, state)
        for action in actions:
            law.apply(state, action)
        captions.append(", ".join(_words(actions)))
    return captions


def _words(actions: Sequence[Action]) -> Iterator[str]:
    for action, following in zip_longest(actions, actions[1:]):
        if isinstance(action, Pick) and isinstance(following, Place):
            yield f"{short(action.block, 8)}: {short(action.source, 9)} → {short(following.target, 9)}"
        elif not isinstance(action, Pick | Place):
            yield short(str(action).replace("'", ""), 40)


def places(motion: PebbleMotion, layout: Layout, layer: int) -> list[Point]:
    """Return where each block is drawn at a layer, then each token; blocks in one node stand beside each other."""
    nodes = motion.gadget.nodes
    blocks = motion.layers[layer][: len(motion.blocks)]
    held = Counter(blocks)
    seen: Counter[int] = Counter()
    points = []
    for number in blocks:
        x, y = layout.nodes[number]
        place = seen[number]
        seen[number] += 1
        if nodes[number].kind is NodeKind.TABLE and layout.bar is not None:
            pitch = min(2.2 * RADIUS, (layout.bar[1] - layout.bar[0] - 1.0) / max(1, len(motion.blocks)))
            x = layout.bar[0] + 0.6 + place * pitch
        elif nodes[number].kind is NodeKind.TOPPLE:
            y += min(0.62, layout.crest / max(1, held[number] - 1)) * place
        elif nodes[number].kind is NodeKind.CARRIER:
            x += min(2.2 * RADIUS, 2 * (DECK - RADIUS) / max(1, held[number] - 1)) * (place - (held[number] - 1) / 2)
        points.append((x, y))
    return points + [layout.nodes[number] for number in motion.layers[layer][len(motion.blocks) :]]


def _paint_pebbles(axes: Axes, motion: PebbleMotion, points: Sequence[Point]) -> list[Artist]:
    from matplotlib.patches import Circle, FancyBboxPatch

    colours = block_colours(motion.blocks)
    artists: list[Artist] = []
    for x, y in points[len(motion.blocks) :]:
        corner, shape = (x - DECK, y - RADIUS), "round,pad=0,rounding_size=0.1"
        box = FancyBboxPatch(corner, 2 * DECK, 2 * RADIUS, boxstyle=shape, fc="none", ec=BLUE, lw=2.0, zorder=4)
        artists.append(axes.add_patch(box))
    for block, (x, y) in zip(motion.blocks, points, strict=False):
        pebble = Circle((x, y), RADIUS * 0.94, facecolor=colours[block], edgecolor="white", linewidth=0.8, zorder=5)
        artists.append(axes.add_patch(pebble))
        size = 7.0 if len(short(block)) <= 2 else 5.5
        artists.append(
            axes.text(
                x,
                y,
                short(block),
                ha="center",
                va="center_baseline",
                fontsize=size,
                color=ink_on(colours[block]),
                zorder=6,
                parse_math=False,
            )
        )
    return artists


def strip_layers(captions: Sequence[str], staged: Collection[int] = ()) -> list[int]:
    """Return the layers that a strip shows, at most `MOST_FRAMES`.

    They are the start, the layers in `staged` (with the blocks staged for an activation), what follows each action,
    and the end.
    """
    after = {step + 1 for step, caption in enumerate(captions) if caption}
    chosen = sorted({0, len(captions)} | set(staged) | after)
    if len(chosen) <= MOST_FRAMES:
        return chosen
    return [chosen[round(index * (len(chosen) - 1) / (MOST_FRAMES - 1))] for index in range(MOST_FRAMES)]


def _strip(motion: PebbleMotion, captions: list[str]) -> Figure:
    layout = lay_out(motion.gadget)
    low, high = vertical_extent(motion.gadget, layout)
    wide, tall = SCALE * (layout.right - layout.left + 2.6), SCALE * (high - low) + 0.3
    staging = motion.gadget.staging
    layers = strip_layers(captions, [step for step in range(motion.steps) if motion.active_in(step) in staging])
    columns = min(len(layers), 3 if wide < 5 else 2)
    rows = -(-len(layers) // columns)
    figure = new_figure(columns * wide, rows * tall)
    for index, layer in enumerate(layers):
        row, column = divmod(index, columns)
        share = 1 - 0.3 / tall
        axes = figure.add_axes((column / columns, 1 - (row + 1) / rows, 0.97 / columns, share / rows))
        paint_gadget(axes, motion.gadget, layout, faint=True)
        frame(axes, motion.gadget, layout)
        _paint_pebbles(axes, motion, places(motion, layout, layer))
        figure.text(
            (column + 0.03) / columns, 1 - (row + 0.25 / tall) / rows, _title(captions, layer),
            fontsize=9, color=INK, va="bottom", parse_math=False,
        )  # fmt: skip
    return figure


def _title(captions: Sequence[str], layer: int) -> str:
    if layer == 0:
        return "t = 0   start"
    return f"t = {layer}   {captions[layer - 1] or ('settled' if layer == len(captions) else 'staged')}"


def _animate(motion: PebbleMotion, captions: list[str], path: Path) -> None:
    layout = lay_out(motion.gadget)
    low, high = vertical_extent(motion.gadget, layout)
    wide, tall = SCALE * (layout.right - layout.left + 2.6), SCALE * (high - low) + 0.3
    figure = new_figure(wide, tall)
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from PIL import Image

    figure.set_dpi(min(130.0, 1600 / wide))
    canvas: Any = FigureCanvasAgg(figure)
    axes = figure.add_axes((0, 0, 1, 1 - 0.3 / tall))
    paint_gadget(axes, motion.gadget, layout, faint=True)
    frame(axes, motion.gadget, layout)
    canvas.draw()
    ground = canvas.copy_from_bbox(figure.bbox)
    images = []
    for points, title in _frames(motion, layout, captions):
        canvas.restore_region(ground)
        artists = _paint_pebbles(axes, motion, points)
        artists.append(figure.text(0.03, 1 - 0.25 / tall, title, fontsize=9, color=INK, va="bottom", parse_math=False))
        for artist in artists:
            artist.draw(canvas.get_renderer())
            artist.remove()
        picture = Image.frombytes("RGBA", canvas.get_width_height(), bytes(canvas.buffer_rgba()))
        images.append(picture.convert("RGB").quantize(128))
    try:
        images[0].save(path, save_all=True, append_images=images[1:], duration=80, loop=0)
    except OSError as error:
        raise MalformedFile(str(path), f"cannot be written: {error.strerror}") from None


def _frames(motion: PebbleMotion, layout: Layout, captions: Sequence[str]) -> Iterator[tuple[list[Point], str]]:
    """Yield the pebbles' places and the title of every animation frame."""
    here = places(motion, layout, 0)
    yield from [(here, _title(captions, 0))] * (3 * REST)
    for step, caption in enumerate(captions):
        there = places(motion, layout, step + 1)
        title = f"t = {step + 1}   {caption}"
        for part in range(1, BETWEEN + 1):
            share = part / BETWEEN
            yield (
                [(x + share * (u - x), y + share * (v - y)) for (x, y), (u, v) in zip(here, there, strict=True)],
                title,
            )
        if caption:
            yield from [(there, title)] * REST
        here = there
    yield from [(here, f"t = {motion.steps}   settled")] * (5 * REST)
