"""The warm start of a model: another planner's plans, offered to the log before the first model is built."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from smash.planners.protocol import HIGHS, Method, Planner, Settings, SolveLog, ask, left, why_not_settings, why_refused
from smash.planners.registry import get_planner
from smash.problem.model import Action
from smash.problem.problem import Problem

LEAST_SECONDS = 0.05
"""Given to the other planner however short the budget is."""


def warm_starts(settings: Settings, share: float) -> tuple[Method, ...]:
    """Return the warm start as a method; none where none is asked for.

    Only plans are taken, under the other planner's name: what it proves is no proof of the model that they start.

    Args:
        settings: name the other planner, which gets the same but for the warm start and the horizon, and the solver
            if it has a choice.
        share: share of the time left that it may take.
    """
    if settings.warm_start is None:
        return ()
    name = settings.warm_start

    def takes(problem: Problem) -> str | None:
        other = get_planner(name)
        return why_refused(other, problem, _theirs(other, settings))

    def run(problem: Problem, log: SolveLog, until: float) -> None:
        def offer(_seconds: float, _cost: int, actions: Sequence[Action]) -> None:
            log.offer(actions, name)

        other = get_planner(name)
        seconds = max(LEAST_SECONDS, left(until))
        found = ask(other, problem, _theirs(other, settings), seconds, offer, name=name)
        if found.actions is not None:  # a planner from outside may report no incumbents
            log.offer(found.actions, name)

    return (Method(f"warm start by {name}", takes, run, share),)


def _theirs(other: Planner, settings: Settings) -> Settings:
    """Return the settings for the other planner: cold, with the solver if it takes it."""
    cold = settings.cold
    return cold if why_not_settings(other, cold) is None else replace(cold, solver=HIGHS)
