"""A classical blocks world as a unified-planning problem: known by what its four actions do, not by names.

The classical table holds every block at once: the instance has as many stacks as blocks, no buffer, and is planned
without topple. Each pick and each place is then one step of the problem, and back.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import TYPE_CHECKING

from smash.problem.errors import IllegalAction, MalformedFile, Unsupported
from smash.problem.making import make_instance
from smash.problem.model import Action, Instance, OnGoal, Pick, Place, PlanOptions, State
from smash.problem.rules import Law
from smash_baselines.names import Fact, Step
from smash_baselines.up_matching import Matched, in_roles, match

if TYPE_CHECKING:
    from unified_planning.model import Problem

WHERE = "problem"


@dataclass(frozen=True, slots=True)
class Classical:
    """A classical problem read: the instance, and how its plans are said in the problem's own actions.

    Attributes:
        instance: with as many stacks as blocks.
        matched: the problem's own words.
        keeps_hand: whether the goal says that the hand is empty.
    """

    instance: Instance
    matched: Matched
    keeps_hand: bool

    @property
    def options(self) -> PlanOptions:
        """What its plans may use: nothing falls."""
        return PlanOptions(topple=False)

    @property
    def exact(self) -> bool:
        """Whether the problem counts what the law counts: each pick and each place is one step."""
        return True

    def steps(self, actions: Sequence[Action]) -> list[Step]:
        """Return the problem's steps for a legal plan.

        Raises:
            IllegalAction: where the law refuses an action.
        """
        law = Law(self.instance, self.options)
        return [self._step(state, action) for state, action in zip(law.states(actions), actions, strict=False)]

    def actions(self, steps: Iterable[Step]) -> list[Action]:
        """Return the law's actions for a plan of the problem.

        A block goes to the first empty stack where the plan puts it down.

        Raises:
            IllegalAction: where a step is not of the problem, or the law refuses what it says.
        """
        named = {name: (kind, turned) for kind, (name, turned) in self.matched.actions.items()}
        law, state = Law(self.instance, self.options), State.start_of(self.instance)
        actions: list[Action] = []
        for name, *arguments in steps:
            if name not in named:
                raise IllegalAction(f"step ({' '.join([name, *arguments])}): the problem has no such action")
            kind, turned = named[name]
            block, *under = reversed(arguments) if turned else arguments
            action: Action
            if kind in ("pick-up", "unstack"):
                action = Pick(block, _pile_of(state, block))
            else:
                action = Place(block, _pile_of(state, under[0]) if under else _pile_of(state, None))
            law.apply(state, action)
            actions.append(action)
        return actions

    def shortened(self, actions: Sequence[Action]) -> tuple[Action, ...]:
        """Return a plan without its last place where the goal holds with the block in the hand."""
        if self.keeps_hand or not actions or not isinstance(actions[-1], Place):
            return tuple(actions)
        rest = actions[:-1]
        *_, state = Law(self.instance, self.options).states(rest)
        goal = self.instance.goal
        assert isinstance(goal, OnGoal)
        return tuple(rest) if _holds_in_hand(goal, state) else tuple(actions)

    @property
    def may_end_full(self) -> bool:
        """Whether a plan may end one step earlier with a block in the hand.

        Its last step then clears a block that the goal wants clear, of one that the goal says nothing of.
        """
        goal = self.instance.goal
        assert isinstance(goal, OnGoal)
        said = {*goal.on, *goal.on.values(), *goal.ontable, *goal.clear}
        return not self.keeps_hand and bool(goal.clear) and not said.issuperset(self.instance.blocks)

    def _step(self, state: State, action: Action) -> Step:
        if isinstance(action, Pick):
            under = state.piles[action.source][-2:-1]
            kind = "unstack" if under else "pick-up"
        else:
            assert isinstance(action, Place)
            under = state.piles[action.target][-1:]
            kind = "stack" if under else "put-down"
        name, turned = self.matched.actions[kind]
        arguments = [action.block, *under]
        return (name, *(reversed(arguments) if turned else arguments))


def _pile_of(state: State, block: str | None) -> str:
    """Return where a block stands; None: the first empty stack."""
    for at, pile in state.piles.items():
        if (not pile) if block is None else block in pile:
            return at
    raise IllegalAction(f"{block!r} stands nowhere")


def _holds_in_hand(goal: OnGoal, state: State) -> bool:
    """Whether a goal without a word on the hand holds while a block is in it."""
    below = {upper: pile[at - 1] if at else None for pile in state.piles.values() for at, upper in enumerate(pile)}
    covered = set(below.values())
    return (
        all(below.get(upper) == under for upper, under in goal.on.items())
        and all(block in below and below[block] is None for block in goal.ontable)
        and all(block in below and block not in covered for block in goal.clear)
    )


def read_classical(problem: Problem, start: Iterable[Fact], goal: Iterable[Fact]) -> Classical:
    """Read a blocks world with a hand.

    Args:
        problem: the problem.
        start: the facts that hold at its start.
        goal: the facts that it wants.

    Raises:
        Unsupported: where its actions are not those of a blocks world, or the goal speaks of something else.
        MalformedFile: where its facts describe no state of one.
    """
    matched = match(problem)
    if matched is None:
        raise Unsupported("its actions are not those of a blocks world with a hand")
    role_of = {name: role for role, name in matched.fluents.items()}
    blocks = _blocks(problem)
    held, asked = list(start), list(goal)
    before, wanted = (in_roles(facts, role_of, turned=matched.turned) for facts in (held, asked))
    never = [fact for fact in asked if fact[0] not in role_of and fact not in held]
    if never:
        raise Unsupported(f"the goal wants ({' '.join(never[0])}), which does not hold and no action brings about")
    if any(fact[0] == "holding" for fact in wanted):
        raise Unsupported("the goal wants a block in the hand")
    return Classical(_instance(problem, blocks, before, wanted), matched, ("handempty",) in wanted)


def _blocks(problem: Problem) -> list[str]:
    kinds = {parameter.type for action in problem.actions for parameter in action.parameters}
    if len(kinds) != 1:
        raise Unsupported(f"its actions are about objects of {len(kinds)} types; blocks are of one")
    return [item.name for item in problem.objects(kinds.pop())]


def _instance(problem: Problem, blocks: Sequence[str], before: list[Fact], wanted: list[Fact]) -> Instance:
    upper_of = {under: upper for role, upper, under in (fact for fact in before if fact[0] == "on")}
    held = [fact[1] for fact in before if fact[0] == "holding"]
    piles = []
    for base in [fact[1] for fact in before if fact[0] == "ontable"]:
        pile = [base]
        while pile[-1] in upper_of and len(pile) <= len(blocks):
            pile.append(upper_of[pile[-1]])
        piles.append(pile)
    stacks = [f"p{number}" for number in range(1, max(1, len(blocks)) + 1)]
    _expect(before, piles, held)
    on = {upper: under for _, upper, under in (fact for fact in wanted if fact[0] == "on")}
    if len(on) != len({fact for fact in wanted if fact[0] == "on"}):
        raise MalformedFile(WHERE, "the goal wants a block on two blocks: nothing fulfils it")
    ontable, clear = (tuple(dict.fromkeys(f[1] for f in wanted if f[0] == role)) for role in ("ontable", "clear"))
    return make_instance(
        dict(zip(stacks, piles, strict=False)),
        OnGoal(on, (), ontable, clear),
        name=problem.name or "problem",
        blocks=blocks,
        stacks=stacks,
        hand=held[0] if held else None,
        where=WHERE,
    )


def _expect(before: Sequence[Fact], piles: Sequence[Sequence[str]], held: Sequence[str]) -> None:
    """Compare what the piles come to with what the start says.

    Raises:
        MalformedFile: naming a fact that is missing or too much.
    """
    meant: set[Fact] = {("handempty",)} if not held else {("holding", held[0])}
    for pile in piles:
        meant |= {("ontable", pile[0]), ("clear", pile[-1])}
        meant |= {("on", upper, under) for under, upper in pairwise(pile)}
    extra, lost = sorted(set(before) - meant), sorted(meant - set(before))
    if extra:
        raise MalformedFile(WHERE, f"the start says ({' '.join(extra[0])}), which does not fit the rest of it")
    if lost:
        raise MalformedFile(WHERE, f"the start does not say ({' '.join(lost[0])}), which the rest of it means")
