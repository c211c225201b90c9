"""Blocks-world problems in PDDL (the IPC's and their common variants) as instances of the testbed.

The classical table holds every block at once: the instance has as many `stacks` as blocks, no buffer,
and an `on` goal. A pick and a place are the classical `unstack` or `pick-up` and `stack` or `put-down`,
so that costs without topple are the published plan lengths.
"""

from __future__ import annotations

import os
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from typing import NoReturn

from smash.problem.blocksworld.sexpr import Expression, parse_expression
from smash.problem.errors import MalformedFile
from smash.problem.files.documents import read_bytes
from smash.problem.making import make_instance
from smash.problem.model import Instance, OnGoal

HAND_EMPTY = frozenset({"handempty", "hand-empty", "armempty", "arm-empty"})
ON_TABLE = frozenset({"ontable", "on-table"})
TYPE_FACTS = frozenset({"block", "table", "object"})
ACTION_LITERALS = frozenset({"pickup", "pick-up", "putdown", "put-down", "stack", "unstack"})
"""Some collections name the actions in the initial state; they say nothing about it."""
HANDS = frozenset({"robot", "arm", "hand"})
"""Types of objects that are the hand and not a block."""
IGNORED_SECTIONS = frozenset({":domain", ":requirements", ":metric", ":length"})
THE_TABLE = "table"
"""Variants without `ontable` say `(on a table)`, with an object of this name."""


@dataclass(slots=True)
class _Facts:
    """The atoms of an initial state or of a goal."""

    on: dict[str, str] = field(default_factory=dict)
    ontable: list[str] = field(default_factory=list)
    clear: list[str] = field(default_factory=list)


def read_blocksworld(path: str | os.PathLike[str]) -> Instance:
    """Read a blocks-world problem file.

    Raises:
        MalformedFile: with one line that says what is wrong, and what is allowed.
    """
    where = os.fspath(path)
    try:
        text = read_bytes(path).decode("utf-8-sig")
    except UnicodeDecodeError:
        raise MalformedFile(where, "not UTF-8 text") from None
    return blocksworld_instance(text, where)


def blocksworld_instance(text: str, where: str = "problem") -> Instance:
    """Build the instance of a blocks-world problem in PDDL.

    Raises:
        MalformedFile: with one line that says what is wrong, and what is allowed.
    """
    return _Reader(where).instance(parse_expression(text, where))


