"""The goal of a blocks-world problem as an `on` goal: a conjunction of positive facts, in whatever dress."""

from __future__ import annotations

import itertools
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from typing import NoReturn

from smash.problem.blocksworld.formula import COMPARISONS, Atom
from smash.problem.blocksworld.reading import Reading
from smash.problem.blocksworld.sexpr import Expression, show
from smash.problem.blocksworld.typed import OBJECT, Types, TypeTree, typed_list
from smash.problem.blocksworld.world import Meaning
from smash.problem.errors import Infeasible, MalformedFile, Unsupported
from smash.problem.model import OnGoal

UNSUPPORTED = {
    "or": "a disjunction",
    "exists": "an existential quantifier",
    "imply": "an implication",
    "not": "a negative goal",
    "preference": "a preference",
    "when": "a conditional goal",
} | dict.fromkeys(
    ("always", "sometime", "within", "at", "at-most-once", "sometime-after", "sometime-before", "hold-after"),
    "a trajectory constraint",
)
"""The words of a goal that are known, and not supported, with what they stand for."""
MOST_FACTS = 2_000_000
"""The most facts that quantifiers may stand for."""


@dataclass
class GoalReader:
    """Reads one goal.

    Attributes:
        where: the file, for errors.
        reading: what the predicates say.
        objects: every object, with its types.
        blocks: those that are blocks.
        types: the hierarchy of types.
        facts: the facts of the start: those that never change hold at the end too.
        changing: the predicates that actions change or rules derive; None where no domain says so.
        keeps_hand: whether the goal that was read wants the hand empty.
    """

    where: str
    reading: Reading
    objects: Mapping[str, Types]
    blocks: frozenset[str]
    types: TypeTree
    facts: frozenset[Atom]
    changing: frozenset[str] | None
    on: dict[str, str] = field(default_factory=dict)
    ontable: dict[str, None] = field(default_factory=dict)
    clear: dict[str, None] = field(default_factory=dict)
    keeps_hand: bool = False
    _taken: int = 0

    def goal(self, expression: Expression) -> OnGoal:
        """Return the goal.

        Raises:
            MalformedFile: where it is none.
            Unsupported: where it has a part that is not supported, naming it.
            Infeasible: where it asks for what cannot be, and the format has no words for that.
        """
        self._walk(expression, {})
        return OnGoal(self.on, (), tuple(self.ontable), tuple(self.clear))

    def refuse(self, problem: str) -> NoReturn:
        """Refuse what is no goal."""
        raise MalformedFile(self.where, f"`:goal`: {problem}")

    def unsupported(self, expression: Expression, what: str) -> NoReturn:
        """Refuse what the format has no words for."""
        raise Unsupported(f"{self.where}: `:goal`: {what}, {show(expression)}; not supported")

    def infeasible(self, problem: str) -> NoReturn:
        """Refuse what never holds."""
        raise Infeasible(f"{self.where}: `:goal`: {problem}")

    def _walk(self, expression: Expression, binding: Mapping[str, str]) -> None:
        match expression:
            case []:
                return
            case ["and", *parts]:
                for part in parts:
                    self._walk(part, binding)
            case ["forall", [*variables], part]:
                for bound in self._bindings(variables):
                    self._walk(part, {**binding, **bound})
            case ["=", str(one), str(other)] | ["not", ["=", str(one), str(other)]]:
                same = self._named(one, binding) == self._named(other, binding)
                if same != (expression[0] == "="):
                    self.infeasible(f"{show(expression)} never holds")
            case [str(predicate), *arguments] if all(isinstance(name, str) for name in arguments):
                names = [self._named(name, binding) for name in arguments if isinstance(name, str)]
                self._fact((predicate, *names))
            case _:
                self._no_conjunct(expression)

    def _no_conjunct(self, expression: Expression) -> NoReturn:
        match expression:
            case [str(word), *_] if word in COMPARISONS or word == "=":
                self.unsupported(expression, "a condition on numbers")
            case [str(word), *_] if word in UNSUPPORTED:
                self.unsupported(expression, UNSUPPORTED[word])
        self.refuse(f"{show(expression)} is no goal; facts and conjunctions of them are allowed")

    def _bindings(self, variables: Sequence[Expression]) -> Iterator[dict[str, str]]:
        typed = typed_list(variables, self.where, ":goal")
        names = [name for name, _ in typed]
        for things in itertools.product(*(self._range(types) for _, types in typed)):
            yield dict(zip(names, things, strict=True))

    def _range(self, types: Types) -> list[str]:
        """Return the objects of some types; without a domain all blocks where none is said to be of them."""
        things = [name for name, own in self.objects.items() if self.types.fits(own, types)]
        if things or OBJECT in types or self.changing is not None:
            return things
        return [name for name in self.objects if name in self.blocks]

    def _named(self, name: str, binding: Mapping[str, str]) -> str:
        if name in binding:
            return binding[name]
        if name not in self.objects:
            self.refuse(f"{name!r} is not one of `:objects`")
        return name

    def _fact(self, atom: Atom) -> None:
        self._taken += 1
        if self._taken > MOST_FACTS:
            raise Unsupported(f"{self.where}: `:goal`: its quantifiers stand for more than {MOST_FACTS:,} facts")
        meaning = self.reading.meanings.get(atom[0]) or self.reading.derived.get(atom[0])
        if meaning is None:
            self._other(atom)
            return
        if len(atom) - 1 != len(meaning.places) + len(meaning.fixed):
            self.refuse(f"{show(list(atom))} has another number of arguments than elsewhere")
        if any(atom[1 + place] != thing for place, thing in meaning.fixed):
            self.infeasible(f"{show(list(atom))} never holds")
        about = meaning.blocks_of(atom[1:])
        if all(block in self.blocks for block in about):
            self._relation(atom, meaning, about)
        elif meaning.relation == "on" and meaning.positive and about[0] in self.blocks and self._is_table(about[1]):
            self._rest_on_table(about[0])
        elif meaning.relation == "on":
            self.infeasible(f"{show(list(atom))} never holds")
        elif atom not in self.facts:  # some domains say of the table that it is clear once something was taken off it
            self.unsupported(list(atom), "more than where blocks are")

    def _is_table(self, name: str) -> bool:
        return name == self.reading.table

    def _other(self, atom: Atom) -> None:
        """Take a fact that is none about blocks: one that never changes, or nobody knows what it is."""
        fact = show(list(atom))
        if self.changing is None:
            if atom[0] in {name for types in self.objects.values() for name in types} | {"block", OBJECT}:
                return
            raise Unsupported(
                f"{self.where}: `:goal`: {fact} is not known without its domain (give it with --domain); "
                "on, ontable and clear are"
            )
        if atom[0] in self.changing:
            self.unsupported(list(atom), "more than where blocks are")
        if atom not in self.facts:
            self.infeasible(f"{fact} does not hold at the start, and no action changes it")

    def _relation(self, atom: Atom, meaning: Meaning, about: tuple[str, ...]) -> None:
        match meaning.relation, meaning.positive:
            case "on", True:
                upper, under = about
                if self.on.get(upper, under) != under:
                    one, other = self.reading.fact("on", upper, self.on[upper]), show(list(atom))
                    self.infeasible(f"{one} and {other} never hold together")
                self.on[upper] = under
            case ("ontable", True) | ("lying", False):
                self._rest_on_table(about[0])
            case ("clear" | "uncovered", True):
                self.clear[about[0]] = None
            case "handempty", True:
                self.keeps_hand = True
            case "holding", False:
                return
            case ("holding", True) | ("handempty", False):
                self.unsupported(list(atom), "a block in the hand at the end")
            case "above", True:
                self.unsupported(list(atom), "a block above another, at whatever height")
            case _:
                self.unsupported(list(atom), "a negative goal")

    def _rest_on_table(self, block: str) -> None:
        self.ontable[block] = None
