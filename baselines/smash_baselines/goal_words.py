"""What an `on` goal says that holds in several ways: `ontable` and `clear`, as words that are judged when all is done.

`domains/parts/goal-words.pddl` has the text. A domain gets it where a goal leaves such words open
(`Problem.open_rest`); elsewhere `ontable` comes to (bottom …), and the domains are those of the other problems.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from itertools import pairwise

from smash.problem.model import Goal, Instance, OnGoal
from smash.problem.problem import Problem
from smash_baselines.domains import DOMAINS
from smash_baselines.names import Fact, Names
from smash_baselines.parts.domain import extended_text

RESTS, CLEAR = "rests", "lies-clear"
FINISH = "finish"
JUDGED = {
    FINISH,
    "rests-at-bottom",
    "rests-in-region",
    "clear-on-top",
    "clear-in-region",
    "clear-on-carrier",
}
"""The actions that judge words: nothing of the law."""


def told(problem: Problem) -> Instance:
    """Return the instance with the goal that PDDL is told: the posed one, and what any plan has to keep.

    Where nothing falls, a posed goal is silent on blocks that rest in the table region from the start on. The cheapest
    plans leave them there; engines are not held to those, so it is said to them.
    """
    goal = problem.instance.goal
    posed = problem.posed
    if not isinstance(goal, OnGoal) or not isinstance(posed.goal, OnGoal):
        return posed
    said = {*posed.goal.bottom, *posed.goal.ontable}
    silent = tuple(block for block in goal.ontable if block not in said)
    if not silent:
        return posed
    return replace(posed, goal=replace(posed.goal, ontable=(*posed.goal.ontable, *silent)))


def words_of(goal: Goal) -> list[tuple[str, str]]:
    """Return the words that a told goal leaves open: what each says, and of which block."""
    if not isinstance(goal, OnGoal):
        return []
    return [*((RESTS, block) for block in goal.ontable), *((CLEAR, block) for block in goal.clear)]


def word_names(goal: Goal) -> tuple[str, ...]:
    """Return the PDDL objects of the words: the one that `finish` meets, then one each; none where there is no word."""
    count = len(words_of(goal))
    width = max(2, len(str(count)))
    return tuple(f"w{number:0{width}}" for number in range(count + 1)) if count else ()


def word_facts(goal: Goal, names: Names) -> Iterator[Fact]:
    """Yield what holds of the words at the start."""
    objects = word_names(goal)
    if objects:
        yield ("opens", objects[0])
    yield from (("before", word, later) for word, later in pairwise(objects))
    for word, (says, block) in zip(objects[1:], words_of(goal), strict=False):
        yield (says, word, names.blocks[block])


def ended(goal: Goal) -> tuple[Fact, ...]:
    """Return how a goal says that all is done: by an empty hand, or by the words, of which `finish` opens the first."""
    return tuple(("met", word) for word in word_names(goal)) or (("hand-empty",),)


def judged_text(text: str, domain: str, *, regions: bool) -> str:
    """Return the PDDL text of a domain that judges words; its name ends with `-words`.

    Args:
        text: the domain.
        domain: its PDDL name.
        regions: whether its `top` says in which region a pile stands, and `(idle)` holds between actions.
    """
    parts = ["goal-words-regions" if regions else "goal-words"]
    if "(on-carrier ?b - block" in text:
        parts.append("goal-words-carriers")
    name = domain
    for part in parts:
        added = (DOMAINS / "parts" / f"{part}.pddl").read_text(encoding="utf-8")
        text = extended_text(text, name, f"{domain}-words", added)
        name = f"{domain}-words"
    return text
