"""PDDL steps as steps of the classical blocks world and back, by what is known of each action's arguments."""

from __future__ import annotations

from collections.abc import Iterator, Mapping

from smash.problem.blocksworld.plan_text import PddlStep
from smash.problem.blocksworld.reading import USUAL, USUAL_ACTIONS, Reading, Template, usual
from smash.problem.blocksworld.world import RELATIONS, Kind, Meaning, Step
from smash.problem.errors import RefusedPlan, Unsupported

USUAL_READING = Reading(
    hand=True, meanings={name: Meaning(name, tuple(range(RELATIONS[name].arity))) for name in USUAL}
)
"""How a blocks world is told where nobody says how."""
_USUAL_ACTION = {name: action for action, names in USUAL_ACTIONS.items() for name in names}


class Interpreter:
    """Tells what the steps of a file mean."""

    def __init__(self, reading: Reading, blocks: Mapping[str, str]) -> None:
        """Make an interpreter.

        Args:
            reading: how the file tells a blocks world.
            blocks: the name of each block in the file (lower case) -> in the instance.
        """
        self.reading = reading
        self.blocks = blocks

    def knows(self, action: str) -> bool:
        """Return whether an action is one of the file's."""
        return bool(self._templates(action))

    def meanings(self, step: PddlStep) -> Iterator[tuple[Step, Template]]:
        """Yield what a step may do: one step of the blocks world, more where an action does several kinds.

        Raises:
            RefusedPlan: where its action or one of its arguments is not known.
        """
        action, *arguments = step
        templates = self._templates(action)
        if not templates:
            known = ", ".join(dict.fromkeys(template.action for template in self.reading.templates))
            hint = "; give the domain with --domain" if self.reading.by_name else ""
            raise RefusedPlan(f"no action is called {action!r} ({known} are known){hint}")
        if self.reading.by_name:
            arguments = [name for name in arguments if name not in self.reading.others]
        if len(arguments) != len(templates[0].roles):
            raise RefusedPlan(f"{action!r} takes {len(templates[0].roles)} arguments, not {len(arguments)}")
        fitting = 0
        for template in templates:
            if all(arguments[place] == thing for place, thing in template.fixed):
                fitting += 1
                yield self._step(template, arguments), template
        if not fitting:
            unknown = next((n for n in arguments if n not in self.blocks), arguments[0] if arguments else action)
            raise RefusedPlan(f"{unknown!r} cannot stand in it")

    def _templates(self, action: str) -> list[Template]:
        name = _USUAL_ACTION.get(usual(action), action) if self.reading.by_name else action
        return [template for template in self.reading.templates if template.action == name]

    def _step(self, template: Template, arguments: list[str]) -> Step:
        told: dict[str, str | None] = {}
        for role, name in zip(template.roles, arguments, strict=True):
            if role is not None:
                told[role] = self._block(name, table=role != "block")
        block = told.get("block")
        assert block is not None
        return Step(template.kind, block, told.get("source"), told.get("target"))

    def _block(self, name: str, *, table: bool) -> str | None:
        if table and name == self.reading.table:
            return None
        if name not in self.blocks:
            raise RefusedPlan(f"{name!r} is no block of the instance")
        return self.blocks[name]


class Speaker:
    """Writes steps of the blocks world in the words of a file."""

    def __init__(self, reading: Reading, words: Mapping[str, str]) -> None:
        """Make a speaker.

        Args:
            reading: how the file tells a blocks world.
            words: the name of each block in the instance -> in the file.
        """
        self.reading = reading
        self.words = words

    def step(self, step: Step) -> PddlStep:
        """Return a step in PDDL.

        Raises:
            Unsupported: where no action of the file does it alone.
        """
        for template in self.reading.templates:
            arguments = self._arguments(template, step)
            if arguments is not None:
                return (template.action, *arguments)
        raise Unsupported(f"no action of the file says what is done to {step.block!r}; not supported")

    def _arguments(self, template: Template, step: Step) -> list[str] | None:
        """Return the arguments that make an action do a step; None where none do."""
        if template.kind != step.kind or template.from_table not in (None, step.source is None):
            return None
        if step.kind != "take" and template.to_table not in (None, step.target is None):
            return None
        fixed = dict(template.fixed)
        told = {"block": step.block, "source": step.source, "target": step.target}
        arguments: list[str | None] = []
        for place, role in enumerate(template.roles):
            block = None if role is None else told[role]
            name = self.reading.table if block is None else self.words[block]
            arguments.append(fixed.get(place) if role is None else name)
            if place in fixed and arguments[-1] != fixed[place]:
                return None
        found = [name for name in arguments if name is not None]
        return found if len(found) == len(arguments) else None


def kinds_of(reading: Reading) -> frozenset[Kind]:
    """Return what the actions of a file do."""
    return frozenset(template.kind for template in reading.templates)
