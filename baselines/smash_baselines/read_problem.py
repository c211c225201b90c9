"""A PDDL problem of our domains back to an instance: the compiler's inverse."""

from __future__ import annotations

import json
import re
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any, NoReturn

from smash.problem.errors import MalformedFile
from smash.problem.making import make_instance
from smash.problem.model import Goal, Instance, OnGoal, PlanOptions, PositionsGoal, StacksGoal
from smash_baselines.encodings import BY_DOMAIN, Encoding
from smash_baselines.facts import facts_of
from smash_baselines.goal_words import CLEAR, RESTS
from smash_baselines.names import Fact, Names, numbered
from smash_baselines.task import HEADER, PddlTask

_READ_APART = frozenset({"next", "free-buffers", "cap", "opens", "before", "met", RESTS, CLEAR})
"""Facts whose objects may have other names, or be more, than those of the compiler."""
_ENDED = frozenset({("hand-empty",), ("idle",)})
"""What a goal may leave out where the hand starts empty: what else it says is brought about by actions that end so."""
_TOKEN = re.compile(r"[()]|[^\s()]+")


@dataclass(frozen=True, slots=True)
class ReadProblem:
    """An instance read from PDDL, the plan options that its domain says, and how its objects are called in PDDL.

    `counts` are the objects that count, from 0 up.
    """

    instance: Instance
    options: PlanOptions
    encoding: Encoding
    names: Names
    counts: tuple[str, ...]

    @property
    def task(self) -> PddlTask:
        """The compiled task with the problem's own object names, to say plans in them."""
        facts = facts_of(self.instance, self.options, self.encoding, self.names)
        facts.objects["count"] = self.counts
        return PddlTask(self.instance, self.options, self.encoding, self.names, facts)


@dataclass(slots=True)
class RawProblem:
    """A problem of one of our domains, as objects by type and facts; `names` is the compiler's header, if any."""

    encoding: Encoding
    name: str
    objects: dict[str, list[str]]
    start: list[Fact]
    goal: list[Fact]
    names: dict[str, Any] = field(default_factory=dict)
    where: str = "problem"


def read_problem_text(text: str, where: str = "problem") -> ReadProblem:
    """Read the text of a PDDL problem of one of our domains.

    Raises:
        MalformedFile: where it is none, or says what no instance can.
    """
    header = next((line for line in text.splitlines() if line.startswith(HEADER)), None)
    try:
        names = json.loads(header.removeprefix(HEADER)) if header else {}
    except ValueError:
        raise MalformedFile(where, "the line of names is not JSON") from None
    code = "\n".join(line.split(";", 1)[0] for line in text.splitlines()).lower()
    return interpret(_raw(_parse(code, where), names, where))


def interpret(raw: RawProblem) -> ReadProblem:
    """Make the instance that a problem's facts describe.

    Raises:
        MalformedFile: where they describe none.
    """
    return _Interpreter(raw).read()


def _parse(code: str, where: str) -> list[Any]:
    stack: list[list[Any]] = [[]]
    for token in _TOKEN.findall(code):
        if token == "(":
            stack.append([])
        elif token == ")":
            if len(stack) == 1:
                raise MalformedFile(where, "a parenthesis is closed that was never opened")
            done = stack.pop()
            stack[-1].append(done)
        else:
            stack[-1].append(token)
    if len(stack) != 1 or len(stack[0]) != 1 or not isinstance(stack[0][0], list):
        raise MalformedFile(where, "not one balanced PDDL expression")
    return stack[0][0]


def _raw(tree: list[Any], names: dict[str, Any], where: str) -> RawProblem:
    parts = {part[0]: part[1:] for part in tree if isinstance(part, list) and part}
    domain = " ".join(str(item) for item in parts.get(":domain", []))
    if domain not in BY_DOMAIN:
        raise MalformedFile(where, f"domain {domain!r} is none of ours ({', '.join(BY_DOMAIN)})")
    goals = parts.get(":goal", [[]])
    goal = goals[0][1:] if goals and goals[0] and goals[0][0] == "and" else goals
    return RawProblem(
        BY_DOMAIN[domain],
        str(parts.get("problem", ["problem"])[0]),
        _typed(parts.get(":objects", [])),
        list(_facts(parts.get(":init", []), where)),
        list(_facts(goal, where)),
        names,
        where,
    )


