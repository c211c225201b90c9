"""Topple no more than has to fall: blocks that could as well be picked from the stack stay on it.

The cost does not change, the execution does: a block that has not fallen has a known pose, so that its pick can be
planned before the plan is carried out (paper, section "SMASH Planning and Execution Implementation").
"""

from __future__ import annotations

from bisect import bisect_right
from collections.abc import Sequence

from smash.problem.actions.topple import Topple
from smash.problem.model import TABLE, Action, Pick, Place, State
from smash.problem.rules import Law


def gentle_topples(law: Law, actions: Sequence[Action]) -> tuple[Action, ...]:
    """Raise the cut of each topple of a legal plan as far as the rest of the plan allows.

    A block stays on its stack where it is picked from the table region before anything else happens at that stack,
    and after the blocks above it. A topple of which nothing would fall is left out.
    """
    plan: list[Action | None] = list(actions)
    state = State.start_of(law.instance)
    picks: dict[str, list[int]] = {}
    for index, action in enumerate(actions):
        if isinstance(action, Pick) and action.source == TABLE:
            picks.setdefault(action.block, []).append(index)
    for index, action in enumerate(actions):
        current = plan[index]
        if isinstance(action, Topple):
            pile = state.piles[action.location]
            falling = pile[action.height - 1 :]
            kept = _kept(plan, picks, index, action.location, falling)
            for block in falling[:kept]:
                plan[_next(picks[block], index)] = Pick(block, action.location)
            current = Topple(action.location, action.height + kept) if kept < len(falling) else None
            plan[index] = current
        if current is not None:
            law.carry_out(state, current)
    return tuple(action for action in plan if action is not None)


def _kept(
    plan: Sequence[Action | None], picks: dict[str, list[int]], index: int, location: str, falling: Sequence[str]
) -> int:
    """Return how many of the falling blocks, from the lowest, may stay where they are."""
    until = _next_use(plan, index, location)
    kept = 0
    for block in falling:
        picked = _next(picks.get(block, []), index)
        if picked < 0 or picked >= until:
            break
        until = picked  # what lies above is picked before
        kept += 1
    return kept


def _next(indices: Sequence[int], after: int) -> int:
    position = bisect_right(indices, after)
    return indices[position] if position < len(indices) else -1


def _next_use(plan: Sequence[Action | None], index: int, location: str) -> int:
    for later in range(index + 1, len(plan)):
        match plan[later]:
            case Pick(_, at) | Place(_, at) | Topple(at, _) if at == location:
                return later
    return len(plan)
