"""What an episode asks of the arm: its motions beside the Panda's limits, its motors, how well it follows.

    python -m smash.execution.trials.effort INSTANCE PLAN [--seed S] [--engine E]

carries the plan out without replanning and prints a table. What is sent to the arm is ours; torques are those of the
simulated motors, which hold a position: where the hand meets a block, they jump.
"""

from __future__ import annotations

import argparse
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from smash.execution.executor import Executor
from smash.execution.physics.world import STEP, World
from smash.execution.policy import OPEN
from smash.execution.scene.scene_file import default_scene
from smash.motion.robot import Robot
from smash.motion.robots import load_robot
from smash.problem.extras import ENGINES
from smash.problem.files.instances import read_instance
from smash.problem.files.plans import read_plan
from smash.records.episodes import Episode

TORQUE_RATE = 1000.0
"""The Panda's limit, of every joint [Nm/s]."""


@dataclass
class Effort:
    """Samples of every step of an episode; give `begin` to the executor as `on_frame`.

    Attributes:
        sent: Joints that the arm was sent to [rad], rows of shape (n,).
        measured: Joints that it had [rad].
        torques: Of its motors [Nm].
        robot: Whose.
    """

    sent: list[NDArray[np.float64]] = field(default_factory=list)
    measured: list[NDArray[np.float64]] = field(default_factory=list)
    torques: list[NDArray[np.float64]] = field(default_factory=list)
    robot: Robot = field(default_factory=load_robot)

    def begin(self, world: World) -> None:
        """Sample from now on."""
        world.on_step, self.robot = self._sample, world.robot

    def _sample(self, world: World) -> None:
        self.sent.append(world.recorded[-1][1])
        self.measured.append(world.joints())
        self.torques.append(world.torques())

    def rows(self) -> list[tuple[str, str]]:
        """What was measured, and its figure."""
        sent, measured, torques = np.array(self.sent), np.array(self.measured), np.array(self.torques)
        rates = np.abs(np.diff(torques, axis=0)) / STEP
        rows = [
            (f"greatest {word}, share of its limit", f"{_greatest(sent, order, limit):.2f}")
            for order, (word, limit) in enumerate(
                (
                    ("velocity", self.robot.velocity),
                    ("acceleration", self.robot.acceleration),
                    ("jerk", self.robot.jerk),
                ),
                start=1,
            )
        ]
        return [
            *rows,
            ("greatest lag behind what is sent [mrad]", f"{1e3 * np.abs(sent - measured).max():.1f}"),
            ("greatest torque, share of its limit", f"{(np.abs(torques) / self.robot.force).max():.2f}"),
            ("torque rate, 99.9 % of the steps are below [Nm/s]", f"{np.quantile(rates.max(axis=1), 0.999):.0f}"),
            ("greatest torque rate [Nm/s]", f"{rates.max():.0f}"),
            ("steps above 1,000 Nm/s [%]", f"{100 * (rates.max(axis=1) > TORQUE_RATE).mean():.2f}"),
        ]


def _greatest(sent: NDArray[np.float64], order: int, limit: NDArray[np.float64]) -> float:
    return float((np.abs(np.diff(sent, n=order, axis=0)) / STEP**order / limit).max())


def report(effort: Effort, episode: Episode) -> str:
    """The table, as Markdown."""
    named = {what: sum(len(getattr(row, what)) for row in episode.actions) for what in ("disturbed", "touched")}
    rows = [
        *effort.rows(),
        ("blocks moved by more than 2 cm by an action they are no part of", str(named["disturbed"])),
        ("blocks touched outside of grasps and pushes", str(named["touched"])),
    ]
    head = (
        f"| {episode.instance}, {episode.actions_executed} actions, {episode.times.execution:.0f} s | |\n|---|---:|\n"
    )
    return head + "\n".join(f"| {what} | {figure} |" for what, figure in rows)


def main() -> None:
    """Carry out and print."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("instance", help="an instance file")
    parser.add_argument("plan", help="a plan for it")
    parser.add_argument("--seed", type=int, default=0, help="of the blocks' start poses")
    parser.add_argument("--engine", choices=list(ENGINES), help="what simulates it")
    asked = parser.parse_args()
    effort = Effort()
    executor = Executor(
        read_instance(asked.instance),
        read_plan(asked.plan),
        default_scene(),
        seed=asked.seed,
        policy=OPEN,
        engine=asked.engine,
        on_frame=effort.begin,
    )
    print(report(effort, executor.run()))


if __name__ == "__main__":
    main()
