"""A recorded episode as one HTML page that plays it in 3D: no library, no network, nothing outside the file."""

from __future__ import annotations

import base64
import html
import json
import re
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from smash.execution.scene.tabletop import Tabletop
from smash.execution.viewing.recording import Recording
from smash.execution.viewing.stage import block_colours
from smash.motion.robots import load_robot
from smash.motion.robots.meshes import drawn_parts
from smash.problem.files.documents import write_text
from smash.problem.model import Goal, Instance, OnGoal, PositionsGoal, StacksGoal, no_goal
from smash.records.episodes import Episode

TEMPLATE = Path(__file__).parent / "replay.html"
POSE_UNIT = 0.00006
"""Of positions [m] and of quaternions: what lies further away than 1.97 m is shown there."""
BESIDE = 0.02
"""The name of a location stands on the table, this far beyond what marks its place [m]."""


def write_replay(path: Path, recording: Recording, tabletop: Tabletop, episode: Episode, instance: Instance) -> None:
    """Write the page.

    Args:
        path: Where to.
        recording: The frames.
        tabletop: The scene.
        episode: What was done, for captions.
        instance: What was to be done: the names of blocks, in the recording's order, and of locations, and the goal.
    """
    scene: dict[str, Any] = {
        "side": tabletop.widest,
        "sizes": [tabletop.size(block).edges for block in instance.blocks],
        "slots": [
            [slot.x, slot.y, slot.angle, number < len(tabletop.stacks)] for number, slot in enumerate(tabletop.slots)
        ],
        "places": _places(tabletop, instance),
        "blocks": instance.blocks,
        "colours": block_colours(len(instance.blocks)),
        "meshes": [_packed(part) for part in drawn_parts(load_robot(tabletop.robot))],
        "times": _packed(np.array(recording.times)),
        "links": _poses(recording.links),
        "poses": _poses(recording.blocks),
        "carriers": len(recording.trays[0]),
        "tray": [] if tabletop.tray is None else np.hstack(tabletop.tray.boxes).tolist(),
        "trays": _poses(recording.trays),
        "unit": POSE_UNIT,
        "touched": recording.touched,
        "actions": [
            {
                "begun": row.begun,
                "text": " ".join(map(str, row.action)),
                "origin": row.origin,
                "outcome": row.outcome,
                "gap": row.gap,
            }
            for row in episode.actions
        ],
        "goal": goal_in_words(instance.goal),
        "result": "success" if episode.failure is None else f"{episode.failure.name}: {episode.failure.reason}",
    }
    title = html.escape(f"{episode.instance} · {episode.planner} · seed {episode.seed} · {episode.engine}")
    data = json.dumps(scene).replace("<", "\\u003c")
    write_text(path, _filled(TEMPLATE.read_text(encoding="utf-8"), {"title": title, "data": data}))


def goal_in_words(goal: Goal) -> str:
    """What a goal asks, in one line."""
    match goal:
        case OnGoal():
            asked = [f"{upper} on {under}" for upper, under in goal.on.items()]
            asked += [f"{block} at the bottom" for block in goal.bottom]
            asked += [f"{block} on the table" for block in goal.ontable]
            asked += [f"{block} clear" for block in goal.clear]
            return "; ".join(asked) or "nothing"
        case PositionsGoal():
            piles, rest = goal.stacks(), "bottom first, other blocks anywhere"
        case StacksGoal():
            piles, rest = {name: pile for name, pile in goal.stacks.items() if pile}, "bottom first"
        case _:
            no_goal(goal)
    named = "; ".join(f"{location} = {' '.join(pile)}" for location, pile in piles.items())
    return f"{named} ({rest})" if named else "nothing"


def _places(tabletop: Tabletop, instance: Instance) -> list[tuple[str, float, float]]:
    """Name and place on the table [m] of what to call each location and station of the instance."""
    deep = 0.0 if tabletop.tray is None else tabletop.tray.size[1]
    named = [(name, slot, tabletop.widest) for name, slot in tabletop.bind(instance).items()]
    named += [(name, slot, deep) for name, slot in tabletop.bind_stations(instance).items()]
    return [(name, *slot.point(depth / 2 + BESIDE, 0.0, "outward")) for name, slot, depth in named]


def _filled(template: str, values: Mapping[str, str]) -> str:
    """The template with each `{{key}}` replaced, in one pass: what is put in is not looked at again."""
    return re.sub(r"\{\{(\w+)\}\}", lambda found: values[found[1]], template)


def _packed(values: NDArray[np.float64]) -> str:
    return base64.b64encode(np.ascontiguousarray(values, dtype="<f4").tobytes()).decode("ascii")


def _poses(frames: Sequence[NDArray[np.float64]]) -> str:
    """Positions and quaternions of all frames in 16 bits each, a twentieth of a millimetre: half of the page's size."""
    numbers = np.clip(np.rint(np.array(frames) / POSE_UNIT), -32767, 32767)
    return base64.b64encode(np.ascontiguousarray(numbers, dtype="<i2").tobytes()).decode("ascii")
