"""Stills of a recorded episode."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from smash.execution.scene.tabletop import Tabletop
from smash.execution.viewing.painters import stage_class
from smash.execution.viewing.recording import Recording

SIZE = (720, 600)
"""Width and height of a picture [pixels]."""


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

    figure = Figure(figsize=(3.6 * len(moments), 3.25), layout="constrained")
    FigureCanvasAgg(figure)
    axes = figure.subplots(1, len(moments), squeeze=False)[0]
    with stage_class()(tabletop, recording.names, len(recording.trays[0])) as stage:
        for axis, (caption, moment) in zip(axes, moments, strict=True):
            stage.pose(recording, recording.at(moment))
            axis.imshow(stage.photograph(SIZE))
            axis.set_title(caption)
            axis.set_axis_off()
    figure.savefig(path, dpi=150)
