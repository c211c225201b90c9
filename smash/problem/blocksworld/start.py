"""The start of a blocks-world problem: its facts as an arrangement, which has to be all that they say."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterator, Sequence
from typing import NoReturn

from smash.problem.blocksworld.formula import Atom
from smash.problem.blocksworld.reading import Reading
from smash.problem.blocksworld.sexpr import show
from smash.problem.blocksworld.world import Arrangement, Meaning
from smash.problem.errors import Infeasible, MalformedFile, Unsupported


def start_of(reading: Reading, blocks: Sequence[str], facts: Sequence[Atom], where: str) -> Arrangement:
    """Return the arrangement that facts tell, its towers in the order in which the facts name their bases.

    Args:
        reading: what the predicates say.
        blocks: all blocks.
        facts: the facts of the start.
        where: the file, for errors.

    Raises:
        MalformedFile: where they contradict themselves, or do not say where a block is.
        Infeasible: where no action applies to the start.
        Unsupported: where an object that the facts call a block is none to some action.
    """
    return _Start(reading, blocks, where).arrangement(facts)


class _Start:
    def __init__(self, reading: Reading, blocks: Sequence[str], where: str) -> None:
        self.reading = reading
        self.blocks = blocks
        self.known = frozenset(blocks)
        self.where = where
        self.said: dict[str, list[tuple[str, ...]]] = defaultdict(list)
        """Predicate -> the blocks that it is said of."""
        self.on: dict[str, str] = {}
        self.ontable: dict[str, None] = {}
        self.held: dict[str, None] = {}

    def refuse(self, problem: str) -> NoReturn:
        raise MalformedFile(self.where, f"`:init`: {problem}")

    def arrangement(self, facts: Sequence[Atom]) -> Arrangement:
        for atom in facts:
            meaning = self.reading.meanings.get(atom[0])
            if meaning is not None:
                self._take(atom, meaning)
        for upper, under in self.on.items():
            if upper in self.ontable:
                self.refuse(f"{upper!r} is on {under!r} and on the table")
        held = self._in_hand()
        if held is not None and (held in self.on or held in self.ontable):
            self.refuse(f"the hand holds {held!r}, which lies on something")
        state = Arrangement(self._below(held), held)
        self._check_piles(state)
        self._check_all(state)
        return state

    def _take(self, atom: Atom, meaning: Meaning) -> None:
        """Take up a fact; facts about the table are about what lies on it, or say nothing."""
        if len(atom) - 1 != len(meaning.places) + len(meaning.fixed):
            self.refuse(f"{show(list(atom))} has another number of arguments than elsewhere")
        about = meaning.blocks_of(atom[1:])
        if self.reading.table is not None and self.reading.table in about:
            self._take_of_table(atom, meaning, about)
            return
        for block in about:
            self._block(block, atom)
        self.said[atom[0]].append(about)
        if not meaning.positive:
            return
        match meaning.relation:
            case "on":
                upper, under = about
                if self.on.get(upper, under) != under:
                    self.refuse(f"{upper!r} is on {self.on[upper]!r} and on {under!r}")
                self.on[upper] = under
            case "ontable":
                self.ontable[about[0]] = None
            case "holding":
                self.held[about[0]] = None

    def _take_of_table(self, atom: Atom, meaning: Meaning, about: tuple[str, ...]) -> None:
        if meaning.relation != "on" or not meaning.positive:
            return
        if about[0] == self.reading.table:
            self.refuse(f"{show(list(atom))}: the table lies on nothing")
        self.ontable[self._block(about[0], atom)] = None

    def _block(self, name: str, atom: Atom) -> str:
        if name in self.known:
            return name
        if self.reading.by_name:
            self.refuse(f"{show(list(atom))}: {name!r} is no block")
        raise Unsupported(
            f"{self.where}: `:init`: {show(list(atom))}: some action does not take {name!r}, by its type; not supported"
        )

    def _in_hand(self) -> str | None:
        """Return the held block: the one that is said to be, or, where nothing says so, the one that is nowhere."""
        if len(self.held) > 1:
            one, other = list(self.held)[:2]
            self.refuse(f"the hand holds {one!r} and {other!r}")
        if self.held or not self.reading.hand or self.reading.predicate_of("holding") is not None:
            return next(iter(self.held), None)
        if not self._tells_bases():
            return None
        nowhere = [block for block in self.blocks if block not in self.on and block not in self.ontable]
        return nowhere[0] if len(nowhere) == 1 else None

    def _tells_bases(self) -> bool:
        return self.reading.table is not None or self.reading.predicate_of("ontable") is not None

    def _below(self, held: str | None) -> dict[str, str | None]:
        """Return what each block lies on; the bases come first."""
        bases: dict[str, str | None] = dict.fromkeys(self.ontable)
        if not self._tells_bases():
            bases = dict.fromkeys(block for block in self.blocks if block not in self.on and block != held)
        return bases | self.on

    def _check_piles(self, state: Arrangement) -> None:
        """Refuse piles that fork, float or go in a circle."""
        carried: dict[str, str] = {}
        for upper, under in self.on.items():
            other = carried.setdefault(under, upper)
            if other != upper:
                self.refuse(f"{other!r} and {upper!r} are both on {under!r}")
        if state.held is not None and state.held in state.above:
            self.refuse(f"{state.above[state.held]!r} is on {state.held!r}, which the hand holds")
        standing = {block for tower in state.towers() for block in tower}
        for block in self.blocks:
            if block not in standing and block != state.held:
                self.refuse(f"{block!r} does not stand on the table, nor on a block that does")

    def _check_all(self, state: Arrangement) -> None:
        """Refuse what is said and is not so, then what is so and is not said."""
        for predicate, meaning in self.reading.meanings.items():
            for about in self.said[predicate]:
                if not meaning.true_of(state, about) and not (meaning.relation == "clear" and about[0] == state.held):
                    self._contradiction(state, predicate, meaning, about)
        missing = [gap for predicate in self.reading.meanings for gap in self._gaps(state, predicate)]
        idle = [gap for gap in missing if gap[0] == "handempty" or self._none_said(state, *gap)]
        for _, words in [*idle, *missing]:
            if idle and self.blocks:
                raise Infeasible(f"{self.where}: `:init`: {words}: no action applies to the start")
            self.refuse(words)

    def _contradiction(self, state: Arrangement, predicate: str, meaning: Meaning, about: tuple[str, ...]) -> NoReturn:
        fact = show(list(meaning.atom(predicate, about)))
        if meaning.relation in ("clear", "uncovered") and meaning.positive:
            self.refuse(f"{about[0]!r} is clear, but {state.above[about[0]]!r} is on it")
        if meaning.relation == "handempty" and meaning.positive:
            self.refuse(f"{fact}, but the hand holds {state.held!r}")
        self.refuse(f"{fact} contradicts what else is said")

    def _gaps(self, state: Arrangement, predicate: str) -> Iterator[tuple[str, str]]:
        """Yield the first fact of a predicate that is so and is not said: the relation, and words."""
        meaning = self.reading.meanings[predicate]
        said = {about for about in self.said[predicate] if meaning.true_of(state, about)}
        whole = meaning.count(state, len(self.blocks))
        if whole is None or len(said) >= whole or len(meaning.places) > 1:
            return
        everybody: list[tuple[str, ...]] = [(block,) for block in self.blocks] if meaning.places else [()]
        for about in everybody:
            if about not in said and meaning.true_of(state, about):
                fact = show(list(meaning.atom(predicate, about)))
                why = f"nothing lies on {about[0]!r}, but " if meaning.relation == "clear" else ""
                yield meaning.relation if meaning.positive else "", f"{why}{fact} is not said"
                return

    def _none_said(self, state: Arrangement, relation: str, words: str) -> bool:
        """Whether no block is said to be clear, so that none can be taken."""
        names = [name for name, meaning in self.reading.meanings.items() if meaning.relation == relation]
        return relation == "clear" and state.held is None and not any(self.said[name] for name in names)
