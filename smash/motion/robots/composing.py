"""One URDF of an arm's and a hand's: the arm's links from base to flange, a fixed joint, the hand, the tool's frame.

Of the arm only the way from base to flange is taken, of the hand everything; what is only to be looked at (`visual`)
is left out of both. Meshes are named by absolute paths, so that every reader finds them.
"""

from __future__ import annotations

import xml.etree.ElementTree as ET
from collections.abc import Iterable
from copy import deepcopy
from math import pi
from pathlib import Path

from smash.motion.robots.files import PlaceFile, RobotFile
from smash.problem.errors import MalformedFile
from smash.problem.files.documents import read_text

TOOL = "smash_tool"
"""The link that stands for the tool's frame."""
MOUNT = "smash_mount"
"""The joint between flange and hand."""
MESHES = (".obj", ".stl")
"""Kinds of meshes that all readers of a robot have in common."""


class Urdf:
    """A URDF file as a tree.

    Args:
        path: The file.

    Attributes:
        root: The `robot` element.
        links: Its links by name.
        joints: Its joints by name.

    Raises:
        MalformedFile: where it is no URDF, or a mesh that something collides by is not there.
    """

    def __init__(self, path: Path) -> None:
        self.path = path
        try:
            self.root = ET.fromstring(read_text(path))
        except ET.ParseError as error:
            raise MalformedFile(str(path), f"not XML: {error}") from None
        if self.root.tag != "robot":
            raise MalformedFile(str(path), f"not a URDF: its root is `{self.root.tag}`, not `robot`")
        self.links = {link.get("name", ""): link for link in self.root.findall("link")}
        self.joints = {joint.get("name", ""): joint for joint in self.root.findall("joint")}
        for joint in self.joints.values():
            if joint.find("parent") is None or joint.find("child") is None:
                raise MalformedFile(str(path), f"joint {joint.get('name')!r} has no parent or no child")

    def link(self, name: str, key: str, where: str) -> ET.Element:
        """Return a link that a robot or hand file names.

        Raises:
            MalformedFile: where there is none of that name.
        """
        if name not in self.links:
            raise MalformedFile(where, f"`{key}`: {self.path} has no link {name!r}")
        return self.links[name]

    def way(self, base: str, flange: str, where: str) -> list[ET.Element]:
        """Return the joints from one link to another, in order.

        Raises:
            MalformedFile: where none leads there.
        """
        above = {_end(joint, "child"): joint for joint in self.joints.values()}
        joints: list[ET.Element] = []
        link = flange
        while link != base:
            if link not in above or len(joints) > len(above):
                raise MalformedFile(where, f"`arm.flange`: {flange!r} does not hang on {base!r} in {self.path}")
            joints.append(above[link])
            link = _end(above[link], "parent")
        return joints[::-1]

    def below(self, root: str) -> tuple[list[ET.Element], list[ET.Element]]:
        """Return the links and the joints of the tree that hangs on a link, as they stand in the file."""
        names, size = {root}, 0
        while size < len(names):
            size = len(names)
            names |= {_end(joint, "child") for joint in self.joints.values() if _end(joint, "parent") in names}
        links = [link for name, link in self.links.items() if name in names]
        return links, [joint for joint in self.joints.values() if _end(joint, "parent") in names]

    def stripped(self, link: ET.Element) -> ET.Element:
        """Return a copy of a link as simulators get it.

        Raises:
            MalformedFile: where a mesh is missing, or of a kind that not every reader knows.
        """
        copy = deepcopy(link)
        for part in copy.findall("visual"):
            copy.remove(part)
        if copy.find("inertial") is None:
            copy.insert(0, _massless())
        for mesh in copy.iter("mesh"):
            mesh.set("filename", str(self._mesh(mesh.get("filename", ""), link.get("name", ""))))
        return copy

    def _mesh(self, name: str, link: str) -> Path:
        """The mesh that a URDF names: absolute, beside the file, or in a package that the file lies in."""
        rest = name.removeprefix("file://")
        folders = [self.path.parent]
        if name.startswith("package://"):
            rest = name.removeprefix("package://")
            package, _, inside = rest.partition("/")
            folders += [folder.parent for folder in self.path.parents if folder.name == package and inside]
        for folder in folders:
            if (folder / rest).is_file():
                if Path(rest).suffix.lower() not in MESHES:
                    problem = f"the mesh {name!r} of link {link!r}: {' and '.join(MESHES)} are allowed"
                    raise MalformedFile(str(self.path), problem)
                return (folder / rest).resolve()
        raise MalformedFile(str(self.path), f"the mesh {name!r} of link {link!r} is not there")


