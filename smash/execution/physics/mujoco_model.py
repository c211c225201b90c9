"""The scene as a MuJoCo model: the robot's own URDF, the table, the blocks and the trays.

MuJoCo takes for the friction of a contact what the geometry of the higher priority says, and the greater value where
priorities are equal; the scene's coefficients multiply. So blocks have the lowest priority and their own product, and
what touches blocks has the product with theirs. What a tray has with table and fingers are pairs of their own.
"""

from __future__ import annotations

import xml.etree.ElementTree as ET
from collections.abc import Mapping
from functools import lru_cache
from itertools import combinations
from typing import Any

import mujoco
import numpy as np
from numpy.typing import NDArray

from smash.execution.physics.simulated_robot import robot_text
from smash.execution.scene.block_pose import BlockPose, quaternion_of
from smash.execution.scene.noise import Made
from smash.execution.scene.tabletop import Friction, Tabletop
from smash.motion.robot import Robot
from smash.motion.robots import load_robot

TIME_STEP, HOLDING_STEP = 1 / 960, 1 / 2400
"""Of the simulation, and while the hand holds something [s]. A contact's friction knows speeds and no places: a held
block goes on along the tangent where the hand goes round, and so drifts outwards by an amount in proportion to this."""
IMPEDANCE_RATIO = 10.0
"""Friction is so much stiffer than what keeps bodies apart."""
CONTACT = (0.004, 1.0)
"""Time constant [s] and damping ratio of contacts. MuJoCo's own 0.02 s lets piles sag; with less, a block that falls
far bounces and slides on."""
GRASP = (2 * HOLDING_STEP, 1.0)
"""Of what the fingers touch, the stiffest that is stable (with the longer step MuJoCo takes twice that one)."""
IMPEDANCE = (0.95, 0.99, 0.001, 0.5, 2.0)
TORSION, ROLLING = 0.005, 0.0001
"""Friction against turning about the normal [m] and against rolling [m]."""
FINGER_STIFFNESS, FINGER_DAMPING = 5000.0, 100.0
"""Of the fingers' motors [N/m], [N s/m]."""
LINK_FRICTION = 0.5
"""Of arm and hand, as PyBullet has it where nothing is said."""
BLOCKS, ROBOT, GROUND, TRAYS = 1, 2, 4, 8
"""What collides with what: bits of `contype` and `conaffinity`. The robot does not meet itself."""


def block_body(name: str) -> str:
    """What the body of a block is called in the model, and its geometry."""
    return f"block {name}"


def carrier_body(name: str) -> str:
    """What the body of a carrier is called in the model."""
    return f"carrier {name}"


def build(
    tabletop: Tabletop,
    blocks: Mapping[str, BlockPose],
    carriers: Mapping[str, BlockPose],
    made: Mapping[str, Made],
) -> Any:
    """Compile the model of an episode's start (the arguments are those of `specification`)."""
    return specification(tabletop, blocks, carriers, made).compile()


def specification(
    tabletop: Tabletop,
    blocks: Mapping[str, BlockPose],
    carriers: Mapping[str, BlockPose],
    made: Mapping[str, Made],
) -> Any:
    """Return the model of an episode's start before it is compiled.

    Args:
        tabletop: Sizes, masses, friction.
        blocks: Poses of the blocks by name.
        carriers: Poses of the carriers by name.
        made: Each block as it is.
    """
    robot = load_robot(tabletop.robot)
    spec = mujoco.MjSpec.from_string(_robot_document(robot))
    spec.compiler.inertiafromgeom = mujoco.mjtInertiaFromGeom.mjINERTIAFROMGEOM_TRUE
    _set_options(spec)
    _dress_robot(spec, robot, tabletop.friction)
    top = spec.worldbody.add_geom(
        name="table", type=mujoco.mjtGeom.mjGEOM_BOX, size=[1.5, 1.5, 0.05], pos=[0.0, 0.0, -0.05]
    )
    _surface(top, tabletop.friction.block * tabletop.friction.table, 1, GROUND, BLOCKS | ROBOT | TRAYS)
    for name, pose in blocks.items():
        body = _free_body(spec, block_body(name), pose)
        box = body.add_geom(
            name=block_body(name), type=mujoco.mjtGeom.mjGEOM_BOX, size=[made[name].side / 2] * 3, mass=made[name].mass
        )
        _surface(box, tabletop.friction.block**2, 0, BLOCKS, BLOCKS | ROBOT | GROUND | TRAYS)
    if any(block.friction != tabletop.friction.block for block in made.values()):
        _pair_blocks(spec, robot.hand.fingers, tabletop.friction, made)
    for name, pose in carriers.items():
        _add_tray(spec, robot.hand.fingers, tabletop, carrier_body(name), pose)
    return spec


@lru_cache(maxsize=16)
def _robot_document(robot: Robot) -> str:
    """The URDF with what MuJoCo is told about reading it."""
    urdf = ET.fromstring(robot_text(robot))
    options = {"strippath": "false", "fusestatic": "false", "discardvisual": "true"}
    ET.SubElement(ET.SubElement(urdf, "mujoco"), "compiler", options)
    return ET.tostring(urdf, encoding="unicode")


