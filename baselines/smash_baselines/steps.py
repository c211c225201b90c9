"""Steps of PDDL plans to actions of the law, and back."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Iterable, Iterator, Sequence

from smash.problem.actions.topple import Topple
from smash.problem.errors import IllegalAction
from smash.problem.model import TABLE, Action, Pick, Place, State
from smash.problem.rules import Law
from smash_baselines.encodings import action_names
from smash_baselines.goal_words import JUDGED
from smash_baselines.judging import judging_steps
from smash_baselines.names import Step
from smash_baselines.parts.layout import Layout
from smash_baselines.parts.part import Part, Telling, step_names
from smash_baselines.task import PddlTask

REGIONS = ("stacks", "buffers")
"""The constants of the chain domains."""


def parse_step(line: str) -> Step:
    """Return the step of a plan line such as `(pick b02 b01)`."""
    return tuple(line.strip().lower().strip("()").split())


def actions_of(steps: Iterable[Step], task: PddlTask) -> list[Action]:
    """Return the law's actions for a PDDL plan; a chain of begin, drop, end becomes one topple.

    Raises:
        IllegalAction: where a step is not of the encoding, or the law refuses what it says.
    """
    decoder = _FamilyDecoder(task) if task.encoding.parts else _ToppleDecoder(task)
    return list(decoder.run(steps))


class _Decoder(ABC):
    """Follows the state, because a PDDL step does not say in which location and height it happens."""

    def __init__(self, task: PddlTask) -> None:
        self._task = task
        self._law = Law(task.instance, task.options)
        self._state = State.start_of(task.instance)

    def run(self, steps: Iterable[Step]) -> Iterator[Action]:
        for step in steps:
            if self._task.encoding.judged and step[:1] and step[0] in JUDGED:
                continue
            try:
                action = self._action(step)
            except (KeyError, IndexError, ValueError, StopIteration) as error:
                raise IllegalAction(
                    f"step ({' '.join(step)}) does not fit the encoding ({self._why(step, error)})"
                ) from None
            if action is not None:
                self._follow(action)
                yield action

    def _why(self, step: Step, error: Exception) -> str:
        """Return what is wrong with a step at which an error came: an unknown name first."""
        if not step or step[0] not in action_names(self._task.domain_text):
            return f"no action is called {step[0]!r}" if step else "it is empty"
        known = {name for names in self._task.facts.objects.values() for name in names}
        unknown = [name for name in step[1:] if name not in known and name not in REGIONS]
        if unknown:
            return f"no object is called {unknown[0]!r}"
        match error:
            case IndexError():
                return "an argument is missing"
            case StopIteration():
                return "no buffer is empty"
            case KeyError() if error.args[0] in self._task.instance.blocks:
                return f"{self._task.names.blocks[error.args[0]]} is in no pile"
            case KeyError():
                return f"{error.args[0]!r} is not what stands at its place"
        return str(error)

    @abstractmethod
    def _action(self, step: Step) -> Action | None:
        """Return the action that a step completes, or None."""

    def _follow(self, action: Action) -> None:
        self._law.apply(self._state, action)


class _FamilyDecoder(_Decoder):
    """Asks the part of the domain that has the step."""

    def __init__(self, task: PddlTask) -> None:
        super().__init__(task)
        self._telling = _telling(task)
        self._part: dict[str, Part] = {
            name: part for part in task.encoding.parts for name in step_names(part.text(task.instance, task.options))
        }

    def _action(self, step: Step) -> Action | None:
        return self._part[step[0]].action(self._telling, self._state, step)


class _ToppleDecoder(_Decoder):
    """Reads the steps of the domains that know topple alone."""

    def __init__(self, task: PddlTask) -> None:
        super().__init__(task)
        self._where = {block: at for at, pile in self._state.piles.items() for block in pile}
        self._lowest: str | None = None

    def _action(self, step: Step) -> Action | None:
        block = self._task.names.block_of[step[1]]
        if step[0].startswith("topple"):
            return self._toppling(step[0], block)
        match step[0]:
            case "pick" | "pick-base" | "pick-from-buffer":
                return Pick(block, self._where[block])
            case "pick-from-table":
                return Pick(block, TABLE)
            case "place":
                return Place(block, self._where[self._task.names.block_of[step[2]]])
            case "place-base":
                return Place(block, self._task.names.location_of[step[2]])
            case "place-on-buffer":
                return Place(block, next(at for at in self._task.instance.buffers if not self._state.piles[at]))
        raise ValueError(f"no action is called {step[0]}")

    def _toppling(self, name: str, block: str) -> Topple | None:
        match name:
            case "topple" | "topple-base" | "topple-begin-base":
                return self._topple(block)
            case "topple-begin" | "topple-drop":
                self._lowest = block
                return None
            case "topple-drop-base":
                self._lowest = None
                return self._topple(block)
            case "topple-end" if self._lowest is not None:
                lowest, self._lowest = self._lowest, None
                return self._topple(lowest)
        raise ValueError("no topple is under way")

    def _topple(self, lowest: str) -> Topple:
        location = self._where[lowest]
        pile = self._state.piles[location]
        if lowest not in pile:
            raise ValueError(f"{self._task.names.blocks[lowest]} is in no pile")
        return Topple(location, pile.index(lowest) + 1)

    def _follow(self, action: Action) -> None:
        super()._follow(action)
        if isinstance(action, Place):
            self._where[action.block] = action.target


def steps_of(actions: Sequence[Action], task: PddlTask) -> list[Step]:
    """Return the PDDL plan of a legal plan: the encodings say whatever the law allows.

    Where the goal holds at the end, the words that it leaves open are judged.

    Raises:
        IllegalAction: where the law refuses an action.
    """
    law = Law(task.instance, task.options)
    state = State.start_of(task.instance)
    steps: list[Step] = []
    for action in actions:
        reason = law.refusal(state, action)
        if reason is not None:
            raise IllegalAction(f"{action}: {reason}")
        steps += _family_steps(task, state, action) if task.encoding.parts else _Encoder(task, state).steps(action)
        law.apply(state, action)
    if task.encoding.judged and law.goal_shortfall(state) is None:
        steps += judging_steps(state, task)
    return steps


def _telling(task: PddlTask) -> Telling:
    return Telling(task.instance, task.options, Layout(task.instance, task.names), task.instance.blocks)


def _family_steps(task: PddlTask, state: State, action: Action) -> Iterator[Step]:
    telling = _telling(task)
    part = next(part for part in task.encoding.parts if part.tells(telling, action))
    return part.steps(telling, state, action)


class _Encoder:
    """The steps of one action in one state, in the domains that know topple alone."""

    def __init__(self, task: PddlTask, state: State) -> None:
        self._task = task
        self._piles = state.piles
        self._counts = task.facts.objects["count"]

    def steps(self, action: Action) -> Iterator[Step]:
        match action:
            case Pick(block, source):
                yield self._pick(block, source)
            case Place(block, target):
                yield self._place(block, target)
            case Topple(location, height):
                yield from self._topple(location, height)

    def _pick(self, block: str, source: str) -> Step:
        if source == TABLE:
            return ("pick-from-table", self._block(block))
        if len(self._piles[source]) > 1:
            return ("pick", self._block(block), self._block(self._piles[source][-2]), *self._region(source))
        if source in self._task.names.locations:
            return ("pick-base", self._block(block), self._task.names.locations[source])
        free = self._free_buffers()
        return ("pick-from-buffer", self._block(block), self._counts[free], self._counts[free + 1])

    def _place(self, block: str, target: str) -> Step:
        if self._piles[target]:
            return ("place", self._block(block), self._block(self._piles[target][-1]), *self._region(target))
        if target in self._task.names.locations:
            return ("place-base", self._block(block), self._task.names.locations[target])
        free = self._free_buffers()
        return ("place-on-buffer", self._block(block), self._counts[free], self._counts[free - 1])

    def _topple(self, location: str, height: int) -> Iterator[Step]:
        pile = [self._block(block) for block in self._piles[location]]
        under = [self._task.names.locations[location], *pile]
        if not self._task.encoding.chain:
            yield ("topple" if height > 1 else "topple-base", pile[height - 1], under[height - 1])
            return
        for count, index in enumerate(range(len(pile) - 1, height - 2, -1)):
            name = "topple-begin" if count == 0 else "topple-drop"
            if index == 0:
                yield (f"{name}-base", pile[0], under[0], *(self._left(count) if count else ()))
                return
            yield (name, pile[index], under[index], *self._left(count))
        if height > 1:
            yield ("topple-end", pile[height - 2], *self._left(len(pile) - height + 1)[:1])

    def _left(self, fallen: int) -> tuple[str, ...]:
        """Return the counts of a capped step, before and after: how many blocks may still fall."""
        if not self._task.encoding.capped or self._task.options.max_topple is None:
            return ()
        left = self._task.options.max_topple - max(fallen, 1)
        return (self._counts[left],) if fallen == 0 else (self._counts[left], *self._counts[left - 1 : left])

    def _region(self, location: str) -> tuple[str, ...]:
        if not self._task.encoding.chain:
            return ()
        return ("stacks" if location in self._task.names.locations else "buffers",)

    def _block(self, block: str) -> str:
        return self._task.names.blocks[block]

    def _free_buffers(self) -> int:
        return sum(not self._piles[buffer] for buffer in self._task.instance.buffers)
