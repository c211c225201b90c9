"""Conditions and effects of PDDL actions, evaluated: what an action does to a set of facts.

Conditions have three values: None where they depend on a predicate that is left open, as while its meaning is searched.
"""

from __future__ import annotations

import itertools
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from typing import NoReturn

from smash.problem.blocksworld.sexpr import Expression, show
from smash.problem.blocksworld.typed import Types, typed_list
from smash.problem.errors import MalformedFile, Unsupported

Atom = tuple[str, ...]
"""A predicate and its arguments."""
Binding = Mapping[str, str]
"""Variable -> object."""
Truth = bool | None
COMPARISONS = frozenset({"<", ">", "<=", ">="})
CONNECTIVES = frozenset({"and", "or", "not", "imply", "forall", "exists", "when", "=", "preference"}) | COMPARISONS
ARITHMETIC = frozenset({"increase", "decrease", "assign", "scale-up", "scale-down"})
CHANCE = frozenset({"oneof", "probabilistic", "unknown"})
TOTAL_COST: Expression = ["total-cost"]


@dataclass
class Facts:
    """What holds: the facts of a state, beside those that never change and those that follow from rules.

    Attributes:
        state: the facts of the state.
        always: the facts that no action changes.
        open: predicates of which it is not known what they say.
        rules: derived predicate -> (its parameters, its condition).
        things: types -> the objects that fit.
    """

    state: frozenset[Atom]
    always: frozenset[Atom]
    open: frozenset[str]
    rules: Mapping[str, tuple[Sequence[str], Condition]]
    things: Callable[[Types], Sequence[str]]
    _asked: set[Atom] = field(default_factory=set)

    def holds(self, atom: Atom) -> Truth:
        """Return whether a fact holds; one that a rule derives from itself does not."""
        if atom[0] in self.rules:
            if atom in self._asked:
                return False
            self._asked.add(atom)
            parameters, condition = self.rules[atom[0]]
            truth = condition(self, dict(zip(parameters, atom[1:], strict=False)))
            self._asked.remove(atom)
            return truth
        return None if atom[0] in self.open else atom in self.state or atom in self.always


Condition = Callable[[Facts, Binding], Truth]


@dataclass(frozen=True, slots=True)
class Effect:
    """One literal that an action makes true or false, for all `variables` of which `condition` holds."""

    variables: tuple[tuple[str, Types], ...]
    condition: Condition | None
    positive: bool
    atom: Atom


