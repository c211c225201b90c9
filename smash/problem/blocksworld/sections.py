"""A PDDL problem file by its sections: objects, the facts of the start, the goal as it is written."""

from __future__ import annotations

import os
from collections.abc import Collection, Iterator, Sequence
from dataclasses import dataclass
from typing import NoReturn

from smash.problem.blocksworld.formula import CHANCE, Atom
from smash.problem.blocksworld.sexpr import Expression, parse_expression, show
from smash.problem.blocksworld.text import read_text
from smash.problem.blocksworld.typed import Types, typed_list
from smash.problem.errors import MalformedFile, Unsupported

SECTIONS = (":objects", ":init", ":goal")
SILENT_SECTIONS = frozenset({":domain", ":requirements", ":metric", ":length"})
UNSUPPORTED_SECTIONS = {":constraints": "constraints", ":htn": "task networks"}
TIMES = frozenset({"total-time", "is-violated"})


@dataclass(frozen=True)
class ProblemText:
    """What a problem file says, before anybody takes it for a blocks world.

    Attributes:
        where: the file.
        name: the problem's name.
        domain: the name of its domain; None where it says none.
        objects: its objects, with their types.
        facts: what its start says, each fact once, in order.
        denied: what its start says not to be.
        numeric: the values of functions at the start.
        goal: its goal.
    """

    where: str
    name: str
    domain: str | None
    objects: dict[str, Types]
    facts: tuple[Atom, ...]
    denied: frozenset[Atom]
    numeric: tuple[Expression, ...]
    goal: Expression

    @property
    def functions(self) -> tuple[str, ...]:
        """The functions that have a value at the start."""
        return tuple(dict.fromkeys(_of_number(entry)[0] for entry in self.numeric))

    def require_declared(self, constants: Collection[str], hint: str) -> None:
        """Refuse names that are neither an object nor a constant.

        Args:
            constants: the constants of the domain.
            hint: what may help, for the error.

        Raises:
            MalformedFile: about the first.
        """
        for atom in (*self.facts, *self.denied):
            for name in atom[1:]:
                if name not in self.objects and name not in constants:
                    problem = f"`:init`: {name!r} is not one of `:objects`, but stands in {show(list(atom))}{hint}"
                    raise MalformedFile(self.where, problem)
        for function in map(_of_number, self.numeric):
            for name in function[1:]:
                if name not in self.objects and name not in constants:
                    raise MalformedFile(self.where, f"`:init`: {name!r} is not one of `:objects`{hint}")


def _of_number(entry: Expression) -> Sequence[str]:
    """Return the function and arguments of `(= (weight a) 2)`."""
    function = entry[1]
    return [part for part in function if isinstance(part, str)] if isinstance(function, list) else []


def read_problem(path: str | os.PathLike[str]) -> ProblemText:
    """Read a problem file.

    Raises:
        MalformedFile: where it is no PDDL problem.
        Unsupported: where it says what no blocks world of this testbed can have, naming the part.
    """
    where = os.fspath(path)
    return problem_from(parse_expression(read_text(path), where), where)


def problem_from(document: Sequence[Expression], where: str) -> ProblemText:
    """Build the problem of a parsed file.

    Raises:
        MalformedFile: where it is no PDDL problem.
        Unsupported: where it says what no blocks world of this testbed can have, naming the part.
    """
    match document:
        case ["define", ["problem", str(name)], *sections]:
            return _Reader(where).problem(name, sections)
        case ["define", ["domain", *_], *_]:
            raise MalformedFile(where, "a PDDL domain; a problem file, `(define (problem …) …)`, is wanted")
    raise MalformedFile(where, "no PDDL problem; `(define (problem NAME) …)` is wanted")


