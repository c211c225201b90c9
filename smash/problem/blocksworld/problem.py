"""Blocks-world problems in PDDL as problems of the testbed: with their domain, or by the usual names.

The classical table holds every block at once, and the testbed's has locations: where the towers go is `placing`'s.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from smash.problem.blocksworld.by_name import reading_by_name
from smash.problem.blocksworld.domain import Domain
from smash.problem.blocksworld.goals import GoalReader
from smash.problem.blocksworld.reading import Reading
from smash.problem.blocksworld.roles import Recognizer
from smash.problem.blocksworld.sections import ProblemText
from smash.problem.blocksworld.start import start_of
from smash.problem.blocksworld.typed import Types, TypeTree
from smash.problem.blocksworld.world import Arrangement
from smash.problem.errors import MalformedFile
from smash.problem.model import OnGoal

GIVE_DOMAIN = "; what a domain declares is known with --domain alone"


@dataclass(frozen=True)
class BlocksProblem:
    """A blocks-world problem as it was read.

    Attributes:
        where: its file.
        name: its name.
        domain: the name of its domain, as the problem has it.
        blocks: its blocks, in the order of the file.
        start: the arrangement that it starts from.
        goal: what it wants.
        reading: how the file tells it.
        unknown: predicates of the start that were passed over without a domain that says what they are.
        costs_differ: whether some of its domain's actions cost more than others.
        keeps_hand: whether its goal wants the hand empty.
    """

    where: str
    name: str
    domain: str | None
    blocks: tuple[str, ...]
    start: Arrangement
    goal: OnGoal
    reading: Reading
    unknown: tuple[str, ...] = ()
    costs_differ: bool = False
    keeps_hand: bool = False


def blocks_problem(text: ProblemText, recognizer: Recognizer | None = None) -> BlocksProblem:
    """Return the blocks-world problem that a PDDL problem is.

    Args:
        text: the problem by its sections.
        recognizer: of its domain; None: the usual names are taken.

    Raises:
        MalformedFile: where it contradicts itself.
        Unsupported: where it is no blocks world, or has a part that is not supported, naming it.
        Infeasible: where no action applies, or where it asks for what cannot be and the format has no words for that.
    """
    domain = None if recognizer is None else recognizer.domain
    constants = {} if domain is None else dict(domain.constants)
    text.require_declared(constants, GIVE_DOMAIN if domain is None else "")
    objects = text.objects | {name: types for name, types in constants.items() if name not in text.objects}
    if recognizer is None or not objects:
        reading, unknown = reading_by_name(text)
    else:
        reading, unknown = recognizer.reading(objects, text.facts, text.where), ()
    blocks = tuple(name for name in objects if name not in reading.others and name != reading.table)
    try:
        start = start_of(reading, blocks, text.facts, text.where)
    except MalformedFile as error:
        if not unknown:
            raise
        hint = f" ({', '.join(unknown[:4])}: not known without the domain; give it with --domain)"
        raise MalformedFile(text.where, error.problem + hint) from None
    reader = _goal_reader(text, domain, reading, objects, blocks)
    return BlocksProblem(
        where=text.where,
        name=text.name,
        domain=text.domain,
        blocks=blocks,
        start=start,
        goal=reader.goal(text.goal),
        reading=reading,
        unknown=unknown,
        costs_differ=domain is not None and not domain.even,
        keeps_hand=reader.keeps_hand,
    )


def _goal_reader(
    text: ProblemText, domain: Domain | None, reading: Reading, objects: dict[str, Types], blocks: Sequence[str]
) -> GoalReader:
    return GoalReader(
        where=text.where,
        reading=reading,
        objects=objects,
        blocks=frozenset(blocks),
        types=TypeTree() if domain is None else domain.types,
        facts=frozenset(text.facts),
        changing=None if domain is None else frozenset({*domain.fluents, *domain.rules}),
    )