class _Reader:
    """Reads one problem; refuses what the testbed's law cannot say."""

    def __init__(self, where: str) -> None:
        self.where = where
        self.blocks: tuple[str, ...] = ()

    def refuse(self, problem: str) -> NoReturn:
        raise MalformedFile(self.where, problem)

    def instance(self, document: Sequence[Expression]) -> Instance:
        match document:
            case ["define", ["problem", str(name)], *rest]:
                sections = self._sections(rest)
            case ["define", ["domain", *_], *_]:
                self.refuse("a PDDL domain; a problem file, `(define (problem …) …)`, is wanted")
            case _:
                self.refuse("no PDDL problem; `(define (problem NAME) …)` is wanted")
        self.blocks = self._objects(sections.get(":objects", []))
        atoms = [atom for entry in sections[":init"] for atom in _flat(entry)]
        start = self._start(self._facts(":init", atoms))
        goal = self._goal(self._facts(":goal", self._conjuncts(sections[":goal"])))
        stacks = [f"p{number}" for number in range(1, max(1, len(self.blocks)) + 1)]
        return make_instance(
            name=name,
            blocks=self.blocks,
            stacks=stacks,
            start=dict(zip(stacks, start, strict=False)),
            goal=goal,
            where=self.where,
        )

    def _sections(self, rest: Sequence[Expression]) -> dict[str, list[Expression]]:
        sections: dict[str, list[Expression]] = {}
        for section in rest:
            if not isinstance(section, list) or not section or not isinstance(section[0], str):
                self.refuse(f"{_show(section)} is no section; `(:objects …)`, `(:init …)` and `(:goal …)` are allowed")
            key = section[0]
            if key in sections:
                self.refuse(f"the section `{key}` stands twice")
            if key not in IGNORED_SECTIONS and key not in (":objects", ":init", ":goal"):
                self.refuse(f"the section `{key}` is not known to a blocks world")
            sections[key] = section[1:]
        for key in (":init", ":goal"):
            if key not in sections:
                self.refuse(f"the section `{key}` is missing")
        return sections

    def _objects(self, listed: Sequence[Expression]) -> tuple[str, ...]:
        names: list[str] = []
        untyped = 0
        entries = iter(listed)
        for entry in entries:
            if entry == "-":
                if next(entries, None) in HANDS:
                    del names[untyped:]
                untyped = len(names)
            elif isinstance(entry, str):
                names.append(entry)
            else:
                self.refuse(f"`:objects`: {_show(entry)} is no name")
        for name in names:
            if names.count(name) > 1:
                self.refuse(f"`:objects`: {name!r} stands twice (PDDL ignores case)")
        return tuple(name for name in names if name != THE_TABLE)

    def _conjuncts(self, goal: Sequence[Expression]) -> list[Expression]:
        if len(goal) != 1 or not isinstance(goal[0], list):
            self.refuse("`:goal`: one atom or one `(and …)` is allowed")
        return list(_flat(goal[0]))

    def _facts(self, part: str, atoms: Sequence[Expression]) -> _Facts:
        facts = _Facts()
        for atom in atoms:
            if not self._says_nothing(atom) and not self._relation(part, atom, facts):
                self.refuse(f"`{part}`: {_show(atom)} is not known; on, ontable, clear and handempty are allowed")
        facts.ontable = list(dict.fromkeys(facts.ontable))
        return facts

    def _says_nothing(self, atom: Expression) -> bool:
        """Whether an atom is true of every state at rest, or a comment of its collection."""
        match atom:
            case [str(predicate), *_] if predicate in HAND_EMPTY or predicate in ACTION_LITERALS:
                return True
            case [str(predicate), str()] if predicate in TYPE_FACTS:
                return True
            case ["clear", str(block)] if block == THE_TABLE:
                return True
            case ["=", ["total-cost"], str()]:
                return True
        return False

    def _relation(self, part: str, atom: Expression, facts: _Facts) -> bool:
        """Take up an atom that says where a block is; False where it says something else."""
        match atom:
            case ["on", str(upper), str(under)] if under == THE_TABLE:
                facts.ontable.append(self._block(part, upper))
            case ["on", str(upper), str(under)]:
                if facts.on.get(upper, under) != under:
                    self.refuse(f"`{part}`: {upper!r} is on {facts.on[upper]!r} and on {under!r}")
                facts.on[self._block(part, upper)] = self._block(part, under)
            case [str(predicate), str(block)] if predicate in ON_TABLE:
                facts.ontable.append(self._block(part, block))
            case ["clear", str(block)]:
                facts.clear.append(self._block(part, block))
            case ["holding", str(block)]:
                self.refuse(f"`{part}`: the hand holds {block!r}; it has to be empty")
            case _:
                return False
        return True

    def _block(self, part: str, name: str) -> str:
        if name not in self.blocks:
            self.refuse(f"`{part}`: {name!r} is not one of `:objects`")
        return name

    def _start(self, facts: _Facts) -> list[tuple[str, ...]]:
        above: dict[str, str] = {}
        for upper, under in facts.on.items():
            if under in above:
                self.refuse(f"`:init`: {above[under]!r} and {upper!r} are both on {under!r}")
            if upper in facts.ontable:
                self.refuse(f"`:init`: {upper!r} is on {under!r} and on the table")
            above[under] = upper
        for block in facts.clear:
            if block in above:
                self.refuse(f"`:init`: {block!r} is clear, but {above[block]!r} is on it")
        towers = []
        for base in facts.ontable:
            tower = [base]
            while tower[-1] in above:
                tower.append(above[tower[-1]])
            towers.append(tuple(tower))
        standing = {block for tower in towers for block in tower}
        for block in self.blocks:
            if block not in standing:
                self.refuse(f"`:init`: {block!r} does not stand on the table, nor on a block that does")
        return towers

    def _goal(self, facts: _Facts) -> OnGoal:
        carrying = set(facts.on.values())
        whole = all(block in facts.on or block in facts.ontable for block in self.blocks)
        for block in facts.clear:
            if block in carrying or not whole:
                self.refuse(f"`:goal`: (clear {block}) can be said only where the goal places every block around it")
        return OnGoal(dict(facts.on), tuple(facts.ontable))


def _flat(expression: Expression) -> Iterator[Expression]:
    """Yield the atoms of nested conjunctions; the empty one has none."""
    if isinstance(expression, list) and expression and expression[0] == "and":
        for part in expression[1:]:
            yield from _flat(part)
    elif expression:
        yield expression


def _show(expression: Expression) -> str:
    if isinstance(expression, str):
        return expression
    return "(" + " ".join(_show(part) for part in expression[:6]) + (" …" if len(expression) > 6 else "") + ")"
