"""Whether a robot can do what a plan asks in a scene: said before anything moves."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from smash.execution.actions.registry import MOTIONS
from smash.execution.scene.piles import Needs
from smash.execution.scene.tabletop import DoesNotFit, Slot, Tabletop
from smash.motion.robot import Robot
from smash.problem.errors import Unsupported
from smash.problem.model import Action, Aggregating
from smash.problem.words import counted


def require_able(
    robot: Robot,
    tabletop: Tabletop,
    actions: Sequence[Action],
    needs: Needs,
    places: Mapping[str, Slot],
) -> None:
    """Refuse a plan with piles where the arm does not reach, or with actions that it has no motion for.

    Args:
        robot: The robot.
        tabletop: The scene.
        actions: A plan that the law accepts.
        needs: What it asks of the places.
        places: The slots of locations and stations.

    Raises:
        DoesNotFit: where its hand does not hold a block, or a pile, or a station that is used, is out of reach.
        Unsupported: where what the hand carries is kept level, and the arm cannot do that.
    """
    tabletop.require_held(robot.hand)
    for action in actions:
        motion = MOTIONS.get(type(action)) if isinstance(action, Aggregating) else None
        if motion is not None and motion.level and not robot.upright:
            raise Unsupported(
                f"robot {robot.name!r}: its first joint does not turn it about the vertical, "
                f"which {type(action).__name__.lower()} needs: it keeps level what the hand carries"
            )
    asked = dict.fromkeys(needs.stations, ("a carrier", tabletop.side))
    for place, piles in needs.piles.items():
        tallest = max(piles, key=tabletop.tall)
        asked[place] = counted(len(tallest), "block"), tabletop.tall(tallest)
    for place, (what, height) in asked.items():
        if not tabletop.reaches(places[place], height):
            raise DoesNotFit(
                f"robot {robot.name!r} does not reach {what} at {place!r} of scene {tabletop.name!r}, "
                f"{places[place].radius:.2f} m from its base; it reaches {_say(robot, tabletop.longest)}"
            )


def _say(robot: Robot, side: float) -> str:
    """Where it reaches how high, in words."""
    words: list[str] = []
    levels = [(radius, int(height / side + 1e-9)) for radius, height in robot.heights]
    start = 0
    for index in range(1, len(levels) + 1):
        if index == len(levels) or levels[index][1] != levels[start][1]:
            if levels[start][1]:
                words.append(f"{levels[start][1]} from {levels[start][0]:.2f} to {levels[index - 1][0]:.2f} m")
            start = index
    return ", ".join(words) or "no block anywhere"
