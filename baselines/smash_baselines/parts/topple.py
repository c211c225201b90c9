"""Topple in the family's domains: a chain of steps, the first of which pays."""

from __future__ import annotations

from collections.abc import Iterator

from smash.problem.actions.topple import Topple
from smash.problem.model import Action, Instance, PlanOptions, State
from smash_baselines.names import Fact, Step
from smash_baselines.parts.part import Part, Telling


class TopplePart(Part):
    """`topple-begin`, `topple-drop`, `topple-end`; with a cap they count."""

    kind = "topple"
    blocks_only_hinder = True

    def file(self, instance: Instance, options: PlanOptions) -> str:
        """Return the part that counts where a cap binds, else the plain one."""
        cap = options.max_topple
        return "topple" if cap is None or cap >= len(instance.blocks) else "topple-capped"

    def start(self, telling: Telling) -> Iterator[Fact]:
        """Yield which regions can be toppled, and the cap."""
        layout = telling.layout
        yield from (("topples", region) for (is_stack, _), region in layout.regions.items() if is_stack)
        if self._capped(telling) and telling.options.max_topple is not None:
            yield ("cap", layout.count(telling.options.max_topple - 1))

    def costs(self, telling: Telling) -> Iterator[tuple[Fact, int]]:
        """Yield what a topple costs."""
        yield ("topple-cost",), telling.instance.costs.of("topple")

    def tells(self, telling: Telling, action: Action) -> bool:
        """Return whether it is a topple."""
        return isinstance(action, Topple)

    def steps(self, telling: Telling, state: State, action: Action) -> Iterator[Step]:
        """Yield a step for each falling block, and the end where one stays."""
        assert isinstance(action, Topple)
        pile = [telling.block(block) for block in state.piles[action.location]]
        region = telling.layout.region(action.location)
        under = [telling.layout.names.locations[action.location], *pile]
        levels = self._levels(telling)
        for count, index in enumerate(range(len(pile) - 1, action.height - 2, -1)):
            name = "topple-begin" if count == 0 else "topple-drop"
            counted = levels[:1] if count == 0 else levels[count - 1 : count + 1]
            if index == 0:
                yield (f"{name}-base", pile[0], under[0], region, *(counted if count else ()))
                return
            yield (name, pile[index], under[index], region, *counted)
        left = len(pile) - action.height
        yield ("topple-end", under[action.height - 1], region, *levels[left : left + 1])

    def action(self, telling: Telling, state: State, step: Step) -> Action | None:
        """Return the topple that has come to its end."""
        location, height = telling.where(state, step[1])
        if step[0].endswith("-base"):
            return Topple(location, 1)
        return Topple(location, height + 1) if step[0] == "topple-end" else None

    def _capped(self, telling: Telling) -> bool:
        return self.file(telling.instance, telling.options) == "topple-capped"

    def _levels(self, telling: Telling) -> list[str]:
        """Return the counts that a capped topple goes down by, from what may fall after the first block."""
        if not self._capped(telling) or telling.options.max_topple is None:
            return []
        return [telling.layout.count(left) for left in range(telling.options.max_topple - 1, -1, -1)]
