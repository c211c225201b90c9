"""PyBullet: the world in a connection of its own.

Only a fresh connection with `deterministicOverlappingPairs` repeats an episode bit for bit.
"""

from __future__ import annotations

import os
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from functools import partial
from typing import Any

import numpy as np
from numpy.typing import NDArray

from smash.execution.physics.simulated_robot import simulated_robot
from smash.execution.physics.window import furnish, require_display, words_to_stderr
from smash.execution.physics.world import STEP, World
from smash.execution.scene.block_pose import BlockPose, quaternion_of
from smash.motion.quiet import redirected
from smash.motion.robot import Robot
from smash.motion.robots.composing import TOOL

ITERATIONS = 50
BASE = -1
ASLEEP = 1e-5
"""A block whose squared speed [m2/s2 + rad2/s2] stays below this for two seconds is left out of the simulation until
something awake touches it or what it stands with: piles do not creep, and most of the work is spared."""


class PyBulletWorld(World):
    """Robot, table and blocks in one PyBullet connection.

    A step of the simulation is a `STEP`: one twice as long lets tall stacks drift by millimetres.
    """

    engine = "pybullet"
    client: Any = None
    _after_close: Callable[[], None] | None = None

    def _open(self, blocks: Mapping[str, BlockPose], carriers: Mapping[str, BlockPose], gui: bool) -> None:
        if gui:
            require_display()
        self.client = connect(gui)
        if gui:
            self._after_close = words_to_stderr()
            furnish(self.client, self.tabletop)
        self._set_up(blocks, gui)
        self._trays = {name: self._add_tray(pose) for name, pose in carriers.items()}

    def close(self) -> None:
        """End the connection."""
        if self.client is not None:
            self.client.disconnect()
            self.client = None
        if self._after_close is not None:
            self._after_close()
            self._after_close = None

    def _set_up(self, blocks: Mapping[str, BlockPose], gui: bool) -> None:
        c, friction = self.client, self.tabletop.friction
        c.setPhysicsEngineParameter(fixedTimeStep=STEP, numSolverIterations=ITERATIONS, deterministicOverlappingPairs=1)
        c.setGravity(0, 0, -9.81)
        shape = c.createCollisionShape(c.GEOM_BOX, halfExtents=[1.5, 1.5, 0.05])
        self._table: int = c.createMultiBody(0, shape, -1, [0, 0, -0.05])
        c.changeDynamics(self._table, -1, lateralFriction=friction.table)
        c.changeVisualShape(self._table, -1, rgbaColor=[0.93, 0.91, 0.87, 1])
        unseen = 0 if gui else c.URDF_IGNORE_VISUAL_SHAPES
        with simulated_robot(self.robot) as urdf:
            self._body: int = c.loadURDF(str(urdf), useFixedBase=True, flags=unseen)
        self._arm, self._fingers = numbers_of(c, self._body, self.robot)
        links = {_told(c.getJointInfo(self._body, link)[12]): link for link in range(c.getNumJoints(self._body))}
        self._links = (*self._arm, links[self.robot.hand.root], *self._fingers)
        self._tool = links[TOOL]
        for finger in self._fingers:
            c.changeDynamics(self._body, finger, lateralFriction=friction.finger)
        for joint, angle in zip(self._arm, self._target, strict=True):
            c.resetJointState(self._body, joint, float(angle))
        for finger in self._fingers:
            c.resetJointState(self._body, finger, self.opening)
        self._couple_fingers()
        # The base is bolted to the table; its contacts would cost more than all blocks'.
        for link in range(BASE, self._arm[0] + 1):
            c.setCollisionFilterPair(self._body, self._table, link, -1, 0)
        boxes = _Boxes(c)
        boxes.of(self.tabletop.block.half.tolist())
        self.bodies: dict[str, int] = {}
        for name, pose in blocks.items():
            made = self._as_made(name)
            place, turn = pose.position.tolist(), quaternion_of(pose.rotation)
            body = c.createMultiBody(made.mass, boxes.of(made.half), -1, place, turn)
            c.changeDynamics(
                body,
                -1,
                lateralFriction=made.friction,
                activationState=c.ACTIVATION_STATE_ENABLE_SLEEPING,
                sleepThreshold=ASLEEP,
            )
            self.bodies[name] = body
        self._named = {body: name for name, body in self.bodies.items()}
        self._advance_client = c.stepSimulation
        self._send_arm = partial(
            c.setJointMotorControlArray, self._body, self._arm, c.POSITION_CONTROL, forces=self.robot.force.tolist()
        )
        self._hold()
        self._send_fingers()

    def _add_tray(self, pose: BlockPose) -> int:
        """One body of several boxes; its frame, the middle of the board, is its centre of mass."""
        c, tray = self.client, self.tabletop.tray
        assert tray is not None
        centres, half = (array.tolist() for array in tray.boxes)
        shape = c.createCollisionShapeArray(
            shapeTypes=[c.GEOM_BOX] * len(half), halfExtents=half, collisionFramePositions=centres
        )
        body: int = c.createMultiBody(tray.mass, shape, -1, pose.position.tolist(), quaternion_of(pose.rotation))
        c.changeDynamics(body, -1, lateralFriction=tray.friction)
        return body

    def _couple_fingers(self) -> None:
        """Let the fingers move as one: apart, they drift sideways together with the block that they squeeze."""
        c, (left, right) = self.client, self._fingers
        gear = c.createConstraint(self._body, left, self._body, right, c.JOINT_GEAR, [1, 0, 0], [0, 0, 0], [0, 0, 0])
        c.changeConstraint(gear, gearRatio=-1, erp=0.2, maxForce=200)

    def _advance(self) -> None:
        self._advance_client()

    def _send(self, position: NDArray[np.float64], velocity: NDArray[np.float64]) -> None:
        self._send_arm(targetPositions=position.tolist(), targetVelocities=velocity.tolist())

    def _send_fingers(self) -> None:
        for finger in self._fingers:
            self.client.setJointMotorControl2(
                self._body,
                finger,
                self.client.POSITION_CONTROL,
                targetPosition=self.opening,
                force=self.robot.hand.force,
                maxVelocity=self.robot.hand.speed,
            )

    def in_contact(self) -> Iterator[str]:
        """The blocks that arm or hand touch now; one may be named several times."""
        for point in self.client.getContactPoints(bodyA=self._body):
            block = self._named.get(point[2])
            if block is not None and point[8] <= 0.0:
                yield block

    def _speeds(self) -> Iterator[tuple[NDArray[np.float64], NDArray[np.float64]]]:
        for body in (*self.bodies.values(), *self._trays.values()):
            linear, angular = self.client.getBaseVelocity(body)
            yield np.array(linear), np.array(angular)

    def pose(self, block: str) -> BlockPose:
        """Pose of a block."""
        return self._pose_of(self.bodies[block])

    def poses(self) -> dict[str, BlockPose]:
        """Poses of all blocks."""
        return {name: self._pose_of(body) for name, body in self.bodies.items()}

    def carriers(self) -> dict[str, BlockPose]:
        """Poses of all carriers."""
        return {name: self._pose_of(body) for name, body in self._trays.items()}

    def _pose_of(self, body: int) -> BlockPose:
        position, quaternion = self.client.getBasePositionAndOrientation(body)
        rotation = np.array(self.client.getMatrixFromQuaternion(quaternion)).reshape(3, 3)
        return BlockPose(np.array(position), rotation)

    def joints(self) -> NDArray[np.float64]:
        """Measured arm joints [rad], shape (n,)."""
        return self._states(self._arm, 0)

    def fingers(self) -> NDArray[np.float64]:
        """Measured place of each finger, from the middle [m], shape (2,)."""
        return self._states(self._fingers, 0)

    def torques(self) -> NDArray[np.float64]:
        """What the arm's motors turn with [Nm], shape (n,)."""
        return self._states(self._arm, 3)

    def _states(self, joints: Iterable[int], entry: int) -> NDArray[np.float64]:
        return np.array([state[entry] for state in self.client.getJointStates(self._body, joints)])

    def links(self) -> NDArray[np.float64]:
        """Position [m] and quaternion (x, y, z, w) of links 1 to n, hand and fingers, shape (n + 3, 7)."""
        states = self.client.getLinkStates(self._body, self._links, computeForwardKinematics=True)
        return np.array([[*state[4], *state[5]] for state in states])

    def tool_position(self) -> NDArray[np.float64]:
        """Measured position of the tool frame [m], shape (3,)."""
        return np.array(self.client.getLinkState(self._body, self._tool, computeForwardKinematics=True)[4])