def _typed(tokens: Sequence[str]) -> dict[str, list[str]]:
    """Read `a b - kind c - other`."""
    objects: dict[str, list[str]] = {}
    waiting: list[str] = []
    items = iter(tokens)
    for token in items:
        if token == "-":
            objects.setdefault(next(items, ""), []).extend(waiting)
            waiting = []
        else:
            waiting.append(token)
    return objects


def _facts(items: Iterable[Any], where: str) -> Iterator[Fact]:
    for item in items:
        if isinstance(item, list) and item and item[0] == "=":
            continue
        if not isinstance(item, list) or not all(isinstance(word, str) for word in item) or not item:
            raise MalformedFile(where, "only plain facts are allowed in (:init) and (:goal)")
        yield tuple(item)


def _inverse(names: Mapping[str, str]) -> dict[str, str]:
    return {name: short for short, name in names.items()}


class _Interpreter:
    """Reads piles, counts and goal from the facts of one problem."""

    def __init__(self, raw: RawProblem) -> None:
        self.raw = raw
        blocks, locations = raw.objects.get("block", []), raw.objects.get("location", [])
        self.block_of = {short: raw.names.get("blocks", {}).get(short, short) for short in blocks}
        self.location_of = {short: raw.names.get("locations", {}).get(short, short) for short in locations}
        self.upon = {fact[2]: fact[1] for fact in raw.start if fact[0] == "on"}

    def refuse(self, problem: str) -> NoReturn:
        raise MalformedFile(self.raw.where, problem)

    def read(self) -> ReadProblem:
        try:
            instance = self._instance()
            options = self._options()
        except (KeyError, IndexError) as error:
            self.refuse(f"a fact names what is no object of its type: {error}")
        names = Names(_inverse(self.block_of), _inverse(self.location_of))
        counts = tuple(sorted(self.raw.objects.get("count", []), key=self._index))
        read = ReadProblem(instance, options, self.raw.encoding, names, counts)
        _check(self.raw, read)
        return read

    def _instance(self) -> Instance:
        raw = self.raw
        hand = self._hand()
        if raw.encoding.chain and ("idle",) not in raw.start:
            self.refuse("a topple is under way at the start")
        start = {self.location_of[f[2]]: self._pile(f[1]) for f in raw.start if f[0] == "base"}
        on_buffers = [fact[1] for fact in raw.start if fact[0] == "on-buffer"]
        buffers = self._buffers(len(on_buffers) + self._free())
        where = self._buffer_of(on_buffers, buffers)
        start |= {where[lowest]: self._pile(lowest) for lowest in on_buffers}
        return make_instance(
            name=raw.names.get("instance", raw.name),
            blocks=self.block_of.values(),
            stacks=self.location_of.values(),
            buffers=buffers,
            start=start,
            table=[self.block_of[fact[1]] for fact in raw.start if fact[0] == "on-table"],
            hand=hand,
            goal=self._goal(),
            where=raw.where,
        )

    def _hand(self) -> str | None:
        held = [fact[1] for fact in self.raw.start if fact[0] == "holding"]
        if (("hand-empty",) in self.raw.start) == bool(held) or len(held) > 1:
            self.refuse("at the start the hand is empty, (hand-empty), or holds one block, (holding …)")
        return self.block_of[held[0]] if held else None

    def _pile(self, lowest: str) -> list[str]:
        pile = [lowest]
        while pile[-1] in self.upon and len(pile) <= len(self.block_of):
            pile.append(self.upon[pile[-1]])
        return [self.block_of[short] for short in pile]

    def _free(self) -> int:
        level = next((fact[1] for fact in self.raw.start if fact[0] == "free-buffers"), None)
        if level is None:
            self.refuse("(free-buffers …) is missing")
        return self._index(level)

    def _index(self, level: str) -> int:
        """Return the number that a count object stands for: how many there are below it."""
        below = {fact[2]: fact[1] for fact in self.raw.start if fact[0] == "next"}
        number = 0
        while level in below:
            level, number = below[level], number + 1
            if number > len(below):
                self.refuse("(next …) runs in a circle")
        return number

    def _buffers(self, count: int) -> list[str]:
        named = self.raw.names.get("buffers")
        return (
            list(named)
            if named is not None and len(named) == count
            else list(numbered("u", map(str, range(count))).values())
        )

    def _buffer_of(self, lowest: Sequence[str], buffers: Sequence[str]) -> dict[str, str]:
        named = self.raw.names.get("on_buffers", {})
        if set(named) == set(lowest):
            return dict(named)
        return dict(zip(lowest, buffers, strict=False))

    def _options(self) -> PlanOptions:
        cap = next((fact[1] for fact in self.raw.start if fact[0] == "cap"), None)
        if cap is None and self.raw.encoding.capped:
            self.refuse("(cap …) is missing")
        return PlanOptions(self.raw.encoding.topple, None if cap is None else self._index(cap) + 1)

    def _goal(self) -> Goal:
        """Read the goal: `on` where no block has a location, `stacks` where all blocks have one, else `positions`."""
        done = {("hand-empty",), ("idle",)}
        facts = [fact for fact in self.raw.goal if fact not in done and fact[0] != "met"]
        if any(fact[0] not in ("on", "base", "bottom") for fact in facts):
            self.refuse("the goal may say (on …), (base …), (bottom …), (met …), (hand-empty) and (idle) only")
        upon = {fact[2]: fact[1] for fact in facts if fact[0] == "on"}
        piles: dict[str, list[str]] = {}
        for base in (fact for fact in facts if fact[0] == "base"):
            pile = [base[1]]
            while pile[-1] in upon and len(pile) <= len(self.block_of):
                pile.append(upon.pop(pile[-1]))
            piles[self.location_of[base[2]]] = [self.block_of[short] for short in pile]
        bottom = tuple(self.block_of[fact[1]] for fact in facts if fact[0] == "bottom")
        words = self._words()
        if piles and (upon or bottom or any(words.values())):
            self.refuse("the goal mixes blocks at locations with relations at any location: no instance says this")
        placed = sum(map(len, piles.values()))
        kind = self.raw.names.get("goal") or ("on" if not piles else "")
        if kind == "on" and not piles:
            on = {self.block_of[fact[1]]: self.block_of[fact[2]] for fact in facts if fact[0] == "on"}
            return OnGoal(on, bottom, words[RESTS], words[CLEAR])
        if placed == len(self.block_of) and kind != "positions":
            return StacksGoal({location: tuple(pile) for location, pile in piles.items()})
        return PositionsGoal({b: (at, h) for at, pile in piles.items() for h, b in enumerate(pile, start=1)})

    def _words(self) -> dict[str, tuple[str, ...]]:
        """Read the words of the goal in the order in which they are judged: what is said of which blocks."""
        said = {fact[1]: (fact[0], self.block_of[fact[2]]) for fact in self.raw.start if fact[0] in (RESTS, CLEAR)}
        later = {fact[1]: fact[2] for fact in self.raw.start if fact[0] == "before"}
        word = next((fact[1] for fact in self.raw.start if fact[0] == "opens"), None)
        words: list[tuple[str, str]] = []
        met = {fact[1] for fact in self.raw.goal if fact[0] == "met"}
        while word in later and len(words) <= len(said):
            word = later[word]
            if word not in said or word not in met:
                self.refuse(f"the goal's words: {word} is none that is said and to be (met …)")
            words.append(said[word])
        if len(words) != len(said) or len(met - said.keys()) > 1:
            self.refuse("the goal's words do not follow each other by (before …) from the one that (opens …)")
        return {says: tuple(block for kind, block in words if kind == says) for says in (RESTS, CLEAR)}


def _check(raw: RawProblem, read: ReadProblem) -> None:
    """Compare what the instance comes to in PDDL with what the problem says: nothing may be missing or too much.

    Raises:
        MalformedFile: naming a fact.
    """
    facts = read.task.facts
    for part, told, said in (("start", facts.start, raw.start), ("goal", facts.goal, raw.goal)):
        known, meant = (frozenset(fact for fact in some if fact[0] not in _READ_APART) for some in (told, said))
        free = _ENDED if read.instance.hand is None else frozenset()
        extra, lost = sorted(meant - known), sorted(known - meant - free)
        if extra:
            raise MalformedFile(raw.where, f"the {part} says ({' '.join(extra[0])}), which does not fit the rest of it")
        if lost:
            raise MalformedFile(raw.where, f"the {part} does not say ({' '.join(lost[0])}), which the rest of it means")
