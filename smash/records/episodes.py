"""An execution, `smash-episode/1`, and its record in `episodes.jsonl`, `smash-episode-run/1`.

Times are in seconds: `offline` and `online` are wall time of motion planning before and during the episode, the same
with `_cpu` is what the planning thread computed (a busy machine does not lengthen it), `execution` is simulated time,
`task` is wall time of replanning the task. Measured times differ from run to run; everything else is a function of
instance, plan, scene, seed and policy.
"""

from __future__ import annotations

from typing import Any, Final, Literal

import msgspec

from smash.problem.plan import Status
from smash.records.record import Commit, Machine, Record

EPISODE_FORMAT: Final = "smash-episode/1"
EPISODE_RUN_FORMAT: Final = "smash-episode-run/1"
ROBOT: Final = "panda"
"""The robot of records that say nothing about one."""

Origin = Literal["plan", "replan", "recovery"]


class Times(msgspec.Struct, kw_only=True):
    """Seconds of one action or of a whole episode."""

    offline: float = 0.0
    offline_cpu: float = 0.0
    online: float = 0.0
    online_cpu: float = 0.0
    execution: float = 0.0


class Performed(msgspec.Struct, kw_only=True):
    """One action as it was carried out.

    Attributes:
        step: 1-based, in the order of execution.
        action: As in `smash-plan/1`.
        origin: From the given plan, from a replanned one, or a recovery move of the executor.
        outcome: "done", or the name of the failure.
        reason: Of the failure, in words.
        begun: Simulated time at which it began [s].
        attempts: Motions tried, retries included.
        gap: Whether it was a gap task, planned only when its pose was known.
        repaired: Whether a motion planned before was planned again because the scene had changed.
        disturbed: Blocks that were moved by more than 2 cm and are no part of the action, and how far [m].
        aside: Blocks that lay on the one that was picked, and were set aside first.
        touched: Blocks that arm or hand touched outside of a grasp or push that was meant for them.
        times: Of this action.
    """

    step: int
    action: list[str | int]
    origin: Origin
    outcome: str = "done"
    reason: str | None = None
    begun: float = 0.0
    attempts: int = 1
    gap: bool = False
    repaired: bool = False
    disturbed: dict[str, float] = {}
    touched: list[str] = []
    aside: list[str] = []
    times: Times = msgspec.field(default_factory=Times)


class Failure(msgspec.Struct, kw_only=True):
    """Why an episode failed: the failure's name, the step and action at which it did, and the reason in words."""

    name: str
    step: int
    action: list[str | int] | None
    reason: str


class Totals(msgspec.Struct, kw_only=True):
    """Times of the whole episode; `execution` includes settling and the judges' waits are left out."""

    offline: float
    offline_cpu: float
    online: float
    online_cpu: float
    execution: float
    task: float


class Arrangement(msgspec.Struct, kw_only=True):
    """Where blocks and carriers are at the end, by the law; the station is null of a carrier that stands at none."""

    piles: dict[str, list[str]]
    table: list[str]
    carried: dict[str, list[str]] = {}
    stations: dict[str, str | None] = {}


class Episode(msgspec.Struct, kw_only=True):
    """An executed plan; one without `engine` or `robot` was recorded when there was PyBullet alone, or the Panda.

    Attributes:
        noise: What was not known exactly, and how much of it [m, rad, share]; what is left out was.
        speed: Shares of the arm's velocity and acceleration limits that motions used; None in older records.
    """

    format: str = EPISODE_FORMAT
    instance: str
    planner: str
    topple: bool
    max_topple: int | None
    scene: str
    engine: str = "pybullet"
    robot: str = ROBOT
    seed: int
    replanning: bool
    success: bool
    failure: Failure | None
    plan_cost: int
    actions_executed: int
    replans: int
    retries: int
    times: Totals
    final: Arrangement
    actions: list[Performed]
    noise: dict[str, float] = {}
    speed: tuple[float, float] | None = None

    def without_measured_times(self) -> dict[str, Any]:
        """The part that the seed determines: equal for equal arguments."""
        document: dict[str, Any] = msgspec.to_builtins(self)
        for times in [document["times"], *(entry["times"] for entry in document["actions"])]:
            for measured in ("offline", "offline_cpu", "online", "online_cpu", "task"):
                times.pop(measured, None)
        return document


class EpisodeRecord(Record, kw_only=True, frozen=True):
    """One episode of a sweep's plan: the plan's run, how it was carried out, where, and the episode itself.

    Attributes:
        key: Names it for good: the run's key, policy, seed, scene, and engine and robot where they are not PyBullet
            and the Panda.
        run: Key of the run whose plan it carries out; what was planned stands beside it.
        scene: Name of the scene file (`default` is the built-in scene), then the noise and the pace that took the
            place of its own, as in "default pose=3mm pace=0.1"; None for the built-in scene as it is.
        engine: What simulated it; a record that does not say so is from when there was PyBullet alone.
        robot: What carried it out; a record that does not say so is from when there was the Panda alone.
        depth: Of a single target in its start pile, the top being 1; None for other goals.
        episode: None where its process ended without one; `problem` says why.
    """

    format: Literal["smash-episode-run/1"]
    key: str
    run: str
    instance: str
    suite: str
    label: str
    variant: str
    policy: str
    seed: int
    scene: str | None
    engine: str = "pybullet"
    robot: str = ROBOT
    blocks: int
    depth: int | None
    cost: int
    status: Status
    budget: float
    first_plan_seconds: float | None
    best_plan_seconds: float | None
    episode: Episode | None
    problem: str
    wall_seconds: float
    started: str
    load_average: tuple[float, float]
    commit: Commit
    machine: Machine
    versions: dict[str, str]


def episode_text(episode: Episode) -> str:
    """The JSON of an episode, one action a line."""
    document = {**msgspec.to_builtins(_rounded(episode)), "noise": episode.noise}
    lines = []
    for key, value in document.items():
        if key == "actions":
            rows = ",\n".join("  " + _json(row) for row in value)
            lines.append(f' "actions": [\n{rows}\n ]' if value else ' "actions": []')
        else:
            lines.append(f" {_json(key)}: {_json(value)}")
    return "{\n" + ",\n".join(lines) + "\n}\n"


def _json(value: object) -> str:
    return msgspec.json.format(msgspec.json.encode(value), indent=0).decode()


def _rounded(value: object) -> object:
    document = msgspec.to_builtins(value)

    def walk(part: object) -> object:
        if isinstance(part, float):
            return round(part, 4)
        if isinstance(part, dict):
            return {key: walk(entry) for key, entry in part.items()}
        return [walk(entry) for entry in part] if isinstance(part, list) else part

    return walk(document)
