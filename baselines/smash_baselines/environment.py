"""The law as a Gymnasium environment: reset, step, masks of legal actions, reward = -cost.

    import gymnasium
    import smash, smash_baselines.environment

    instances = smash.generate("multi", 4, buffers=2, count=100, seed=7)
    env = gymnasium.make("smash/StackRearrangement-v0", instances=instances)
    observation, info = env.reset(seed=0)
    observation, reward, terminated, truncated, info = env.step(info["action_mask"].nonzero()[0][0])

It needs the extra `gym`.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import gymnasium
import numpy as np
from gymnasium import spaces
from numpy.typing import NDArray

from smash.problem import (
    TABLE,
    Action,
    Instance,
    Law,
    OnGoal,
    Pick,
    Place,
    PlanOptions,
    PositionsGoal,
    StacksGoal,
    State,
    Topple,
    Unsupported,
)
from smash.problem.arguments import whole_number

NAME = "smash/StackRearrangement-v0"
Observation = dict[str, Any]


class StackRearrangement(gymnasium.Env[Observation, np.int64]):
    """Rearrange stacks: pick, place and topple by the law, a block, location or height of a stack at a time.

    With n blocks, l locations (stacks, then buffers) and s stacks the actions are numbered: pick the top of a location
    (l), pick a block from the table region (n), place on a location (l), topple a stack at a height (s x n, heights
    from 1 within each stack). An illegal action changes nothing, costs 1, and `info["refused"]` says why.

    Observations, blocks numbered from 1 and 0 for none:

    - `piles` (l x n): the block at each height of each location, from the bottom;
    - `table` (n): 1 for blocks in the table region;
    - `hand`: the block in the hand;
    - `goal_piles` (l x n): the block that must be there (goals `stacks` and `positions`; for `stacks` 0 is empty);
    - `goal_under` (n): what must be under each block: 0 anything, a block, n + 1 the bottom of a location, n + 2 the
      bottom of a location or the table region (goals `on`);
    - `goal_clear` (n): 1 for blocks on which nothing may lie (goals `on`).

    Attributes:
        instance: the problem of the running episode.
        law: its law.
        state: where every block is now.
    """

    metadata = {"render_modes": ["ansi"], "render_fps": 4}  # noqa: RUF012

    def __init__(
        self,
        instances: Instance | Sequence[Instance],
        *,
        topple: bool = True,
        max_topple: int | None = None,
        limit: int | None = None,
        render_mode: str | None = None,
    ) -> None:
        """Make the environment.

        Args:
            instances: one, or several with equal numbers of blocks, stacks and buffers: `reset` draws one of them, or
                takes that of `options={"instance": number}`.
            topple: whether topples are allowed.
            max_topple: most blocks of one topple.
            limit: steps after which an episode is truncated; 10 a block where None.
            render_mode: `ansi`, or None.

        Raises:
            Unsupported: where an instance has carriers, or they are not all of one shape.
        """
        self._instances = [instances] if isinstance(instances, Instance) else list(instances)
        shapes = {(len(i.blocks), len(i.stacks), len(i.buffers)) for i in self._instances}
        if len(shapes) != 1:
            raise Unsupported(f"{NAME} takes instances of one shape: blocks, stacks, buffers; got {sorted(shapes)}")
        if any(instance.carriers for instance in self._instances):
            raise Unsupported(f"{NAME} has no action for carriers")
        ((blocks, stacks, buffers),) = shapes
        self._shape = stacks + buffers, blocks
        self._options = PlanOptions(topple, max_topple)
        self._limit = 10 * blocks if limit is None else limit
        self.render_mode = render_mode
        self._count = 2 * (stacks + buffers) + blocks + stacks * blocks
        self.action_space = spaces.Discrete(self._count)
        piles = np.full(self._shape, blocks + 1, dtype=np.int64)
        self.observation_space = spaces.Dict(
            {
                "piles": spaces.MultiDiscrete(piles),
                "table": spaces.MultiBinary(blocks),
                "hand": spaces.Discrete(blocks + 1),
                "goal_piles": spaces.MultiDiscrete(piles),
                "goal_under": spaces.MultiDiscrete(np.full(blocks, blocks + 3, dtype=np.int64)),
                "goal_clear": spaces.MultiBinary(blocks),
            }
        )
        self._begin(self._instances[0])

    def _begin(self, instance: Instance) -> None:
        self.instance = instance
        self.law = Law(instance, self._options)
        self.state = State.start_of(instance)
        self._number = {block: number for number, block in enumerate(instance.blocks, start=1)}
        self._goal = self._goal_arrays()
        self._steps = 0

    def reset(
        self, *, seed: int | None = None, options: dict[str, Any] | None = None
    ) -> tuple[Observation, dict[str, Any]]:
        """Begin an episode; `options={"instance": number}` chooses the instance, from 0, else it is drawn.

        Raises:
            SmashError: where no instance has that number.
        """
        super().reset(seed=seed)
        chosen = (options or {}).get("instance")
        if chosen is None:
            chosen = self.np_random.integers(len(self._instances))
        given = int(chosen) if isinstance(chosen, np.integer) else chosen
        number = whole_number("options['instance']", given, 0, len(self._instances) - 1)
        self._begin(self._instances[number])
        return self._observation(), self._info()

    def step(self, action: np.int64) -> tuple[Observation, float, bool, bool, dict[str, Any]]:
        """Carry out an action; the reward is minus its cost. What is no action's number is an illegal action."""
        known = self.action_space.contains(action)
        asked = self.action_of(int(action)) if known else None
        refused: str | None = "no such block there" if known else "no such action"
        if asked is not None:
            refused = self.law.refusal(self.state, asked)
        cost = 1
        if asked is not None and refused is None:
            cost = self.law.cost(self.state, asked)
            self.law.carry_out(self.state, asked)
        self._steps += 1
        reached = self.law.goal_shortfall(self.state) is None
        info = self._info() | ({} if refused is None else {"refused": refused})
        return self._observation(), -float(cost), reached, self._steps >= self._limit and not reached, info

    def action_of(self, number: int) -> Action | None:
        """Return the law's action of a number in the present state, or None where it names no block or no action."""
        if not self.action_space.contains(number):
            return None
        locations, blocks = self._shape
        if number < locations:
            location = self.instance.locations[number]
            pile = self.state.piles[location]
            return Pick(pile[-1], location) if pile else None
        number -= locations
        if number < blocks:
            return Pick(self.instance.blocks[number], TABLE)
        number -= blocks
        if number < locations:
            return None if self.state.hand is None else Place(self.state.hand, self.instance.locations[number])
        stack, height = divmod(number - locations, blocks)
        return Topple(self.instance.stacks[stack], height + 1)

    def number_of(self, action: Action) -> int:
        """Return the number of an action of the law.

        Raises:
            Unsupported: where it is none of pick, place and topple.
        """
        locations, blocks = self._shape
        match action:
            case Pick(block, source) if source == TABLE:
                return locations + self.instance.blocks.index(block)
            case Pick(_, source):
                return self.instance.locations.index(source)
            case Place(_, target):
                return locations + blocks + self.instance.locations.index(target)
            case Topple(stack, height):
                return 2 * locations + blocks + self.instance.stacks.index(stack) * blocks + height - 1
        raise Unsupported(f"{NAME} has no number for {action}")

    def action_masks(self) -> NDArray[np.int8]:
        """Return 1 for every legal action, in the form that `action_space.sample(mask)` takes."""
        mask = np.zeros(self._count, dtype=np.int8)
        mask[[self.number_of(action) for action in self.law.legal_actions(self.state)]] = 1
        return mask

    def render(self) -> str | None:
        """Return the state in lines of text, where the render mode is `ansi`."""
        return str(self.state) if self.render_mode == "ansi" else None

    def _info(self) -> dict[str, Any]:
        return {"action_mask": self.action_masks(), "instance": self.instance.name}

    def _observation(self) -> Observation:
        blocks = self._shape[1]
        table = np.zeros(blocks, dtype=np.int8)
        table[[self._number[block] - 1 for block in self.state.table]] = 1
        hand = np.int64(0 if self.state.hand is None else self._number[self.state.hand])
        goal = {name: array.copy() for name, array in self._goal.items()}
        return {"piles": self._array(self.state.piles), "table": table, "hand": hand, **goal}

    def _array(self, piles: dict[str, Any]) -> NDArray[np.int64]:
        array = np.zeros(self._shape, dtype=np.int64)
        for row, location in enumerate(self.instance.locations):
            pile = piles.get(location, ())
            array[row, : len(pile)] = [self._number[block] for block in pile]
        return array

    def _goal_arrays(self) -> Observation:
        blocks, goal = self._shape[1], self.instance.goal
        under, clear = np.zeros(blocks, dtype=np.int64), np.zeros(blocks, dtype=np.int8)
        piles = (
            self._array(dict(goal.stacks)) if isinstance(goal, StacksGoal) else np.zeros(self._shape, dtype=np.int64)
        )
        if isinstance(goal, PositionsGoal):
            for block, (location, height) in goal.positions.items():
                piles[self.instance.locations.index(location), height - 1] = self._number[block]
        if isinstance(goal, OnGoal):
            wanted = dict.fromkeys(goal.ontable, blocks + 2) | dict.fromkeys(goal.bottom, blocks + 1)
            wanted |= {upper: self._number[lower] for upper, lower in goal.on.items()}
            under[[self._number[block] - 1 for block in wanted]] = list(wanted.values())
            clear[[self._number[block] - 1 for block in goal.clear]] = 1
        return {"goal_piles": piles, "goal_under": under, "goal_clear": clear}


def register() -> None:
    """Make the environment known to `gymnasium.make`; importing this module does it."""
    if NAME not in gymnasium.registry:
        gymnasium.register(NAME, entry_point=f"{__name__}:{StackRearrangement.__name__}")


register()
