"""What a layout has to have: a place for every location, how high its pile gets, how many blocks fall there at once."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

from smash.execution.actions.topple import Strip, strip
from smash.execution.layout.conditions import FALLING, fallen_cubes
from smash.execution.scene.piles import needs_of, piles_of_ends
from smash.execution.scene.tabletop import Tabletop
from smash.problem.model import Action, Instance, PlanOptions
from smash.problem.rules import Law


@dataclass(frozen=True, slots=True)
class Place:
    """A place that a layout has to have.

    Attributes:
        location: What the instance calls it.
        height: The most blocks of its pile.
        falling: The most blocks that are toppled there at once; 0: no strip is needed.
        cubes: As how many cubes they count, by which a strip is chosen; as many as they are, where None.
        reached: As how many cubes those count that the arm has to reach; the first `FALLING`, where None.
    """

    location: str
    height: int
    falling: int = 0
    cubes: int | None = None
    reached: int | None = None

    @property
    def strip(self) -> Strip:
        """What toppled blocks may lie in."""
        return strip(self.cubes or self.falling)

    @property
    def judged(self) -> Strip:
        """The same, as far as the arm has to reach it."""
        return strip(self.reached or min(self.falling, FALLING))


def in_cubes(place: Place, tabletop: Tabletop) -> Place:
    """The same place, its strip for the highest blocks of a scene; that of as many blocks, where all are cubes."""
    if not place.falling or tabletop.uniform:
        return place
    most = min(place.falling, FALLING)
    return replace(place, cubes=fallen_cubes(tabletop, place.falling), reached=fallen_cubes(tabletop, most))


def places_of_plan(law: Law, actions: Sequence[Action], most: int) -> list[Place]:
    """Return what a legal plan asks for: a place for each location, in the order of the instance.

    Each pile may be one block higher, where the arm reaches that: recovery puts blocks down, and plans are made anew.

    Args:
        law: The instance and what the plan may use.
        actions: The plan.
        most: The most blocks of a pile that the arm reaches anywhere.
    """
    needs = needs_of(law, actions)
    heights = needs.highest
    spare = {name: max(heights.get(name, 0), min(heights.get(name, 0) + 1, most)) for name in law.instance.locations}
    return [Place(name, height, needs.topples.get(name, 0)) for name, height in spare.items()]


def places_of_instance(instance: Instance, options: PlanOptions, height: int, buffer_height: int) -> list[Place]:
    """Return what any plan may ask for whose piles are no higher than this, or than those of the start and the goal.

    A topple takes whole stacks where it may.

    Args:
        instance: The problem.
        options: What plans may use.
        height: The most blocks of a pile on a stack.
        buffer_height: The same on a buffer.
    """
    ends = piles_of_ends(instance)
    high = {name: max(height, ends[name]) for name in instance.stacks}
    most = options.max_topple or max(high.values())
    stacks = [Place(name, tall, min(tall, most) if options.topple else 0) for name, tall in high.items()]
    return stacks + [Place(name, max(buffer_height, ends[name])) for name in instance.buffers]
