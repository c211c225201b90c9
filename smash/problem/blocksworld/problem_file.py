"""A blocks-world problem file as an instance, by the usual names and with as many stacks as blocks."""

from __future__ import annotations

import os

from smash.problem.blocksworld.placing import placed
from smash.problem.blocksworld.problem import blocks_problem
from smash.problem.blocksworld.sections import problem_from, read_problem
from smash.problem.blocksworld.sexpr import parse_expression
from smash.problem.model import Instance


def read_blocksworld(path: str | os.PathLike[str]) -> Instance:
    """Read a blocks-world problem file.

    Raises:
        SmashError: with one line that says what is wrong, and what is allowed.
    """
    return placed(blocks_problem(read_problem(path))).instance


def blocksworld_instance(text: str, where: str = "problem") -> Instance:
    """Build the instance of a blocks-world problem in PDDL.

    Raises:
        SmashError: with one line that says what is wrong, and what is allowed.
    """
    return placed(blocks_problem(problem_from(parse_expression(text, where), where))).instance
