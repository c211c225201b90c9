"""Answers from elsewhere judged: is a plan legal, and how far is it from the best that is known?"""

from __future__ import annotations

import json
from collections.abc import Iterable, Sequence
from dataclasses import dataclass

from smash.experiments.dataset.answers import answered_actions, answered_steps
from smash.experiments.dataset.entries import Entry
from smash.experiments.dataset.prompts import pddl_task
from smash.problem.errors import IllegalAction, MalformedFile
from smash.problem.files.plans import action_list
from smash.problem.model import Action
from smash.problem.rules import Law


@dataclass(frozen=True, slots=True)
class Score:
    """What an answer is worth.

    Attributes:
        problem: its name in the data set.
        legal: whether the law takes it as a plan that reaches the goal.
        reason: why not.
        cost: actions of a legal plan.
        reference: cost of the best plan known.
        proven: whether no plan is cheaper than the reference.
    """

    problem: str
    legal: bool
    reason: str
    cost: int | None
    reference: int | None
    proven: bool

    @property
    def gap(self) -> float | None:
        """How much dearer than the reference, a share of it; below 0 where it is better."""
        if self.cost is None or not self.reference:
            return 0.0 if self.cost == self.reference == 0 else None
        return self.cost / self.reference - 1


def _steps_done(entry: Entry, text: str) -> tuple[Action, ...]:
    """Return the actions of the steps in an answer to a prompt in PDDL."""
    from smash_baselines.steps import actions_of

    return tuple(actions_of(answered_steps(text), pddl_task(entry.instance, entry.options)))


def score(entry: Entry, answer: str | Sequence[Action], *, pddl: bool = False) -> Score:
    """Judge an answer to a problem.

    Args:
        entry: the problem, and what is known of it.
        answer: a text that holds a plan, or its actions.
        pddl: whether the text answers a prompt in PDDL.
    """
    proven = entry.status == "optimal"
    try:
        if isinstance(answer, str):
            text = answer.encode(errors="replace").decode()  # halves of surrogate pairs, which no file can hold
            actions = _steps_done(entry, text) if pddl else answered_actions(text)
        else:
            actions = tuple(answer)
    except (IllegalAction, MalformedFile) as error:
        return Score(entry.name, False, str(error), None, entry.cost, proven)
    verdict = Law(entry.instance, entry.options).check(actions)
    cost = verdict.cost if verdict.accepted else None
    return Score(entry.name, verdict.accepted, "" if verdict.accepted else str(verdict), cost, entry.cost, proven)


def summary(scores: Iterable[Score]) -> list[str]:
    """Return how many answers are legal and optimal, and the mean gap of the legal ones, a line each."""
    all_ = list(scores)
    legal = [one for one in all_ if one.legal]
    best = [one for one in legal if one.proven and one.cost == one.reference]
    better = [one for one in legal if one.gap is not None and one.gap < 0]
    gaps = [one.gap for one in legal if one.gap is not None]
    lines = [f"legal: {len(legal)} of {len(all_)}", f"optimal: {len(best)} of {len(all_)}"]
    if gaps:
        lines.append(f"gap to the best known cost, legal plans: {100 * sum(gaps) / len(gaps):.1f} % on average")
    if better:
        lines.append(f"better than the best known plan: {', '.join(one.problem for one in better)}")
    return lines


def answer_text(actions: Iterable[Action]) -> str:
    """Return a plan as the answer that a prompt asks for."""
    return json.dumps([action_list(action) for action in actions], ensure_ascii=False)
