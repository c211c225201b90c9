"""A recorded episode as one HTML page that plays it in 3D: no library, no network, nothing outside the file."""

from __future__ import annotations

import base64
import html
import json
import re
from collections.abc import Mapping
from functools import cache
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from smash.execution.episode import Episode
from smash.execution.pictures import block_colours
from smash.execution.recording import Recording
from smash.execution.robot import panda_urdf
from smash.execution.tabletop import Tabletop
from smash.problem.documents import write_text

TEMPLATE = Path(__file__).parent / "replay.html"
MESHES = ("link0", *(f"link{number}" for number in range(1, 8)), "hand", "finger", "finger")
"""Mesh of each drawn part: base, the arm's links, hand, left and right finger."""


def write_replay(path: Path, recording: Recording, tabletop: Tabletop, episode: Episode, blocks: list[str]) -> None:
    """Write the page.

    Args:
        path: Where to.
        recording: The frames.
        tabletop: The scene.
        episode: What was done, for captions.
        blocks: Names of the blocks, in the recording's order.
    """
    scene: dict[str, Any] = {
        "side": tabletop.side,
        "slots": [[slot.x, slot.y, slot.angle, bool(slot.directions)] for slot in tabletop.slots],
        "blocks": blocks,
        "colours": block_colours(len(blocks)),
        "meshes": [_packed(_mesh(name)) for name in MESHES],
        "times": _packed(np.array(recording.times)),
        "links": _packed(np.array(recording.links)),
        "poses": _packed(np.array(recording.blocks)),
        "carriers": len(recording.trays[0]),
        "tray": [] if tabletop.tray is None else np.hstack(tabletop.tray.boxes).tolist(),
        "trays": _packed(np.array(recording.trays)),
        "actions": [
            {"begun": row.begun, "text": " ".join(map(str, row.action)), "origin": row.origin, "outcome": row.outcome}
            for row in episode.actions
        ],
        "result": "success" if episode.failure is None else f"{episode.failure.name}: {episode.failure.reason}",
    }
    title = html.escape(f"{episode.instance} · {episode.planner} · seed {episode.seed}")
    data = json.dumps(scene).replace("<", "\\u003c")
    write_text(path, _filled(TEMPLATE.read_text(encoding="utf-8"), {"title": title, "data": data}))


def _filled(template: str, values: Mapping[str, str]) -> str:
    """The template with each `{{key}}` replaced, in one pass: what is put in is not looked at again."""
    return re.sub(r"\{\{(\w+)\}\}", lambda found: values[found[1]], template)


def _packed(values: NDArray[np.float64]) -> str:
    return base64.b64encode(np.ascontiguousarray(values, dtype="<f4").tobytes()).decode("ascii")


@cache
def _mesh(name: str) -> NDArray[np.float64]:
    """Triangles of a collision mesh, shape (T, 9) [m]."""
    vertices: list[list[float]] = []
    triangles: list[list[float]] = []
    for line in (panda_urdf().parent / "meshes" / "collision" / f"{name}.obj").read_text().splitlines():
        parts = line.split()
        if parts[:1] == ["v"]:
            vertices.append([float(value) for value in parts[1:4]])
        elif parts[:1] == ["f"]:
            corners = [vertices[int(part.split("/")[0]) - 1] for part in parts[1:]]
            triangles += [[*corners[0], *second, *third] for second, third in pairwise(corners[1:])]
    return np.array(triangles)
