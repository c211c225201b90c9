"""A PDDL domain: what its actions ask for and do, whatever it is about."""

from __future__ import annotations

import os
from collections.abc import Sequence
from dataclasses import dataclass, field
from functools import cached_property
from typing import NoReturn

from smash.problem.blocksworld.formula import Atom, Condition, Effect, Formulas
from smash.problem.blocksworld.sexpr import Expression, parse_expression, show
from smash.problem.blocksworld.text import read_text
from smash.problem.blocksworld.typed import Types, TypeTree, typed_list
from smash.problem.errors import MalformedFile, Unsupported

UNSUPPORTED_SECTIONS = {
    ":durative-action": "durative actions",
    ":process": "processes",
    ":event": "events",
    ":constraints": "constraints",
}
SILENT_SECTIONS = frozenset({":requirements", ":predicates", ":functions", ":extends", ":metric", ":domain"})


@dataclass(frozen=True)
class Action:
    """One action schema.

    Attributes:
        name: its name.
        parameters: each variable, with its types.
        condition: what has to hold.
        effects: the literals that it makes true or false.
        atoms: every atom of its condition and its effects.
        reads: the predicates that its condition, or one of its effects, depends on.
        names: every name that stands in an atom or an equality.
    """

    name: str
    parameters: tuple[tuple[str, Types], ...]
    condition: Condition
    effects: tuple[Effect, ...]
    atoms: tuple[Atom, ...]
    reads: frozenset[str]
    names: frozenset[str]

    @property
    def writes(self) -> frozenset[str]:
        """The predicates that it changes."""
        return frozenset(effect.atom[0] for effect in self.effects)


@dataclass(frozen=True)
class Domain:
    """A PDDL domain.

    Attributes:
        name: its name.
        where: its file.
        types: the hierarchy of types.
        constants: the objects of every problem, with their types.
        actions: the action schemas.
        rules: derived predicate -> (parameters, condition).
        rule_atoms: every atom of a rule, its head first.
        rule_reads: derived predicate -> the predicates that its rule asks for.
        costs: what actions add to the total cost.
    """

    name: str
    where: str
    types: TypeTree = field(default_factory=TypeTree)
    constants: tuple[tuple[str, Types], ...] = ()
    actions: tuple[Action, ...] = ()
    rules: dict[str, tuple[tuple[str, ...], Condition]] = field(default_factory=dict)
    rule_atoms: tuple[tuple[Atom, ...], ...] = ()
    rule_reads: dict[str, frozenset[str]] = field(default_factory=dict)
    costs: frozenset[str] = frozenset()

    @cached_property
    def fluents(self) -> dict[str, int]:
        """The predicates that actions change, as they are named, and how many arguments they have."""
        found: dict[str, int] = {}
        for action in self.actions:
            written = action.writes
            found |= {atom[0]: len(atom) - 1 for atom in action.atoms if atom[0] in written and atom[0] not in found}
        return found

    @cached_property
    def even(self) -> bool:
        """Whether every action costs the same."""
        return len(self.costs) <= 1


def read_domain(path: str | os.PathLike[str]) -> Domain:
    """Read a domain file.

    Raises:
        MalformedFile: where it is no PDDL domain.
        Unsupported: where it says what no blocks world of this testbed can have, naming the part.
    """
    where = os.fspath(path)
    return domain_from(parse_expression(read_text(path), where), where)


def domain_from(document: Sequence[Expression], where: str) -> Domain:
    """Build the domain of a parsed file.

    Raises:
        MalformedFile: where it is no PDDL domain.
        Unsupported: where it says what no blocks world of this testbed can have, naming the part.
    """
    match document:
        case ["define", ["domain", str(name)], *sections]:
            return _Reader(where).domain(name, sections)
        case ["define", ["problem", *_], *_]:
            raise MalformedFile(where, "a PDDL problem; a domain file, `(define (domain NAME) …)`, is wanted")
    raise MalformedFile(where, "no PDDL domain; `(define (domain NAME) …)` is wanted")


class _Reader:
    def __init__(self, where: str) -> None:
        self.where = where
        self.costs: set[str] = set()

    def refuse(self, problem: str) -> NoReturn:
        raise MalformedFile(self.where, problem)

    def domain(self, name: str, sections: Sequence[Expression]) -> Domain:
        types, constants = TypeTree(), []
        actions: dict[str, Action] = {}
        rules: dict[str, tuple[tuple[str, ...], Condition]] = {}
        rule_atoms: list[tuple[Atom, ...]] = []
        rule_reads: dict[str, frozenset[str]] = {}
        for section in sections:
            match section:
                case [":types", *listed]:
                    types = TypeTree.of(listed, self.where)
                case [":constants", *listed]:
                    constants = typed_list(listed, self.where, ":constants")
                case [":action", str(called), *parts]:
                    if called in actions:
                        self.refuse(f"the action {called!r} stands twice")
                    actions[called] = self._action(called, parts)
                case [":derived", [str(predicate), *listed], condition]:
                    if predicate in rules:
                        raise Unsupported(f"{self.where}: two rules derive {predicate!r}; one is supported")
                    formulas = Formulas(self.where, f"the rule of {predicate!r}")
                    names = tuple(variable for variable, _ in typed_list(listed, self.where, predicate))
                    rules[predicate] = (names, formulas.condition(condition))
                    rule_atoms.append(((predicate, *names), *formulas.atoms))
                    rule_reads[predicate] = frozenset(formulas.read)
                case [str(key), *_] if key in UNSUPPORTED_SECTIONS:
                    raise Unsupported(f"{self.where}: {UNSUPPORTED_SECTIONS[key]} (`{key}`); not supported")
                case [str(key), *_] if key in SILENT_SECTIONS:
                    continue
                case _:
                    self.refuse(f"{show(section)} is no section of a domain")
        return Domain(
            name=name,
            where=self.where,
            types=types,
            constants=tuple(constants),
            actions=tuple(actions.values()),
            rules=rules,
            rule_atoms=tuple(rule_atoms),
            rule_reads=rule_reads,
            costs=frozenset(self.costs),
        )

    def _action(self, name: str, parts: Sequence[Expression]) -> Action:
        owner = f"action {name!r}"
        given: dict[str, Expression] = {}
        for key, value in zip(parts[::2], parts[1::2], strict=False):
            if not isinstance(key, str) or key not in (":parameters", ":precondition", ":effect", ":vars"):
                self.refuse(f"{owner}: {show(key)} is not allowed; :parameters, :precondition and :effect are")
            given[key] = value
        if len(parts) % 2:
            self.refuse(f"{owner}: {show(parts[-1])} stands alone")
        formulas = Formulas(self.where, owner)
        listed = [given.get(":parameters", []), given.get(":vars", [])]
        variables = [entry for part in listed if isinstance(part, list) for entry in part]
        parameters = tuple(typed_list(variables, self.where, f"{owner}: :parameters"))
        condition = formulas.condition(given.get(":precondition", []))
        effects = tuple(formulas.effects(given.get(":effect", [])))
        self.costs |= formulas.costs or {"0"}
        names = formulas.compared.union(*(atom[1:] for atom in formulas.atoms))
        return Action(
            name, parameters, condition, effects, tuple(formulas.atoms), frozenset(formulas.read), frozenset(names)
        )
