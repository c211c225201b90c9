"""From a robot file to a `Robot`: what it names is read, put together and checked."""

from __future__ import annotations

import os
import xml.etree.ElementTree as ET
from collections.abc import Iterable
from collections.abc import Set as AbstractSet
from functools import cache
from hashlib import sha256
from pathlib import Path
from typing import Any

import numpy as np
import pinocchio
from numpy.typing import NDArray

from smash.motion.poses import Matrix, Vector
from smash.motion.quiet import first_complaint, overheard
from smash.motion.robot import HAND, SHIPPED, Hand, Robot
from smash.motion.robots.composing import TOOL, Urdf, child_of, compose, number
from smash.motion.robots.files import LEVEL, HandFile, PlaceFile, RobotFile, read_hand_file, read_robot_file
from smash.problem.errors import MalformedFile, SmashError

DEFAULT_ROBOT = SHIPPED
"""The robot that is used where none is named."""
FOLDER = Path(__file__).parent
STRAIGHT = 1e-6
"""Fingers open along the tool's y axis within this, as a share."""
MOST_LOADED = 16
"""Robots from outside that are kept, each with its meshes."""
_LOADED: dict[Path, tuple[Robot, tuple[tuple[int, int] | None, ...]]] = {}
"""Them by their paths, each with the stamps of its files when it was read; the last one that was read stands last."""
COARSE, FINE = 0.025, 0.010
"""How far spheres stand out at the base and at the last link where a file does not say it [m]."""


def robot_names() -> tuple[str, ...]:
    """Return the names of the robots that are shipped."""
    return tuple(sorted(path.stem for path in FOLDER.glob("*.toml") if not path.stem.endswith("-hand")))


def load_robot(robot: str | os.PathLike[str] | None = None) -> Robot:
    """Return a robot; the same object whenever the same one is asked for in this process, until its files change.

    Its files are those that `Robot.files` names: an arm whose URDF, meshes or spheres are others is another arm.

    Args:
        robot: the name of a shipped one, or the path of a robot file, which ends in `.toml`; None for the default one.

    Raises:
        MalformedFile: where a file is not what its format says, or what it names is missing.
        SmashError: where there is none of that name.
    """
    path = _path_of(robot)
    if path.parent == FOLDER:
        return _shipped(path)
    known = _LOADED.get(path)
    if known is not None and known[1] == _stamps(known[0].files):
        return known[0]
    loaded = _load(path)
    _LOADED.pop(path, None)
    _LOADED[path] = loaded, _stamps(loaded.files)
    if len(_LOADED) > MOST_LOADED:
        del _LOADED[next(iter(_LOADED))]
    return loaded


def _stamps(files: Iterable[Path]) -> tuple[tuple[int, int] | None, ...]:
    """When each file was written last [ns], and how long it is; None where it is not there."""
    stamps: list[tuple[int, int] | None] = []
    for file in files:
        try:
            found = file.stat()
        except OSError:
            stamps.append(None)
        else:
            stamps.append((found.st_mtime_ns, found.st_size))
    return tuple(stamps)


def _path_of(robot: str | os.PathLike[str] | None) -> Path:
    named = DEFAULT_ROBOT if robot is None else os.fspath(robot)
    if named in robot_names():
        return FOLDER / f"{named}.toml"
    if not named.endswith(".toml"):
        known = ", ".join(robot_names())
        raise SmashError(f"robot: there is none called {named!r}; {known}, or the path of a robot file (.toml)")
    return Path(named).absolute()


@cache
def _shipped(path: Path) -> Robot:
    return _load(path)


def _load(path: Path) -> Robot:
    where = str(path)
    file = read_robot_file(path)
    if path.parent != FOLDER and file.name in robot_names():
        raise MalformedFile(where, f"`name`: {file.name!r} is the name of a robot that is shipped; another is allowed")
    hand_path = path.parent / file.hand
    hand_file = read_hand_file(hand_path)
    arm, hand = Urdf(path.parent / file.arm.urdf), Urdf(hand_path.parent / hand_file.urdf)
    hand.link(hand_file.root, "root", str(hand_path))
    urdf = compose(file, where, arm, hand, hand_file.root, hand_file.tool)
    _require_movable(file, where, urdf, hand_file, str(hand_path), set(hand.joints))
    links = {link.get("name", "") for link in hand.below(hand_file.root)[0]}
    return _Assembly(path, file, hand_path, hand_file, urdf, links).robot()