def numbers_of(client: Any, body: int, robot: Robot) -> tuple[tuple[int, ...], tuple[int, ...]]:
    """PyBullet's numbers of a robot's joints: of the arm, and of the fingers."""
    joints = {_told(client.getJointInfo(body, number)[1]): number for number in range(client.getNumJoints(body))}
    return tuple(joints[name] for name in robot.joints), tuple(joints[name] for name in robot.hand.joints)


def _told(name: bytes) -> str:
    return name.decode()


class _Boxes:
    """Collision shapes of blocks: one for all that are of a size."""

    def __init__(self, client: Any) -> None:
        self._client = client
        self._made: dict[tuple[float, ...], int] = {}

    def of(self, half: Sequence[float]) -> int:
        """The shape with these half edges [m]."""
        shape = self._made.get(tuple(half))
        if shape is None:
            shape = self._made[tuple(half)] = self._client.createCollisionShape(self._client.GEOM_BOX, halfExtents=half)
        return shape


def connect(gui: bool) -> Any:
    """A new PyBullet connection, without the library's greetings on the user's output."""
    with open(os.devnull, "wb") as silence, redirected(silence.fileno(), 1, 2):
        import pybullet
        from pybullet_utils.bullet_client import BulletClient

        return BulletClient(connection_mode=pybullet.GUI if gui else pybullet.DIRECT)
