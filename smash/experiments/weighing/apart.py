"""Plans weighed in a process of their own: rehearsals hold the interpreter, so threads of one would share a core."""

from __future__ import annotations

from contextlib import suppress
from dataclasses import dataclass
from threading import Event
from typing import Any, ClassVar, NoReturn, Self

import msgspec

from smash.experiments.isolation.hearing import done
from smash.experiments.isolation.job import Job
from smash.experiments.isolation.voice import Voice, to_its_end
from smash.experiments.weighing.choosing import Choice, Question, choose, ready
from smash.forecast.expected import Forecaster
from smash.forecast.model import OutcomeModel, default_model, model_from_document
from smash.problem.errors import SmashError
from smash.problem.files.plans import action_from_list, action_list

PATIENCE = 60.0
"""Seconds beyond the budget, which it keeps itself, after which weighing is given up."""


class NotChosen(SmashError):
    """No plan was chosen: what weighs them was stopped or has failed.

    Args:
        reason: why, in a line.
        interrupted: whether it was stopped from outside.
    """

    def __init__(self, reason: str, interrupted: bool) -> None:
        super().__init__(reason)
        self.interrupted = interrupted


@dataclass(frozen=True, slots=True)
class Weighing:
    """What a guardian guards (`smash.experiments.isolation.work.Work`).

    Attributes:
        question: what to choose from.
        model: of the scene; None: of the default scene.
    """

    done_by: ClassVar[str] = "smash.experiments.weighing.apart:weigh"
    loaded_by: ClassVar[str] = "smash.experiments.weighing.apart:load"

    question: Question
    model: OutcomeModel | None = None

    @property
    def budget(self) -> float:
        """Seconds that it is given before it is taken for stuck."""
        return max(self.question.job.budget - self.question.spent, 0.0) + PATIENCE

    @property
    def memory(self) -> int:
        """Memory limit [MiB]."""
        return self.question.job.memory

    def document(self) -> dict[str, Any]:
        """Return it as JSON data."""
        return {
            "job": self.question.job.document(),
            "starts": [[action_list(action) for action in start] for start in self.question.starts],
            "spent": self.question.spent,
            "proven": self.question.proven,
            "model": None if self.model is None else msgspec.to_builtins(self.model),
        }

    @classmethod
    def from_document(cls, document: dict[str, Any]) -> Self:
        """Build it from its JSON data."""
        starts = tuple(tuple(action_from_list(entry, "start") for entry in start) for start in document["starts"])
        question = Question(Job.from_document(document["job"]), starts, document["spent"], document["proven"])
        return cls(question, None if document["model"] is None else model_from_document(document["model"]))


def chosen_apart(question: Question, model: OutcomeModel | None, stop: Event | None) -> Choice:
    """Choose a plan (`choose`) in a process of its own.

    Args:
        question: what from, and what for.
        model: of the scene; None: of the default scene.
        stop: set from outside, it ends it.

    Raises:
        NotChosen: where it is stopped, or fails.
    """
    try:
        ended = done(Weighing(question, model), stop)
    except SmashError as error:  # no process can be started
        raise NotChosen(f"weighing its plans: {error}", interrupted=False) from None
    if ended.answer is None:
        raise NotChosen(ended.reason if ended.interrupted else f"weighing its plans: {ended.reason}", ended.interrupted)
    actions = tuple(action_from_list(entry, "choice") for entry in ended.answer["actions"])
    return Choice(actions, ended.answer["seconds"], ended.answer["details"], ended.answer["expected_seconds"])


def load() -> None:
    """Load, once for all, what rehearsals take; what is not installed is said by the choice."""
    with suppress(ImportError):
        import smash.execution.rehearsal  # noqa: F401
        from smash.execution.actions.arm_motions import ArmMotions
        from smash.execution.scene.scene_file import default_scene

        ArmMotions(default_scene()).warm_up()


def weigh(work: Weighing, pipe: int) -> NoReturn:
    """Choose, and end the process."""
    voice = Voice(pipe)
    to_its_end(voice, lambda: _weigh(work, voice))


def _weigh(work: Weighing, voice: Voice) -> None:
    model = work.model or default_model()
    forecaster = Forecaster(work.question.job.problem, model)
    rehearsal = ready(work.question, model)
    voice.say(kind="solving")
    choice = choose(work.question, forecaster, rehearsal)
    voice.say(
        kind="result",
        answer={
            "actions": [action_list(action) for action in choice.actions],
            "seconds": choice.seconds,
            "details": dict(choice.details),
            "expected_seconds": choice.expected_seconds,
        },
    )