def _require_movable(
    file: RobotFile, where: str, urdf: ET.Element, hand_file: HandFile, hand_where: str, of_hand: set[str]
) -> None:
    """Refuse joints that move and are not named, names that no joint has, and moving links without a mass."""
    joints = {joint.get("name", ""): joint for joint in urdf.findall("joint")}
    moving = [name for name, joint in joints.items() if joint.get("type") != "fixed"]
    arm = [name for name in moving if name not in of_hand]
    if arm != file.arm.joints:
        raise MalformedFile(
            where,
            f"`arm.joints`: from base to flange the URDF has {', '.join(arm) or 'none'}; these, in order, are allowed",
        )
    for name in arm:
        kind = joints[name].get("type")
        if kind != "revolute":
            raise MalformedFile(where, f"joint {name!r} is {kind}; an arm's joints are revolute or continuous")
    fingers = [name for name in moving if name in of_hand]
    if sorted(fingers) != sorted(hand_file.fingers):
        found = ", ".join(fingers) or "nothing"
        raise MalformedFile(hand_where, f"`fingers`: what moves in the URDF is {found}; two joints are needed")
    for name in fingers:
        if joints[name].get("type") != "prismatic":
            raise MalformedFile(hand_where, f"joint {name!r} is {joints[name].get('type')}; fingers are prismatic")
    masses = {link.get("name"): link.find("inertial/mass") for link in urdf.findall("link")}
    for name in moving:
        link = child_of(urdf, name)
        mass = masses.get(link)
        if mass is None or not number(mass.get("value", "")) > 0.0:
            raise MalformedFile(
                hand_where if name in of_hand else where, f"link {link!r} moves and has no `inertial` with a mass"
            )


