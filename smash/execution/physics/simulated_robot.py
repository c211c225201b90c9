"""The robot as the simulator gets it: its URDF with boxes for fingers.

Bullet collides the fingers' meshes with a block by an iterative search that, once a pad is pressed into the block,
finds normals that point the wrong way: the fingers then stick to what they let go. Contacts of two boxes are exact.
"""

from __future__ import annotations

import xml.etree.ElementTree as ET
from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from functools import lru_cache
from pathlib import Path
from tempfile import TemporaryDirectory

import pinocchio

from smash.motion.robot import Hand, Robot


@contextmanager
def simulated_robot(robot: Robot) -> Iterator[Path]:
    """A URDF file for a simulator, for as long as the context is open."""
    with urdf_file(robot_text(robot)) as path:
        yield path


@contextmanager
def urdf_file(text: str) -> Iterator[Path]:
    """A file with this text, for as long as the context is open."""
    with TemporaryDirectory(prefix="smash-") as directory:
        path = Path(directory) / "robot.urdf"
        path.write_text(text, encoding="utf-8")
        yield path


@lru_cache(maxsize=16)
def robot_text(robot: Robot) -> str:
    """The same as text."""
    urdf = ET.fromstring(robot.urdf)
    for link in urdf.findall("link"):
        if link.get("name") in robot.hand.fingers:
            for shape in link.findall("collision"):
                link.remove(shape)
            link.append(_finger_box(robot.hand, robot.hand.fingers.index(link.get("name", ""))))
    return ET.tostring(urdf, encoding="unicode")


def _finger_box(hand: Hand, number: int) -> ET.Element:
    """The box that the collision checker takes a finger for, in the finger's frame."""
    centre, size = hand.finger.mean(axis=0), hand.finger[1] - hand.finger[0]
    side = (1.0, -1.0)[number]
    frame = hand.finger_places[number]
    turned = frame[:3, :3].T
    place = turned @ (centre * (1.0, side, 1.0) - frame[:3, 3])
    shape = ET.Element("collision")
    angles = pinocchio.rpy.matrixToRpy(turned)
    ET.SubElement(shape, "origin", rpy=_numbers(angles), xyz=_numbers(place))
    ET.SubElement(ET.SubElement(shape, "geometry"), "box", size=_numbers(size))
    return shape


def _numbers(values: Iterable[float]) -> str:
    return " ".join(f"{float(value) + 0.0:.6f}" for value in values)
