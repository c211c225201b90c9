"""Classical plans as plans of the testbed, and back.

The classical table is any empty location: what is put down goes to the first one, stacks before buffers. A classical
plan may end with a block in the hand; here the hand ends empty.
"""

from __future__ import annotations

import heapq
import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import NoReturn

from smash.problem.blocksworld.plan_text import PddlStep, PlanText
from smash.problem.blocksworld.reading import Reading, Template
from smash.problem.blocksworld.steps import Interpreter, Speaker, kinds_of
from smash.problem.blocksworld.world import MOVE, PUT, TAKE, Step
from smash.problem.errors import IllegalAction, RefusedPlan, Unsupported
from smash.problem.model import TABLE, Action, Instance, OnGoal, Pick, Place, State
from smash.problem.rules import Law

_NAME = re.compile(r"[^\s();?:][^\s();]*")


@dataclass(frozen=True)
class Imported:
    """A plan that came in.

    Attributes:
        actions: its actions here.
        moves: how many moves it has, where its domain has no hand; None elsewhere.
        placed: the block that was still in the hand at its end, and was put down; None where none was.
    """

    actions: tuple[Action, ...]
    moves: int | None
    placed: str | None


def imported(instance: Instance, plan: PlanText, reading: Reading) -> Imported:
    """Return a classical plan as actions for an instance.

    Args:
        instance: the instance.
        plan: the plan.
        reading: how its file tells a blocks world.

    Raises:
        RefusedPlan: where it is wrong, with the step and the reason in the words of the file.
        Unsupported: where the names of blocks differ in their case alone.
    """
    return _Follower(instance, reading).run(plan)


class _Follower:
    """Follows a plan through the arrangements, by the rules of its own file."""

    def __init__(self, instance: Instance, reading: Reading) -> None:
        self.instance = instance
        self.words = pddl_names(instance, plain=False)
        self.reading = reading
        self.interpreter = Interpreter(reading, {word: block for block, word in self.words.items()})
        self.law = Law(instance)
        self.state = State.start_of(instance)
        self.where = {block: at for at, pile in self.state.piles.items() for block in pile}
        self.where |= dict.fromkeys(self.state.table, TABLE)
        self.order = {at: number for number, at in enumerate(instance.locations)}
        self.empty = [number for at, number in self.order.items() if not self.state.piles[at]]

    def fact(self, relation: str, *blocks: str) -> str:
        return self.reading.fact(relation, *(self.words[block] for block in blocks))

    def run(self, plan: PlanText) -> Imported:
        actions: list[Action] = []
        moves = 0
        for number, step in enumerate(plan.steps, start=1):
            try:
                done = self._done(step)
            except (RefusedPlan, IllegalAction) as error:
                raise RefusedPlan(f"refused at step {number}: ({' '.join(step)}): {error}") from None
            moves += isinstance(done[-1], Place) and len(done) == 2
            actions += done
        if plan.unit and plan.cost is not None and plan.cost != len(plan.steps):
            raise RefusedPlan(f"refused: its cost says {plan.cost}, its length is {len(plan.steps)}")
        placed = self.state.hand
        self._require_goal()
        if placed is not None:
            actions.append(self._last_place(placed))
        without_hand = plan.steps and kinds_of(self.reading) & {MOVE} and moves == len(plan.steps)
        return Imported(tuple(actions), moves if without_hand else None, placed)

    def _done(self, step: PddlStep) -> list[Action]:
        """Carry out a step by the first of its meanings that the arrangement allows."""
        refusal = ""
        for meant, template in self.interpreter.meanings(step):
            refusal = self._refusal(meant, template)
            if not refusal:
                return list(self._carried_out(meant))
        raise RefusedPlan(refusal)

    def _refusal(self, step: Step, template: Template) -> str:
        """Return why a step is not possible, in the words of the file."""
        held = self.state.hand
        if step.kind == PUT:
            if held != step.block:
                return f"{self.fact('holding', step.block)} does not hold"
            return self._target_refusal(step, template)
        if held is not None:
            return f"{self.fact('handempty')} does not hold: {self.fact('holding', held)}"
        source = self._below(step.block)
        if "source" in template.roles and step.source != source:
            wanted = ("ontable", step.block) if step.source is None else ("on", step.block, step.source)
            return f"{self.fact(*wanted)} does not hold"
        if template.from_table and source is not None:
            return f"{self.fact('ontable', step.block)} does not hold"
        if template.from_table is False and source is None:
            return f"{self.fact('ontable', step.block)} holds"
        if not self._clear(step.block):
            return f"{self.fact('clear', step.block)} does not hold"
        return self._target_refusal(step, template) if step.kind == MOVE else ""

    def _target_refusal(self, step: Step, template: Template) -> str:
        target = step.target
        if template.to_table not in (None, target is None):
            return f"{template.action} puts nothing on {'the table' if target is None else 'a block'}"
        if target is None:
            taken = self._first_empty() is None
            return f"no location is empty, and {template.action} needs one" if taken else ""
        if target == step.block or not self._clear(target):
            return f"{self.fact('clear', target)} does not hold"
        if self.where[target] == TABLE:
            return f"{self.words[target]} lies in the table region, where nothing is put on it"
        return ""

    def _carried_out(self, step: Step) -> Iterator[Action]:
        if step.kind in (TAKE, MOVE):
            source = self.where.pop(step.block)
            yield self._apply(Pick(step.block, source))
            if source != TABLE and not self.state.piles[source]:
                heapq.heappush(self.empty, self.order[source])
        if step.kind in (PUT, MOVE):
            target = self._first_empty() if step.target is None else self.where[step.target]
            assert target is not None
            self.where[step.block] = target
            yield self._apply(Place(step.block, target))

    def _apply(self, action: Action) -> Action:
        self.law.apply(self.state, action)
        return action

    def _first_empty(self) -> str | None:
        while self.empty:
            location = self.instance.locations[self.empty[0]]
            if not self.state.piles[location]:
                return location
            heapq.heappop(self.empty)
        return None

    def _pile(self, block: str) -> list[str]:
        return self.state.piles.get(self.where.get(block, TABLE), [])

    def _below(self, block: str) -> str | None:
        pile = self._pile(block)
        height = len(pile) - 1 if pile and pile[-1] == block else (pile.index(block) if block in pile else 0)
        return pile[height - 1] if height else None

    def _clear(self, block: str) -> bool:
        pile = self._pile(block)
        return block != self.state.hand and (not pile or pile[-1] == block)

    def _require_goal(self) -> None:
        """Refuse a plan that does not reach the goal, before what is in the hand is put down."""
        goal = self.instance.goal
        if not isinstance(goal, OnGoal):
            return
        below = {b: under for pile in self.state.piles.values() for under, b in zip([None, *pile], pile, strict=False)}
        below |= dict.fromkeys(self.state.table)
        covered = frozenset(below.values())
        for upper, under in goal.on.items():
            if below.get(upper) != under:
                self._missed("on", upper, under)
        for block in (*goal.ontable, *goal.bottom):
            if below.get(block, block) is not None:
                self._missed("ontable", block)
        for block in goal.clear:
            if block in covered or block == self.state.hand:
                self._missed("clear", block)

    def _missed(self, relation: str, *blocks: str) -> NoReturn:
        raise RefusedPlan(f"refused: goal not reached: {self.fact(relation, *blocks)} does not hold at the end")

    def _last_place(self, block: str) -> Action:
        """Return where what is still in the hand goes: to the first empty location, else where the goal stays true."""
        first = self._first_empty()
        for location in [first] if first is not None else self.instance.locations:
            state = self.state.copy()
            self.law.apply(state, Place(block, location))
            if self.law.goal_shortfall(state) is None:
                return Place(block, location)
        held = self.fact("holding", block)
        raise RefusedPlan(f"refused: it ends with {held}, and here the hand ends empty: no place keeps the goal")


