"""The Panda as the simulator gets it: the shipped URDF with boxes for fingers.

Bullet collides the fingers' meshes with a block by an iterative search that, once a pad is pressed into the block,
finds normals that point the wrong way: the fingers then stick to what they let go. Contacts of two boxes are exact.
"""

from __future__ import annotations

import xml.etree.ElementTree as ET
from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from functools import cache
from pathlib import Path
from tempfile import TemporaryDirectory

from smash.motion.collision import FINGER_CORNERS, FINGER_JOINT_Z
from smash.motion.robot import panda_urdf

FINGER_SIDES = {"panda_leftfinger": 1.0, "panda_rightfinger": -1.0}
"""The fingers' links, and to which side of the hand's middle each lies along its y axis."""


@contextmanager
def simulated_panda() -> Iterator[Path]:
    """A URDF file for a simulator, for as long as the context is open."""
    with TemporaryDirectory(prefix="smash-") as directory:
        path = Path(directory) / "panda.urdf"
        path.write_text(panda_text(), encoding="utf-8")
        yield path


@cache
def panda_text() -> str:
    """The same as text; its meshes are named by absolute paths."""
    shipped = panda_urdf()
    # Meshes are named relative to the shipped file; the copy lies elsewhere.
    robot = ET.fromstring(shipped.read_text(encoding="utf-8").replace("package://", f"{shipped.parent}/"))
    for link in robot.findall("link"):
        side = FINGER_SIDES.get(link.get("name", ""))
        if side is not None:
            for shape in link.findall("collision"):
                link.remove(shape)
            link.append(_finger_box(side))
    return ET.tostring(robot, encoding="unicode")


def _finger_box(side: float) -> ET.Element:
    """The box that the collision checker takes a finger for, in the finger's frame."""
    centre, size = FINGER_CORNERS.mean(axis=0), FINGER_CORNERS[1] - FINGER_CORNERS[0]
    place = (centre[0], side * centre[1], centre[2] - FINGER_JOINT_Z)
    shape = ET.Element("collision")
    ET.SubElement(shape, "origin", rpy="0 0 0", xyz=_numbers(place))
    ET.SubElement(ET.SubElement(shape, "geometry"), "box", size=_numbers(size))
    return shape


def _numbers(values: Iterable[float]) -> str:
    return " ".join(f"{float(value):.6f}" for value in values)