class _Reader:
    def __init__(self, where: str) -> None:
        self.where = where
        self.facts: dict[Atom, None] = {}
        self.denied: dict[Atom, None] = {}
        self.numeric: list[Expression] = []

    def refuse(self, problem: str) -> NoReturn:
        raise MalformedFile(self.where, problem)

    def unsupported(self, what: str) -> NoReturn:
        raise Unsupported(f"{self.where}: {what}; not supported")

    def problem(self, name: str, listed: Sequence[Expression]) -> ProblemText:
        sections = self._sections(listed)
        objects: dict[str, Types] = {}
        for called, types in typed_list(sections.get(":objects", []), self.where, ":objects"):
            if called in objects:
                self.refuse(f"`:objects`: {called!r} stands twice (PDDL ignores case)")
            objects[called] = types
        for entry in _flat(sections[":init"]):
            self._fact(entry)
        both = next((atom for atom in self.denied if atom in self.facts), None)
        if both is not None:
            self.refuse(f"`:init`: {show(list(both))} is said, and denied too")
        goal = sections[":goal"]
        if len(goal) != 1 or not isinstance(goal[0], list):
            self.refuse("`:goal`: one atom or one `(and …)` is allowed")
        domain = sections.get(":domain", [None])
        return ProblemText(
            where=self.where,
            name=name,
            domain=domain[0] if domain and isinstance(domain[0], str) else None,
            objects=objects,
            facts=tuple(self.facts),
            denied=frozenset(self.denied),
            numeric=tuple(self.numeric),
            goal=goal[0],
        )

    def _sections(self, listed: Sequence[Expression]) -> dict[str, list[Expression]]:
        sections: dict[str, list[Expression]] = {}
        for section in listed:
            if not isinstance(section, list) or not section or not isinstance(section[0], str):
                self.refuse(f"{show(section)} is no section; `(:objects …)`, `(:init …)` and `(:goal …)` are allowed")
            key = section[0]
            if key in sections:
                self.refuse(f"the section `{key}` stands twice")
            if key in UNSUPPORTED_SECTIONS:
                self.unsupported(f"{UNSUPPORTED_SECTIONS[key]} (`{key}`)")
            if key not in SILENT_SECTIONS and key not in SECTIONS:
                self.refuse(f"the section `{key}` is not known to a blocks world")
            sections[key] = section[1:]
        for key in (":init", ":goal"):
            if key not in sections:
                self.refuse(f"the section `{key}` is missing")
        metric = sections.get(":metric", [])
        if metric[:1] == ["maximize"]:
            self.unsupported("a metric that is to be as large as can be, maximize (`:metric`)")
        measured = next((word for word in _words(metric) if word in TIMES), None)
        if measured is not None:
            self.unsupported(f"a metric of {measured} (`:metric`)")
        return sections

    def _fact(self, entry: Expression) -> None:
        match entry:
            case ["=", [str(), *arguments], str(value)] if all(isinstance(name, str) for name in arguments):
                if not _is_number(value):
                    self.unsupported(f"`:init`: {show(entry)}, a function whose value is an object")
                self.numeric.append(entry)
            case ["at", str(moment), [*_]] if _is_number(moment):
                self.unsupported(f"`:init`: {show(entry)}, a fact of a later time")
            case [str(word), *_] if word in CHANCE or word in ("or", "exists", "forall"):
                self.unsupported(f"`:init`: {show(entry)}, a start that is not known")
            case ["not", [str(predicate), *arguments]] if all(isinstance(name, str) for name in arguments):
                self.denied[(predicate, *(name for name in arguments if isinstance(name, str)))] = None
            case [str(predicate), *arguments] if all(isinstance(name, str) for name in arguments):
                self.facts[(predicate, *(name for name in arguments if isinstance(name, str)))] = None
            case _:
                self.refuse(f"`:init`: {show(entry)} is no fact")


def _is_number(word: str) -> bool:
    try:
        float(word)
    except ValueError:
        return False
    return True


def _flat(entries: Sequence[Expression]) -> Iterator[Expression]:
    """Yield the facts of nested conjunctions; the empty one has none."""
    for entry in entries:
        if isinstance(entry, list) and entry and entry[0] == "and":
            yield from _flat(entry[1:])
        elif entry:
            yield entry


def _words(expression: Sequence[Expression]) -> Iterator[str]:
    for part in expression:
        if isinstance(part, str):
            yield part
        else:
            yield from _words(part)