def compose(file: RobotFile, where: str, arm: Urdf, hand: Urdf, hand_root: str, tool: PlaceFile) -> ET.Element:
    """Return one URDF of arm and hand.

    Args:
        file: The robot file.
        where: Its path.
        arm: The arm's URDF.
        hand: The hand's.
        hand_root: The hand's root link.
        tool: The tool's frame in it.

    Raises:
        MalformedFile: where the two do not go together.
    """
    arm.link(file.arm.base, "arm.base", where)
    arm.link(file.arm.flange, "arm.flange", where)
    joints = arm.way(file.arm.base, file.arm.flange, where)
    robot = ET.Element("robot", name=file.name)
    robot.append(arm.stripped(arm.links[file.arm.base]))
    for joint in joints:
        robot.append(arm.stripped(arm.links[_end(joint, "child")]))
        robot.append(_turning(joint))
    names = [part.get("name", "") for part in robot]
    hand_links, hand_joints = hand.below(hand_root)
    for part in (*hand_links, *hand_joints):
        if part.get("name") in names:
            problem = f"arm and hand both have a {part.tag} {part.get('name')!r}; rename it in one of their URDFs"
            raise MalformedFile(where, problem)
    robot.append(_fixed(MOUNT, file.arm.flange, hand_root, file.mount))
    robot.extend([*map(hand.stripped, hand_links), *map(deepcopy, hand_joints)])
    robot.append(ET.Element("link", name=TOOL))
    robot[-1].append(_massless())
    robot.append(_fixed(f"{TOOL}_mount", hand_root, TOOL, tool))
    _refuse_twins(robot, where)
    return robot


def _refuse_twins(robot: ET.Element, where: str) -> None:
    """Two meshes of one name in different folders would be one mesh to MuJoCo."""
    known: dict[str, str] = {}
    for mesh in robot.iter("mesh"):
        path = mesh.get("filename", "")
        other = known.setdefault(Path(path).stem, path)
        if other != path:
            raise MalformedFile(where, f"two meshes are called {Path(path).stem!r} ({other}, {path}); rename one")


def _turning(joint: ET.Element) -> ET.Element:
    """A copy of a joint of the arm; one that turns without end gets an end after a turn."""
    copy = deepcopy(joint)
    if copy.get("type") == "continuous":
        copy.set("type", "revolute")
        limit = copy.find("limit")
        if limit is None:
            limit = ET.SubElement(copy, "limit", effort="0", velocity="0")
        limit.set("lower", repr(-2 * pi))
        limit.set("upper", repr(2 * pi))
    return copy


def _fixed(name: str, parent: str, child: str, place: PlaceFile) -> ET.Element:
    joint = ET.Element("joint", name=name, type="fixed")
    ET.SubElement(joint, "parent", link=parent)
    ET.SubElement(joint, "child", link=child)
    ET.SubElement(joint, "origin", rpy=_numbers(place.rpy), xyz=_numbers(place.xyz))
    return joint


def _massless() -> ET.Element:
    """What a link without a body has; without it PyBullet would take it to weigh a kilogram."""
    inertial = ET.Element("inertial")
    ET.SubElement(inertial, "origin", rpy="0 0 0", xyz="0 0 0")
    ET.SubElement(inertial, "mass", value="0.0")
    ET.SubElement(inertial, "inertia", ixx="0.1", ixy="0", ixz="0", iyy="0.1", iyz="0", izz="0.1")
    return inertial


def _numbers(values: Iterable[float]) -> str:
    return " ".join(f"{value:.12g}" for value in values)


def child_of(urdf: ET.Element, joint: str) -> str:
    """Return the link that a joint moves."""
    found = urdf.find(f"joint[@name='{joint}']")
    return "" if found is None else _end(found, "child")


def _end(joint: ET.Element, which: str) -> str:
    end = joint.find(which)
    return "" if end is None else end.get("link", "")