class _Assembly:
    """The parts of one robot on their way together."""

    def __init__(
        self,
        path: Path,
        file: RobotFile,
        hand_path: Path,
        hand_file: HandFile,
        urdf: ET.Element,
        hand_links: AbstractSet[str],
    ) -> None:
        self.path, self.where, self.file = path, str(path), file
        self.hand_links = hand_links
        self.hand_path, self.hand_where, self.hand_file = hand_path, str(hand_path), hand_file
        self.tree = urdf
        self.text = ET.tostring(urdf, encoding="unicode")
        with overheard() as words:
            try:
                self.full: Any = pinocchio.buildModelFromXML(self.text)
            except ValueError as error:
                reason = first_complaint(words(), str(error).splitlines()[0])
                raise MalformedFile(self.where, f"its URDF cannot be read: {reason}") from None
            if "Error:" in (said := words()):
                # The reader goes on without the part of a link that it could not read.
                raise MalformedFile(self.where, f"its URDF cannot be read: {first_complaint(said, said)}")
        fingers = [self.full.getJointId(name) for name in hand_file.fingers]
        self.model: Any = pinocchio.buildReducedModel(self.full, fingers, np.zeros(self.full.nq))

    def robot(self) -> Robot:
        """Return the robot.

        Raises:
            MalformedFile: where its parts do not go together.
        """
        arm, model = self.file.arm, self.model
        hand = self._hand()
        bodies = self._bodies(hand)
        lower = np.array(model.lowerPositionLimit if arm.lower is None else arm.lower, dtype=np.float64)
        upper = np.array(model.upperPositionLimit if arm.upper is None else arm.upper, dtype=np.float64)
        postures = [np.array(posture, dtype=np.float64) for posture in (arm.ready, *arm.postures)]
        for key, posture in zip(("ready", *["postures"] * len(arm.postures)), postures, strict=True):
            outside = np.flatnonzero((posture < lower) | (posture > upper))
            for joint in outside[:1]:
                limits = f"{lower[joint]:g} to {upper[joint]:g} rad is allowed"
                raise MalformedFile(self.where, f"`arm.{key}`: {posture[joint]:g} at {arm.joints[joint]!r}; {limits}")
        if arm.elbow is not None and arm.elbow.side * arm.ready[arm.joints.index(arm.elbow.joint)] < 0.0:
            raise MalformedFile(self.where, f"`arm.elbow`: {arm.elbow.joint!r} is bent to the other side in `ready`")
        spheres = None if arm.spheres is None else self.path.parent / arm.spheres
        count = len(arm.joints)
        return Robot(
            name=self.file.name,
            label=self._label(),
            path=self.path,
            files=self._files(),
            hand=hand,
            base=arm.base,
            joints=tuple(arm.joints),
            lower=lower,
            upper=upper,
            velocity=np.array(arm.velocity),
            acceleration=np.array(arm.acceleration),
            jerk=np.array(arm.jerk),
            force=np.array(arm.force),
            ready=postures[0],
            postures=tuple(postures),
            elbow=None if arm.elbow is None else (arm.joints.index(arm.elbow.joint), arm.elbow.side),
            swivel=None if arm.swivel is None else arm.joints.index(arm.swivel),
            urdf=self.text,
            bodies=bodies,
            spheres=spheres,
            padding=tuple(arm.padding or np.linspace(COARSE, FINE, count + 1).tolist()),
            forearm=count - 2 if arm.forearm is None else self._body(arm.forearm, bodies, "forearm"),
            touching=self._pairs(arm.touching, bodies, "touching"),
            apart=self._pairs(arm.apart, bodies, "apart"),
            heights=tuple((radius, level * LEVEL) for radius, level in self.file.reach.heights),
            tool=model.getFrameId(TOOL),
            model=model,
            data=model.createData(),
            axes=np.array([self._axis(name) for name in arm.joints]),
        )

    def _label(self) -> str:
        if self.path.parent == FOLDER:
            return self.file.name
        content = b"".join(sha256(file.read_bytes()).digest() for file in self._files() if file.is_file())
        return f"{self.file.name}-{sha256(content).hexdigest()[:8]}"

    def _files(self) -> tuple[Path, ...]:
        """All that the robot is made of, spheres that are not there yet included."""
        arm, hand = self.file.arm, self.hand_path.parent / self.hand_file.urdf
        files = [self.path, self.hand_path, self.path.parent / arm.urdf, hand]
        files += [self.path.parent / arm.spheres] if arm.spheres is not None else []
        files += [Path(mesh.get("filename", "")) for mesh in self.tree.iter("mesh")]
        return tuple(files)

    def _bodies(self, hand: Hand) -> dict[str, int]:
        """The body that each link of the arm belongs to, base first; each body has something that collides."""
        bodies = {}
        for frame in self.model.frames:
            if frame.type == pinocchio.FrameType.BODY and frame.name not in hand.links and frame.name != TOOL:
                bodies[str(frame.name)] = int(frame.parentJoint)
        order = [link.get("name", "") for link in self.tree.findall("link")]
        bodies = {link: bodies[link] for link in order if link in bodies}
        solid = {link.get("name") for link in self.tree.findall("link") if link.find("collision") is not None}
        for body in range(len(self.file.arm.joints) + 1):
            links = [link for link, number in bodies.items() if number == body]
            if body > 0 and not solid.intersection(links):
                problem = (
                    f"link {links[0]!r} has no `collision` in {self.file.arm.urdf}: nothing would know where it is"
                )
                raise MalformedFile(self.where, problem)
        return bodies

    def _body(self, link: str, bodies: dict[str, int], key: str) -> int:
        if link not in bodies:
            raise MalformedFile(self.where, f"`arm.{key}`: {link!r} is no link between base and flange")
        return bodies[link]

    def _pairs(
        self, pairs: Iterable[tuple[str, str]], bodies: dict[str, int], key: str
    ) -> frozenset[frozenset[int | str]]:
        return frozenset(
            frozenset(name if name == HAND else self._body(name, bodies, key) for name in pair) for pair in pairs
        )

    def _axis(self, joint: str) -> Vector:
        """A joint's axis in its frame, of length 1, shape (3,)."""
        element = self.tree.find(f"joint[@name='{joint}']/axis")
        axis = np.array([float(part) for part in (element.get("xyz", "") if element is not None else "1 0 0").split()])
        length = float(np.linalg.norm(axis))
        if axis.shape != (3,) or length < 1e-6:
            raise MalformedFile(self.where, f"joint {joint!r} has no axis")
        return np.asarray(axis / length)

    def _hand(self) -> Hand:
        file = self.hand_file
        root = self.full.frames[self.full.getFrameId(file.root, pinocchio.FrameType.BODY)]
        turned = _rotation(file.tool)
        links = self.hand_links
        frames, fingers = [], []
        for name, side in zip(file.fingers, (1.0, -1.0), strict=True):
            joint = self.full.getJointId(name)
            in_root = root.placement.actInv(self.full.jointPlacements[joint])
            if root.parentJoint != self.full.parents[joint]:
                raise MalformedFile(self.hand_where, f"`fingers`: joint {name!r} does not hang on {file.root!r}")
            along = turned.T @ in_root.rotation @ self._axis(name)
            if abs(along[1] - side) > STRAIGHT:
                way = "y" if side > 0 else "-y"
                raise MalformedFile(self.hand_where, f"`fingers`: joint {name!r} does not open along the tool's {way}")
            if self.full.lowerPositionLimit[self.full.idx_qs[joint]] > 1e-9:
                raise MalformedFile(self.hand_where, f"`fingers`: joint {name!r} is not closed at 0")
            if self.full.upperPositionLimit[self.full.idx_qs[joint]] < file.opening - 1e-9:
                raise MalformedFile(self.hand_where, f"`opening`: joint {name!r} does not open to {file.opening:g} m")
            place = np.eye(4)
            place[:3, :3], place[:3, 3] = turned.T @ in_root.rotation, turned.T @ in_root.translation
            frames.append(place)
            fingers.append(child_of(self.tree, name))
        palm, finger = self._corners(links - set(fingers), fingers[0], turned)
        return Hand(
            name=file.name,
            root=file.root,
            links=tuple(sorted(links)),
            joints=file.fingers,
            fingers=(fingers[0], fingers[1]),
            palm=palm,
            finger=finger,
            tool=turned.T @ np.array(file.tool.xyz),
            finger_places=np.stack(frames),
            opening=file.opening,
            force=file.force,
            speed=file.speed,
            tip=file.tip,
        )

    def _corners(
        self, palm: AbstractSet[str], finger: str, turned: Matrix
    ) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Least and greatest corners of palm and first finger in the hand's frame: the file's, else the meshes'."""
        if self.hand_file.boxes is not None:
            return np.array(self.hand_file.boxes.palm), np.array(self.hand_file.boxes.finger)
        from smash.motion.robots.meshes import link_points

        root = self.full.frames[self.full.getFrameId(self.hand_file.root, pinocchio.FrameType.BODY)]
        data = self.full.createData()
        pinocchio.framesForwardKinematics(self.full, data, np.zeros(self.full.nq))
        at_root = data.oMi[root.parentJoint] * root.placement
        found = []
        for links in (palm, {finger}):
            points = link_points(self.full, self.text, data, links, self.hand_where)
            inside = np.array([at_root.actInv(point) for point in points]) @ turned
            found.append(np.stack([inside.min(axis=0), inside.max(axis=0)]))
        return found[0], found[1]


def _rotation(place: PlaceFile) -> Matrix:
    """The rotation of a place, roll, pitch and yaw about fixed axes; exactly none where all are 0."""
    if place.rpy == (0.0, 0.0, 0.0):
        return np.eye(3)
    return np.asarray(pinocchio.rpy.rpyToMatrix(np.array(place.rpy)))