def _set_options(spec: Any) -> None:
    option = spec.option
    option.timestep = TIME_STEP
    option.integrator = mujoco.mjtIntegrator.mjINT_IMPLICITFAST
    option.cone = mujoco.mjtCone.mjCONE_ELLIPTIC
    option.impratio = IMPEDANCE_RATIO
    # Piles at rest are left out until something touches them.
    option.enableflags |= int(mujoco.mjtEnableBit.mjENBL_SLEEP)


def _dress_robot(spec: Any, robot: Robot, friction: Friction) -> None:
    """Give the robot its surfaces and motors; its weight is carried, as a real arm's controller does."""
    hand = robot.hand
    for body in spec.bodies:
        if body.name == "world":
            continue
        body.gravcomp = 1.0
        coefficient = friction.finger if body.name in hand.fingers else LINK_FRICTION
        for number, shape in enumerate(body.geoms):
            _surface(shape, friction.block * coefficient, 1, ROBOT, BLOCKS | TRAYS)
            if body.name in hand.fingers:
                shape.solref = GRASP
            shape.name = body.name if number == 0 else f"{body.name} {number}"
            # Inertias follow from the shapes, as in PyBullet: those of the file may be the same for all links.
            shape.mass = body.mass / len(body.geoms)
    for joint in spec.joints:
        if joint.name in hand.joints:
            # What the URDF calls effort would clamp the fingers' force below that of their motors.
            joint.actfrcrange = [-hand.force, hand.force]
    for name, force in zip(robot.joints, robot.force, strict=True):
        _add_motor(spec, name, float(force)).set_to_motor()
    for name in hand.joints:
        _add_motor(spec, name, hand.force).set_to_position(kp=FINGER_STIFFNESS, kv=FINGER_DAMPING)
    # The fingers move as one: apart, they drift sideways together with the block that they squeeze.
    for tie in spec.equalities:
        tie.solref = GRASP
        tie.solimp = IMPEDANCE


def _add_motor(spec: Any, joint: str, force: float) -> Any:
    motor = spec.add_actuator(name=joint, target=joint, trntype=mujoco.mjtTrn.mjTRN_JOINT)
    motor.forcerange = [-force, force]
    motor.forcelimited = True
    return motor


def _free_body(spec: Any, name: str, pose: BlockPose) -> Any:
    x, y, z, w = quaternion_of(pose.rotation)
    body = spec.worldbody.add_body(name=name, pos=pose.position, quat=[w, x, y, z])
    body.add_freejoint()
    return body


def _add_tray(spec: Any, fingers: tuple[str, str], tabletop: Tabletop, name: str, pose: BlockPose) -> None:
    """One body of several boxes, its centre of mass in its frame's origin, the middle of the board."""
    tray = tabletop.tray
    assert tray is not None
    body = _free_body(spec, name, pose)
    centres, half = tray.boxes
    for number, (centre, size) in enumerate(zip(centres, half, strict=True)):
        part = f"{name} {number}"
        box = body.add_geom(name=part, type=mujoco.mjtGeom.mjGEOM_BOX, pos=centre, size=size)
        _surface(box, tray.friction * tabletop.friction.block, 1, TRAYS, BLOCKS | ROBOT | GROUND)
        _pair(spec, part, "table", tray.friction * tabletop.friction.table)
        for finger in fingers:
            _pair(spec, part, finger, tray.friction * tabletop.friction.finger, GRASP)
    body.explicitinertial = True
    body.mass = tray.mass
    body.ipos = np.zeros(3)
    body.inertia = _box_inertia(tray.mass, np.abs(centres).max(axis=0) + half.max(axis=0))


def _pair_blocks(spec: Any, fingers: tuple[str, str], friction: Friction, made: Mapping[str, Made]) -> None:
    """Give blocks of unlike friction the products of theirs, with each other, the table, the fingers."""
    for name, block in made.items():
        _pair(spec, block_body(name), "table", block.friction * friction.table)
        for finger in fingers:
            _pair(spec, block_body(name), finger, block.friction * friction.finger, GRASP)
    for (name, block), (other, second) in combinations(made.items(), 2):
        _pair(spec, block_body(name), block_body(other), block.friction * second.friction)


def _pair(spec: Any, first: str, second: str, friction: float, stiffness: tuple[float, float] = CONTACT) -> None:
    pair = spec.add_pair(geomname1=first, geomname2=second)
    pair.friction = [friction, friction, TORSION, ROLLING, ROLLING]
    pair.condim = 4
    pair.solref = stiffness
    pair.solimp = IMPEDANCE


def _box_inertia(mass: float, half: NDArray[np.float64]) -> NDArray[np.float64]:
    """Principal moments of a box [kg m2], shape (3,)."""
    square = half**2
    return np.asarray(mass / 3 * (square.sum() - square))


def _surface(shape: Any, friction: float, priority: int, kind: int, meets: int) -> None:
    shape.friction = [friction, TORSION, ROLLING]
    shape.priority = priority
    shape.contype, shape.conaffinity = kind, meets
    shape.condim = 4
    shape.solref = CONTACT
    shape.solimp = IMPEDANCE
