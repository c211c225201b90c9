"""Which episodes were asked for: `RESULTS/episodes-asked.json`, one entry for each kind of question that was put."""

from __future__ import annotations

import os
from collections.abc import Sequence
from pathlib import Path
from typing import Annotated, Literal, cast

import msgspec

from smash.experiments.episodes.question import EpisodeRun
from smash.experiments.episodes.series import episode_runs, robot_label, told_apart
from smash.problem.files.documents import convert, parse_json, read_bytes, write_text
from smash.records.episodes import ROBOT

ASKED = "episodes-asked.json"
MOST_SEEDS = 10_000
"""Of one question."""


class Question(msgspec.Struct, frozen=True):
    """Every plan of these labels (of all where there are none), by these policies, under seeds 0 to `seeds` - 1.

    `scene` is the name of a scene file with what tells its content from others, None for the built-in scene; `engine`
    is what simulates them, `robot` what records call the robot.
    """

    seeds: Annotated[int, msgspec.Meta(ge=1, le=MOST_SEEDS)]
    policies: list[str]
    scene: str | None = None
    labels: list[str] = []
    engine: str = "pybullet"
    robot: str = ROBOT


class Asked(msgspec.Struct, frozen=True):
    """The file."""

    format: Literal["smash-episodes/1"]
    questions: list[Question]


def note_asked(
    results: Path,
    seeds: int,
    policies: Sequence[str],
    scene: os.PathLike[str] | None,
    labels: Sequence[str],
    noise: str | None = None,
    pace: float | None = None,
    engine: str = "pybullet",
    robot: str | None = None,
) -> None:
    """Add a question to those of a results directory; one that stands there already is not added again.

    Args:
        results: the directory.
        seeds: how many.
        policies: of `smash.experiments.episodes.series.POLICIES`.
        scene: a scene file, or None for the built-in scene.
        labels: of planners; none means all.
        noise: in place of the scene's own, or None.
        pace: the same.
        engine: what simulates them.
        robot: its name or file, in place of the scene's own, or None.
    """
    before = _questions(results) or []
    question = Question(
        seeds, list(policies), told_apart(scene, noise, pace), list(labels), engine, robot_label(scene, robot)
    )
    if question not in before:
        document = Asked("smash-episodes/1", [*before, question])
        text = msgspec.json.format(msgspec.json.encode(document), indent=1).decode()
        write_text(results / ASKED, text + "\n")


def asked_runs(results: Path) -> list[EpisodeRun] | None:
    """Return every episode that was asked for, once; None where it was never noted.

    Raises:
        MalformedFile: where a file is damaged.
    """
    questions = _questions(results)
    if questions is None:
        return None
    runs: dict[str, EpisodeRun] = {}
    for question in questions:
        told = None if question.scene is None else question.scene.removesuffix(".toml").removesuffix(".json")
        seeds, policies, labels = range(question.seeds), question.policies, question.labels
        for run in episode_runs(
            results, seeds, policies, labels=labels, told=told, engine=question.engine, called=question.robot
        ):
            runs.setdefault(run.key, run)
    return list(runs.values())


def _questions(results: Path) -> list[Question] | None:
    path = results / ASKED
    if not path.is_file():
        return None
    document = parse_json(read_bytes(path), str(path))
    return list(cast(Asked, convert(document, Asked, str(path))).questions)
