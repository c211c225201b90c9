"""MuJoCo: the world in a model and data of its own.

The arm is driven as a real one is, by torques: those that its inertia needs for the acceleration that is wanted, and
what corrects place and speed, each motor within its limit. Motors that are springs with dampers do as well for the arm,
but not for what it holds: MuJoCo damps them after it has solved the contacts, and a held block creeps by millimetres.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from typing import Any

import mujoco
import numpy as np
from numpy.typing import NDArray

from smash.execution.physics import mujoco_model as models
from smash.execution.physics.world import STEP, World
from smash.execution.scene.block_pose import BlockPose
from smash.motion.robots.composing import TOOL
from smash.problem.errors import Unsupported

STEPS, HOLDING_STEPS = round(STEP / models.TIME_STEP), round(STEP / models.HOLDING_STEP)
"""Steps of the simulation in one of ours, and while the hand holds something."""
HELD = 0.002
"""Fingers that are kept this far from where they are sent hold something [m]."""
BANDWIDTH = 100.0
"""Errors of the arm's place and speed fade as fast as this, without swinging [rad/s]."""


class MujocoWorld(World):
    """Robot, table and blocks in one MuJoCo model."""

    engine = "mujoco"
    model: Any
    data: Any

    def _open(self, blocks: Mapping[str, BlockPose], carriers: Mapping[str, BlockPose], gui: bool) -> None:
        if gui:
            raise Unsupported("there is no window with the engine mujoco; the engine pybullet has one")
        robot = self.robot
        made = {name: self._as_made(name) for name in blocks}
        self.model = model = models.build(self.tabletop, blocks, carriers, made)
        self.data = mujoco.MjData(model)
        # What is looked at is worked out in data of its own: looking changes nothing.
        self._seen = mujoco.MjData(model)
        self._arm = np.array([model.joint(name).qposadr[0] for name in robot.joints])
        self._fingers = np.array([model.joint(name).qposadr[0] for name in robot.hand.joints])
        self._motors = np.array([model.actuator(name).id for name in robot.joints])
        self._finger_motors = np.array([model.actuator(name).id for name in robot.hand.joints])
        rest = np.zeros(robot.count)
        self._wanted_position, self._wanted_velocity, self._last_velocity = self._target, rest, rest
        self._acceleration, self._force = np.zeros(model.nv), np.zeros(model.nv)
        self._blocks = {name: model.body(models.block_body(name)).id for name in blocks}
        self._carriers = {name: model.body(models.carrier_body(name)).id for name in carriers}
        self._links = np.array([model.body(name).id for name in (*robot.links, robot.hand.root, *robot.hand.fingers)])
        self._tool: int = model.body(TOOL).id
        self._free = [int(model.body_dofadr[body]) for body in (*self._blocks.values(), *self._carriers.values())]
        self._block_of = np.full(model.ngeom, -1)
        self._block_of[[model.geom(models.block_body(name)).id for name in blocks]] = np.arange(len(blocks))
        self._of_robot = model.geom_contype == models.ROBOT
        self._names = list(blocks)
        self.data.qpos[self._arm] = self._target
        self.data.qpos[self._fingers] = self._finger_target = self.opening
        self._send_fingers()
        self._hold()
        mujoco.mj_forward(model, self.data)

    def close(self) -> None:
        """Give nothing back: what is held goes with the object."""

    def _advance(self) -> None:
        data, step = self.data, self.robot.hand.speed * STEP
        self._finger_target += min(step, max(-step, self.opening - self._finger_target))
        data.ctrl[self._finger_motors] = self._finger_target
        data.ctrl[self._motors] = self._torques()
        holds = (data.qpos[self._fingers] - self._finger_target).min() > HELD
        steps = HOLDING_STEPS if holds else STEPS
        self.model.opt.timestep = STEP / steps
        mujoco.mj_step(self.model, data, steps)

    def _torques(self) -> NDArray[np.float64]:
        """What the arm's motors shall turn with for the next `STEP` [Nm], shape (n,)."""
        data, velocity = self.data, self._wanted_velocity
        acceleration = (velocity - self._last_velocity) / STEP
        self._last_velocity = velocity
        # Where the arm should be now: the set-point is for the end of the step, its speed for the middle.
        behind = self._wanted_position - STEP * velocity - data.qpos[self._arm]
        slower = velocity - STEP / 2 * acceleration - data.qvel[self._arm]
        self._acceleration[self._arm] = acceleration + BANDWIDTH**2 * behind + 2 * BANDWIDTH * slower
        mujoco.mj_mulM(self.model, data, self._force, self._acceleration)
        rest = data.qfrc_bias[self._arm] - data.qfrc_gravcomp[self._arm]
        return np.asarray(self._force[self._arm] + rest)

    def _send(self, position: NDArray[np.float64], velocity: NDArray[np.float64]) -> None:
        self._wanted_position, self._wanted_velocity = position, velocity

    def _send_fingers(self) -> None:
        """Nothing to do: each step takes the fingers' motors on towards `opening`."""

    def in_contact(self) -> Iterator[str]:
        """The blocks that arm or hand touch now; one may be named several times."""
        contact = self.data.contact
        if not len(contact.dist):
            return
        first, second = contact.geom.T
        touching = contact.dist <= 0.0
        for robot, other in ((first, second), (second, first)):
            for block in self._block_of[other[touching & self._of_robot[robot]]]:
                if block >= 0:
                    yield self._names[block]

    def _speeds(self) -> Iterator[tuple[NDArray[np.float64], NDArray[np.float64]]]:
        velocity = self.data.qvel
        for first in self._free:
            yield velocity[first : first + 3], velocity[first + 3 : first + 6]

    def _look(self) -> Any:
        """Where everything is after the last step; what a step leaves is where it was before it."""
        self._seen.qpos[:] = self.data.qpos
        mujoco.mj_kinematics(self.model, self._seen)
        return self._seen

    def pose(self, block: str) -> BlockPose:
        """Pose of a block."""
        return self._poses([self._blocks[block]])[0]

    def poses(self) -> dict[str, BlockPose]:
        """Poses of all blocks."""
        return dict(zip(self._blocks, self._poses(self._blocks.values()), strict=True))

    def carriers(self) -> dict[str, BlockPose]:
        """Poses of all carriers."""
        return dict(zip(self._carriers, self._poses(self._carriers.values()), strict=True))

    def _poses(self, bodies: Iterable[int]) -> list[BlockPose]:
        seen = self._look()
        return [BlockPose(seen.xpos[body].copy(), seen.xmat[body].reshape(3, 3).copy()) for body in bodies]

    def joints(self) -> NDArray[np.float64]:
        """Measured arm joints [rad], shape (n,)."""
        return np.array(self.data.qpos[self._arm])

    def fingers(self) -> NDArray[np.float64]:
        """Measured place of each finger, from the middle [m], shape (2,)."""
        return np.array(self.data.qpos[self._fingers])

    def torques(self) -> NDArray[np.float64]:
        """What the arm's motors turn with [Nm], shape (n,)."""
        return np.array(self.data.actuator_force[self._motors])

    def links(self) -> NDArray[np.float64]:
        """Position [m] and quaternion (x, y, z, w) of links 1 to n, hand and fingers, shape (n + 3, 7)."""
        seen = self._look()
        return np.hstack([seen.xpos[self._links], np.roll(seen.xquat[self._links], -1, axis=1)])

    def tool_position(self) -> NDArray[np.float64]:
        """Measured position of the tool frame [m], shape (3,)."""
        return np.array(self._look().xpos[self._tool])