@dataclass(frozen=True)
class Exported:
    """A plan that goes out: its steps, and how many moves from place to place on the table were left out."""

    steps: tuple[PddlStep, ...]
    left_out: int


def exported(instance: Instance, actions: Sequence[Action], reading: Reading, *, moves: bool) -> Exported:
    """Return a plan as classical steps.

    Args:
        instance: the instance.
        actions: a legal plan.
        reading: how the file tells a blocks world.
        moves: whether a pick and its place are one move.

    Raises:
        Unsupported: where the classical blocks world has no words for it.
    """
    if not isinstance(instance.goal, OnGoal):
        raise Unsupported("only plans for `on` goals have a classical form; this goal names locations")
    if any(not isinstance(action, Pick | Place) for action in actions):
        raise Unsupported("a plan with a topple has no classical form; plan with --no-topple")
    if instance.carriers:
        raise Unsupported("an instance with carriers has no classical form")
    if moves and instance.hand is not None:
        raise Unsupported("a start with a block in the hand has no form in moves; --as classical has one")
    if (MOVE if moves else TAKE) not in kinds_of(reading):
        words = "has a hand: --as classical" if moves else "moves blocks without a hand: --as moves"
        raise Unsupported(f"the domain {words} fits it")
    speaker = Speaker(reading, pddl_names(instance, plain=True))
    steps = list(_classical(instance, actions))
    if moves:
        steps = [
            Step(MOVE, take.block, take.source, put.target) for take, put in zip(steps[::2], steps[1::2], strict=True)
        ]
    kept = [step for step in steps if step.kind != MOVE or step.source != step.target]
    return Exported(tuple(speaker.step(step) for step in kept), len(steps) - len(kept))


def _classical(instance: Instance, actions: Sequence[Action]) -> Iterator[Step]:
    """Yield the classical steps of picks and places."""
    law, state = Law(instance), State.start_of(instance)
    for action in actions:
        assert isinstance(action, Pick | Place)
        if isinstance(action, Pick):
            pile = state.piles.get(action.source, [])
            yield Step(TAKE, action.block, source=pile[-2] if len(pile) > 1 else None)
        else:
            pile = state.piles[action.target]
            yield Step(PUT, action.block, target=pile[-1] if pile else None)
        law.apply(state, action)


def pddl_names(instance: Instance, *, plain: bool) -> Mapping[str, str]:
    """Return the name of each block in PDDL, which ignores case.

    Args:
        instance: the instance.
        plain: whether names that PDDL cannot write are refused.

    Raises:
        Unsupported: where two names differ in their case alone, or PDDL cannot write one.
    """
    names: dict[str, str] = {}
    for block in instance.blocks:
        if plain and not _NAME.fullmatch(block):
            raise Unsupported(f"PDDL cannot write the name {block!r}; --as chain renames blocks")
        other = names.setdefault(block.lower(), block)
        if other != block:
            raise Unsupported(f"PDDL ignores case, and the blocks {other!r} and {block!r} differ in it alone")
    return {block: word for word, block in names.items()}


def in_words_of(reading: Reading, *, moves: bool) -> Reading:
    """Return the reading whose usual templates are those of moves, or of a hand, where no domain says them."""
    kinds = {MOVE} if moves else {TAKE, PUT}
    templates = tuple(template for template in reading.templates if template.kind in kinds)
    return replace(reading, hand=not moves, templates=templates) if reading.by_name else reading
