"""A classical blocks world as a unified-planning problem: told in PDDL by that library, and read by our reader.

The classical table holds every block at once: the instance has as many stacks as blocks, no buffer, and is planned
without topple. Where the problem has a hand each pick and each place is one step; without one both are one move.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

from smash.problem.blocksworld.domain import domain_from
from smash.problem.blocksworld.placing import placed
from smash.problem.blocksworld.plan_text import PddlStep, PlanText
from smash.problem.blocksworld.plans import exported, imported
from smash.problem.blocksworld.problem import BlocksProblem, blocks_problem
from smash.problem.blocksworld.reading import Reading
from smash.problem.blocksworld.roles import Recognizer
from smash.problem.blocksworld.sections import ProblemText, problem_from
from smash.problem.blocksworld.sexpr import parse_expression
from smash.problem.blocksworld.steps import kinds_of
from smash.problem.blocksworld.world import MOVE, Arrangement
from smash.problem.errors import IllegalAction, Infeasible, RefusedPlan, Unsupported
from smash.problem.model import Action, Instance, OnGoal, Pick, Place, PlanOptions
from smash_baselines.names import Step

if TYPE_CHECKING:
    from unified_planning.model import Problem

WHERE = "problem"
_OF_A_HELD_BLOCK = frozenset({"uncovered", "lying"})
"""Relations that say of a block in the hand what they say of one on the table."""


@dataclass(frozen=True, slots=True)
class Words:
    """Names of the problem and of its PDDL text, which knows neither case nor every sign.

    Attributes:
        objects: name of an object -> in PDDL.
        actions: name of an action -> in PDDL.
    """

    objects: Mapping[str, str]
    actions: Mapping[str, str]

    def in_pddl(self, step: Step) -> PddlStep:
        """Return a step of the problem in PDDL."""
        name, *arguments = step
        return (self.actions.get(name, name), *(self.objects.get(word, word) for word in arguments))

    def of_pddl(self, step: PddlStep) -> Step:
        """Return a PDDL step in the names of the problem."""
        objects = {word: name for name, word in self.objects.items()}
        actions = {word: name for name, word in self.actions.items()}
        return (actions[step[0]], *(objects[word] for word in step[1:]))


@dataclass(frozen=True, slots=True)
class Classical:
    """A classical problem read: the instance, and how its plans are said in the problem's own actions.

    Attributes:
        instance: with as many stacks as blocks, in the problem's names.
        told: the same in the names of its PDDL text.
        reading: how that text tells a blocks world.
        words: the names of both.
        keeps_hand: whether the hand is empty at the end of every plan.
    """

    instance: Instance
    told: Instance
    reading: Reading
    words: Words
    keeps_hand: bool

    @property
    def options(self) -> PlanOptions:
        """What its plans may use: nothing falls."""
        return PlanOptions(topple=False)

    @property
    def exact(self) -> bool:
        """Whether the shortest plan here is the shortest there: all its steps are one action here, or all are two."""
        return kinds_of(self.reading) == {MOVE} or MOVE not in kinds_of(self.reading)

    @property
    def may_end_full(self) -> bool:
        """Whether a plan may end one step earlier with a block in the hand, and not be ours without its last place.

        Its last step then clears a block that the goal wants clear, of one that the goal says nothing of.
        """
        if self.keeps_hand:
            return False
        known = (*self.reading.meanings.values(), *self.reading.derived.values())
        if any(meaning.relation in _OF_A_HELD_BLOCK for meaning in known):
            return True
        goal = self.instance.goal
        assert isinstance(goal, OnGoal)
        said = {*goal.on, *goal.on.values(), *goal.ontable, *goal.clear}
        return bool(goal.clear) and not said.issuperset(self.instance.blocks)

    def bound(self, lower: int) -> int:
        """Return how many steps a plan of the problem has at least, where one of ours costs at least `lower`."""
        least = lower if self.keeps_hand else max(0, lower - 1)
        return (least + 1) // 2 if MOVE in kinds_of(self.reading) else least

    def steps(self, actions: Sequence[Action]) -> list[Step]:
        """Return the problem's steps for a legal plan.

        Raises:
            IllegalAction: where the law refuses an action.
            Unsupported: where no action of the problem does what one of ours does.
        """
        said = [_renamed(action, self.words.objects) for action in actions]
        told = exported(self.told, said, self.reading, moves=not self.reading.hand)
        return [self.words.of_pddl(step) for step in told.steps]

    def actions(self, steps: Iterable[Step]) -> list[Action]:
        """Return the law's actions for a plan of the problem.

        A block goes to the first empty stack where the plan puts it down; so does what is in the hand at its end.

        Raises:
            IllegalAction: where a step is not of the problem, it is not possible, or the goal is not reached.
        """
        plan = PlanText(tuple(map(self.words.in_pddl, steps)))
        try:
            actions = imported(self.told, plan, self.reading).actions
        except RefusedPlan as error:
            raise IllegalAction(str(error)) from None
        names = {word: name for name, word in self.words.objects.items()}
        return [_renamed(action, names) for action in actions]


def _renamed(action: Action, names: Mapping[str, str]) -> Action:
    assert isinstance(action, Pick | Place)
    return replace(action, block=names[action.block])


def read_classical(problem: Problem) -> Classical:
    """Read a classical blocks world of whatever kind the reader knows.

    Raises:
        Unsupported: where it is none, or has a part that is not supported, naming it.
        MalformedFile: where its facts describe no state of one.
        Infeasible: where its goal asks for what cannot be.
    """
    recognizer, text, words = _told(problem)
    try:
        blocks_problem(replace(text, goal=["and"]), recognizer)
    except Infeasible as error:  # what is wrong with the start is refused: a proof is about goals
        raise Unsupported(str(error)) from None
    read = blocks_problem(text, recognizer)
    itself = next((upper for upper, under in read.goal.on.items() if upper == under), None)
    if itself is not None:
        raise Unsupported(f"the goal wants {itself!r} on itself")
    names = {word: name for name, word in words.objects.items()}
    return Classical(
        instance=placed(_named(read, names), name=problem.name or "problem").instance,
        told=placed(read).instance,
        reading=read.reading,
        words=words,
        keeps_hand=read.keeps_hand or not read.reading.hand,
    )


def _told(problem: Problem) -> tuple[Recognizer, ProblemText, Words]:
    """Return the domain and the problem as the library writes them in PDDL, and what it calls their parts there."""
    from unified_planning.exceptions import UPException
    from unified_planning.io import PDDLWriter

    writer = PDDLWriter(problem)
    try:
        texts = writer.get_domain(), writer.get_problem()
        words = Words(
            {item.name: writer.get_pddl_name(item) for item in problem.all_objects},
            {action.name: writer.get_pddl_name(action) for action in problem.actions},
        )
    except (UPException, NotImplementedError, AssertionError) as error:
        raise Unsupported(f"PDDL cannot tell the problem ({error})") from None
    domain, text = (parse_expression(text, WHERE) for text in texts)
    return Recognizer(domain_from(domain, WHERE)), problem_from(text, WHERE), words


def _named(problem: BlocksProblem, names: Mapping[str, str]) -> BlocksProblem:
    """Return a problem with other names for its blocks."""
    start, goal = problem.start, problem.goal
    below = {names[upper]: None if under is None else names[under] for upper, under in start.below.items()}
    on = {names[upper]: names[under] for upper, under in goal.on.items()}
    ontable, clear = (tuple(names[block] for block in blocks) for blocks in (goal.ontable, goal.clear))
    return replace(
        problem,
        blocks=tuple(names[block] for block in problem.blocks),
        start=Arrangement(below, None if start.held is None else names[start.held]),
        goal=OnGoal(on, (), ontable, clear),
    )
