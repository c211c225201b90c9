"""Steps that belong together brought together: steps that share no place can change their order."""

from __future__ import annotations

from collections.abc import Collection, Sequence

from smash.problem.views.numbered import ON_TABLE, TOPPLE, Step


def places_of(step: Step) -> tuple[int, int]:
    """Return the two places that a step concerns, the table region as `ON_TABLE`.

    Steps that share no place can change their order. Topples and picks from the table region keep theirs.
    """
    first, second, third = step
    return (second, ON_TABLE) if first == TOPPLE else (second, third)


def gathered(steps: Sequence[Step], chosen: Collection[int]) -> tuple[list[Step], list[Step], list[Step]]:
    """Return the steps in another order of the same effect: before, together, after.

    Together are the chosen ones and what has to come between two of them.

    Args:
        steps: some of a plan, one after the other.
        chosen: the indices of those to be brought together.
    """
    later, earlier = _touched(steps, chosen), _touched(steps[::-1], {len(steps) - 1 - index for index in chosen})
    before: list[Step] = []
    together: list[Step] = []
    after: list[Step] = []
    for index, step in enumerate(steps):
        follows, leads = later[index], earlier[len(steps) - 1 - index]
        if index in chosen or (follows and leads):
            together.append(step)
        else:
            (after if follows else before).append(step)
    return before, together, after


def _touched(steps: Sequence[Step], chosen: Collection[int]) -> list[bool]:
    """Return per step whether it has to come after one of the chosen ones."""
    places: set[int] = set()
    touched = []
    for index, step in enumerate(steps):
        concerned = places_of(step)
        follows = not places.isdisjoint(concerned)
        touched.append(follows)
        if follows or index in chosen:
            places.update(concerned)
    return touched
