"""Which problems have a plan at all: decided from start and goal, without a search (`docs/theory.md`, "Solvable").

An `on` goal may contradict itself, or want more bottoms and clear tops than there are locations. Beside that, with
topple everything can be brought to the table region and built up from there. Without topple three locations reach every
arrangement; two locations are one line of blocks with a movable gap (first location upward, then the second
downward), whose order never changes, and one location is a pile on which blocks of the table region can only be put.
Blocks on a carrier that must not be carried are as loose as those of the table region. A start with a block in the hand
has a plan where one of its first places leads to one.
"""

from __future__ import annotations

import itertools

from smash.problem.ends import splits, tower_ends
from smash.problem.hand import after_place, distinct_locations
from smash.problem.model import Goal, Instance, OnGoal, PositionsGoal, StacksGoal
from smash.problem.rules import Law
from smash.problem.views.posed import posed

Pile = tuple[str, ...]
ENOUGH_LOCATIONS = 3
"""With so many locations pick and place alone reaches every arrangement."""


def why_infeasible(law: Law) -> str | None:
    """Return in one line why no plan exists, or None where one does.

    The answer is exact, but for instances with further aggregating actions: there None promises nothing.
    A cap on the blocks of a topple makes no difference. `Problem.infeasible` keeps the answer.
    """
    instance = law.instance
    if isinstance(instance.goal, OnGoal):
        instance = posed(instance, falls=bool(law.kinds))
        reason = why_contradictory(law.instance.goal) or _why_crowded(instance, falls=bool(law.kinds))
        if reason is not None:
            return reason
    locations = len(instance.locations)
    if law.kinds or locations >= ENOUGH_LOCATIONS:
        return None
    if instance.hand is None:
        starts = [instance]
    else:
        starts = [after_place(instance, location) for location in distinct_locations(instance)]
    if any(_reachable(start) for start in starts):
        return None
    if locations == 1:
        return "without topple, one location's blocks never change their order, and the goal changes it"
    return "without topple, two locations keep the order of their blocks read as one line, and the goal changes it"


def why_contradictory(goal: Goal) -> str | None:
    """Return in one line why no arrangement whatever fulfils a goal, or None where one may."""
    if not isinstance(goal, OnGoal):
        return None
    upper_of: dict[str, str] = {}
    for upper, under in goal.on.items():
        other = upper_of.setdefault(under, upper)
        if other != upper:
            return f"the goal wants both {other!r} and {upper!r} directly on {under!r}"
    for part, blocks in (("at the bottom of a location", goal.bottom), ("on the table", goal.ontable)):
        for block in blocks:
            if block in goal.on:
                return f"the goal wants {block!r} {part} and on {goal.on[block]!r}"
    loaded = next((block for block in goal.clear if block in upper_of), None)
    if loaded is not None:
        return f"the goal wants {loaded!r} clear and {upper_of[loaded]!r} on it"
    standing = {block for tower in goal.towers() for block in tower}
    circling = next((block for block in goal.on if block not in standing), None)
    return None if circling is None else f"the goal wants {circling!r} to stand on itself"


def _why_crowded(instance: Instance, *, falls: bool) -> str | None:
    """Return why the towers of a posed `on` goal do not fit the locations, or None where some arrangement holds them.

    Every location has one bottom and one top. Where nothing falls, what stands in no tower needs a place too, unless it
    lies in the table region or on a carrier.
    """
    goal, locations = instance.goal, len(instance.locations)
    assert isinstance(goal, OnGoal)
    clear, bottom = frozenset(goal.clear), frozenset(goal.bottom)
    towers = goal.towers()
    in_towers = {block for tower in towers for block in tower}
    standing = () if falls else [*itertools.chain(*instance.start.values()), *_held(instance)]
    single = [block for block in standing if block not in in_towers]
    grounded = sum(tower[0] in bottom for tower in towers)
    tops = [tower[-1] for tower in towers if tower[-1] in clear] + [block for block in single if block in clear]
    shut = sum(tower[0] in bottom and tower[-1] in clear for tower in towers)
    others = any(tower[0] not in bottom and tower[-1] not in clear for tower in towers)
    if grounded > locations:
        return f"the goal wants {grounded} blocks at the bottom of a location, {_there_are(locations)}"
    if len(tops) > locations:
        return f"the goal wants {len(tops)} piles with a clear top, {_there_are(locations)}"
    if shut == locations and (others or any(block not in clear for block in single)):
        return f"the goal takes all {locations} locations from the bottom to a clear top, and more blocks need a place"
    return None


def _there_are(locations: int) -> str:
    return "there is 1 location" if locations == 1 else f"there are {locations} locations"


def _held(instance: Instance) -> Pile:
    """Return the block in the hand, if there is one."""
    return () if instance.hand is None else (instance.hand,)


def _reachable(instance: Instance) -> bool:
    """Whether one or two locations reach a posed goal by pick and place alone."""
    goal = instance.goal
    if isinstance(goal, OnGoal):
        starts = [instance.start[location] for location in instance.locations]
        return any(tower_ends(goal, piles) is not None for piles in splits(starts))
    return _piles_fit(instance, _goal_piles(instance, goal))


def _goal_piles(instance: Instance, goal: StacksGoal | PositionsGoal) -> list[Pile]:
    """Return the listed blocks of every location, bottom first."""
    piles = goal.stacks if isinstance(goal, StacksGoal) else goal.stacks()
    return [tuple(piles.get(location, ())) for location in instance.locations]


def _piles_fit(instance: Instance, wanted: list[Pile]) -> bool:
    """Whether one or two locations can hold the listed blocks at their heights, the rest anywhere."""
    loose = frozenset(instance.table).union(*(carrier.holds for carrier in instance.carriers))
    starts = [instance.start[location] for location in instance.locations]
    if len(starts) == 1:
        common = min(len(starts[0]), len(wanted[0]))
        return starts[0][:common] == wanted[0][:common]
    line = starts[0] + starts[1][::-1]
    left = tuple(block for block in wanted[0] if block not in loose)
    right = tuple(block for block in reversed(wanted[1]) if block not in loose)
    return line[: len(left)] == left and line[len(line) - len(right) :] == right