class Formulas:
    """Compiles the conditions and effects of one file."""

    def __init__(self, where: str, owner: str) -> None:
        """Make a compiler.

        Args:
            where: the file, for errors.
            owner: whose formulas these are (`action stack`), for errors.
        """
        self.where = where
        self.owner = owner
        self.read: set[str] = set()
        """The predicates that conditions ask for."""
        self.atoms: list[Atom] = []
        """Every atom, with the variables and constants that stand in it."""
        self.compared: set[str] = set()
        """The names that stand in an equality."""
        self.costs: set[str] = set()
        """What actions add to the total cost."""

    def malformed(self, problem: str) -> NoReturn:
        """Refuse what is no PDDL."""
        raise MalformedFile(self.where, f"{self.owner}: {problem}")

    def unsupported(self, what: str) -> NoReturn:
        """Refuse what is PDDL, and of no blocks world here."""
        raise Unsupported(f"{self.where}: {self.owner}: {what}; not supported")

    def condition(self, expression: Expression) -> Condition:
        """Compile a condition.

        Raises:
            MalformedFile: where it is none.
            Unsupported: where it speaks of numbers or preferences.
        """
        match expression:
            case [] | ["and"]:
                return lambda facts, binding: True
            case ["and", *parts]:
                return _all([self.condition(part) for part in parts])
            case ["or", *parts]:
                return _not(_all([_not(self.condition(part)) for part in parts]))
            case ["imply", condition, conclusion]:
                return _not(_all([self.condition(condition), _not(self.condition(conclusion))]))
            case ["not", part]:
                return _not(self.condition(part))
            case ["forall", [*variables], part]:
                return self._forall(variables, self.condition(part))
            case ["exists", [*variables], part]:
                return _not(self._forall(variables, _not(self.condition(part))))
        return self._fact_condition(expression)

    def _fact_condition(self, expression: Expression) -> Condition:
        match expression:
            case ["=", str(one), str(other)]:
                self.compared |= {one, other}
                return lambda facts, binding: binding.get(one, one) == binding.get(other, other)
            case [str(word), *_] if word in COMPARISONS or word == "=":
                self.unsupported(f"the numeric condition {show(expression)}")
            case ["preference", *_]:
                self.unsupported("a preference")
            case [str(predicate), *arguments] if predicate not in CONNECTIVES:
                atom = self._atom(predicate, arguments)
                self.read.add(predicate)
                return lambda facts, binding: facts.holds(_ground(atom, binding))
        self.malformed(f"{show(expression)} is no condition")

    def effects(
        self, expression: Expression, variables: tuple[tuple[str, Types], ...] = (), when: Condition | None = None
    ) -> Iterator[Effect]:
        """Compile an effect to its literals.

        Args:
            expression: the effect.
            variables: the quantified variables around it, with their types.
            when: the condition around it.

        Raises:
            MalformedFile: where it is none.
            Unsupported: where it changes numbers, or leaves something to chance.
        """
        match expression:
            case []:
                return
            case ["and", *parts]:
                for part in parts:
                    yield from self.effects(part, variables, when)
            case ["forall", [*listed], part]:
                typed = tuple(typed_list(listed, self.where, self.owner))
                yield from self.effects(part, (*variables, *typed), when)
            case ["when", condition, part]:
                also = self.condition(condition)
                yield from self.effects(part, variables, also if when is None else _all([when, also]))
            case ["increase", cost, amount] if cost == TOTAL_COST:
                self.costs.add(show(amount))
            case ["not", [str(predicate), *arguments]] if predicate not in CONNECTIVES:
                yield Effect(variables, when, False, self._atom(predicate, arguments))
            case [str(word), *arguments] if word not in CONNECTIVES | ARITHMETIC | CHANCE:
                yield Effect(variables, when, True, self._atom(word, arguments))
            case _:
                self._no_effect(expression)

    def _no_effect(self, expression: Expression) -> NoReturn:
        match expression:
            case [str(word), *_] if word in ARITHMETIC:
                self.unsupported(f"the numeric effect {show(expression)}")
            case [str(word), *_] if word in CHANCE:
                self.unsupported(f"an effect of chance (`{word}`)")
        self.malformed(f"{show(expression)} is no effect")

    def _atom(self, predicate: str, arguments: Sequence[Expression]) -> Atom:
        names = [name for name in arguments if isinstance(name, str)]
        if len(names) != len(arguments):
            self.unsupported(f"a function as an argument in {show([predicate, *arguments])}")
        self.atoms.append((predicate, *names))
        return (predicate, *names)

    def _forall(self, variables: Sequence[Expression], part: Condition) -> Condition:
        typed = typed_list(variables, self.where, self.owner)
        names = [name for name, _ in typed]
        kinds = [types for _, types in typed]

        def holds(facts: Facts, binding: Binding) -> Truth:
            truth: Truth = True
            for things in itertools.product(*(facts.things(types) for types in kinds)):
                one = part(facts, {**binding, **dict(zip(names, things, strict=True))})
                if one is False:
                    return False
                truth = None if one is None else truth
            return truth

        return holds


def _ground(atom: Atom, binding: Binding) -> Atom:
    return (atom[0], *(binding.get(name, name) for name in atom[1:]))


def _all(parts: Sequence[Condition]) -> Condition:
    def holds(facts: Facts, binding: Binding) -> Truth:
        truth: Truth = True
        for part in parts:
            one = part(facts, binding)
            if one is False:
                return False
            truth = None if one is None else truth
        return truth

    return holds


def _not(part: Condition) -> Condition:
    def holds(facts: Facts, binding: Binding) -> Truth:
        one = part(facts, binding)
        return None if one is None else not one

    return holds


def after(facts: Facts, effects: Sequence[Effect], binding: Binding) -> frozenset[Atom] | None:
    """Return the state after an action's effects; None where that depends on what is left open."""
    added: set[Atom] = set()
    deleted: set[Atom] = set()
    for effect in effects:
        if effect.atom[0] in facts.open:
            continue
        names = [name for name, _ in effect.variables]
        for things in itertools.product(*(facts.things(types) for _, types in effect.variables)):
            whole = {**binding, **dict(zip(names, things, strict=True))} if names else binding
            truth = True if effect.condition is None else effect.condition(facts, whole)
            if truth is None:
                return None
            if truth:
                (added if effect.positive else deleted).add(_ground(effect.atom, whole))
    return (facts.state - deleted) | added
