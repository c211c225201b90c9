"""A layout for an instance: places from the plan or from what plans may do, bounds, search and judges in one call."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace

from smash.execution.layout.bounds import impossible
from smash.execution.layout.conditions import violations
from smash.execution.layout.judging import problems_of, problems_of_plan
from smash.execution.layout.search import find_layout
from smash.execution.layout.wanted import Place, in_cubes, places_of_instance, places_of_plan
from smash.execution.scene.tabletop import Slot, Tabletop
from smash.motion.robots import load_robot
from smash.problem.errors import SmashError, Unsupported
from smash.problem.model import Action
from smash.problem.rules import Law

ATTEMPTS = 60
BUFFER_HEIGHT = 4
"""Without a plan, piles on buffers are taken to be no higher than this, as `smash draw-scene` takes them to be."""


class NoLayout(SmashError):
    """No layout can exist: the message says why."""

    exit_code = 3


class NotFound(SmashError):
    """No layout was found, which proves nothing."""

    exit_code = 4


@dataclass(frozen=True, slots=True)
class Layout:
    """A layout that the judges accept.

    Attributes:
        tabletop: The scene with its slots.
        places: What was asked for, in the order of the instance's locations and of the scene's slots.
        attempts: How many it took.
    """

    tabletop: Tabletop
    places: tuple[Place, ...]
    attempts: int


def wanted_places(law: Law, height: int | None = None, buffer_height: int | None = None) -> list[Place]:
    """Return the places that plans of an instance may ask for; as high as all of its blocks where nothing is said."""
    count = max(1, len(law.instance.blocks))
    low = min(count, BUFFER_HEIGHT) if buffer_height is None else buffer_height
    return places_of_instance(law.instance, law.options, count if height is None else height, low)


def lay_out(
    law: Law,
    tabletop: Tabletop,
    actions: Sequence[Action] | None = None,
    *,
    height: int | None = None,
    buffer_height: int | None = None,
    attempts: int = ATTEMPTS,
    seed: int = 0,
) -> Layout:
    """Look for a layout for an instance.

    Args:
        law: The instance, and what plans may use.
        tabletop: Blocks, speed and robot; its slots do not matter.
        actions: A legal plan, by which places are made; where None, for any plan with piles up to the heights.
        height: The most blocks of a pile on a stack, where start and goal have no higher one; all where None.
        buffer_height: The same on a buffer; at most `BUFFER_HEIGHT` where None.
        attempts: How many arrangements are tried.
        seed: Of the search.

    Raises:
        NoLayout: where none can exist.
        NotFound: where none was found.
        Unsupported: where the instance has carriers, or the arm does not turn about the vertical.
    """
    instance, robot = law.instance, load_robot(tabletop.robot)
    if not robot.upright:
        raise Unsupported(f"robot {robot.name!r}: its first joint does not turn it about the vertical, as layouts need")
    if instance.carriers:
        raise Unsupported(f"instance {instance.name!r} has carriers; layouts have no stations for them")
    if actions is None:
        places = wanted_places(law, height, buffer_height)
    else:
        places = places_of_plan(law, actions, tabletop.highest)
    if instance.table and not any(place.falling for place in places):
        places[0] = replace(places[0], falling=1)
    places = [in_cubes(place, tabletop) for place in places]
    reason = impossible(places, tabletop.longest, robot)
    if reason is not None:
        if actions is None and height is None:
            reason += "; without a plan any pile may have all blocks: give the PLAN, or --height"
        raise NoLayout(f"no layout for {instance.name!r} exists: {reason}")

    def scene(slots: Sequence[Slot]) -> Tabletop:
        count = len(instance.stacks)
        return replace(tabletop, stacks=tuple(slots[:count]), buffers=tuple(slots[count:]), tray=None, stations=())

    def judge(slots: Sequence[Slot]) -> str | None:
        return next(_problems(scene(slots), law, actions), None)

    found = find_layout(places, tabletop.longest, robot, judge, attempts=attempts, seed=seed)
    if found.slots is None:
        raise NotFound(f"no layout for {instance.name!r} was found in {attempts} attempts; the nearest: {found.reason}")
    return Layout(scene(found.slots), tuple(places), found.attempts)


def _problems(tabletop: Tabletop, law: Law, actions: Sequence[Action] | None) -> Iterator[str]:
    """Yield what any of the judges finds wrong; of boxes by the longest edge, and as they are."""
    yield from problems_of(replace(tabletop, side=tabletop.longest, height=None, sizes={}))
    if not tabletop.uniform:
        yield from map(str, violations(tabletop))
    if actions is not None:
        yield from problems_of_plan(tabletop, law, actions)
