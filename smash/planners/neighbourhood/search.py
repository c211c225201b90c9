"""Large-neighbourhood search over plans: windows of a plan, and its tails, are planned anew, again and again.

A *window* is a stretch of the plan between two arrangements that are known. It is a problem of its own, of the blocks
that move in it, and a pass of a beam plans it, sometimes from its end. A *tail* is what comes after some step: the
greedy planner makes it anew, its first choices disturbed. Plans as good as the best are taken over too: they lead
elsewhere. Which neighbourhood and of what size is learnt on the way. All efforts are counted in states and steps, not
in seconds, so that the same seed goes the same way as far as the time allows.
"""

from __future__ import annotations

import itertools
import random
from collections.abc import Sequence
from dataclasses import replace
from typing import Any

from smash.planners.astar.beam import BeamPass
from smash.planners.astar.compiler import Compiler
from smash.planners.astar.engine import Move
from smash.planners.astar.task import make_setting
from smash.planners.greedy.construct import NEVER, Construction
from smash.planners.greedy.shorten import shorten
from smash.planners.neighbourhood.arms import Arm, choose
from smash.planners.neighbourhood.course import arrangement_after, without_detours
from smash.planners.neighbourhood.gathering import gathered, places_of
from smash.planners.neighbourhood.windows import final_piles, window_of
from smash.planners.protocol import left
from smash.problem.problem import Problem
from smash.problem.views.numbered import TOPPLE, Step, cost_of
from smash.problem.views.targets import goal_piles

SIZES, WHOLE = (6, 9, 14, 20, 30, 45, 70, 100, 150), 1_000_000
"""Steps of windows; the last is the whole plan, to the end that it has."""
WIDTHS = (4, 16, 64, 256, 1024, 4096)
"""Of the beams that plan them."""
WEIGHTS = (2, 3)
"""Of the bound in those beams (`BeamPass`)."""
TAILS = (1, 2, 4, 1000)
"""How many choices of a greedy tail are disturbed."""
NOISES = (0.3, 0.6, 1.0, 2.0)
"""How much, at most."""
MOST_MEMORY = 1 << 28
"""The most memory of a beam [bytes]."""
STATE, BEAM = 1.5e-7, 2e-3
"""What a state takes to be expanded, per block and pair of piles, and a beam to begin [about seconds]."""
STEP, TAIL = 3e-5, 5e-4
"""What a greedy step takes, and a tail to begin [about seconds]."""
DETOUR = 1e-5
"""What a step takes to be looked at for detours, at most [s]."""
MARGIN = 100
"""Steps before and after a change where put-asides may have become needless."""
STRETCHES = (2, 4, 8, 16)
"""Of how many times as many steps the steps of some locations are gathered to a window."""
MOST_GATHERED = 2.0
"""A gathered window has no more than so many times the steps of its arm."""
MOST_JOINED = 4
"""Steps whose locations a gathered window has, beside those of a first one."""
MOST_KNOWN = 100_000
"""Windows whose least cost is kept, each by a hash, so that none is searched whole twice: some 10 MB."""
LEAST_PLACES, MANY_PLACES = 3, 5
"""With fewer locations and no topple there is no greedy tail; with fewer than the second nothing is gathered."""


class NeighbourhoodSearch:
    """Improves plans of a plain problem; `run` may be called again and again.

    Args:
        problem: what is planned.
        seed: for all that is drawn.
    """

    def __init__(self, problem: Problem, seed: int = 0) -> None:
        self._problem = problem
        self._numbered = problem.numbered
        self._draw = random.Random(seed)
        self._steps: list[Step] = []
        self._cost = 0
        self._arms: list[Arm] = []
        self._least: dict[int, int] = {}
        self._code: Any = None
        self._class_of: list[int] = []
        self._plainly_moved = not problem.options.topple and not self._numbered.table
        self.tried = 0

    def take(self, steps: Sequence[Step]) -> None:
        """Take over a legal plan, to be improved in place of the one before.

        Args:
            steps: the plan.
        """
        self._steps, self._cost = list(steps), cost_of(steps)
        if not self._arms:
            self._arms = self._all_arms()

    @property
    def cost(self) -> int:
        """What the plan in hand costs."""
        return self._cost

    def run(self, deadline: float) -> list[Step] | None:
        """Search until a better plan is found (returned) or `deadline` [s, `perf_counter`]."""
        if self._code is None:
            self._code = Compiler.code(deadline)
            if self._code is None:
                return None
            self._class_of = make_setting(self._numbered, self._problem.options).class_of
            better = self._settled(self._steps, deadline)
            if better is not None:
                return better
        while self._arms and self._steps and left(deadline) > 0:
            before = self._cost
            arm = choose(self._arms, self._draw)
            effort = self._window(arm, deadline) if arm.width else self._tail(arm, deadline)
            self.tried += 1
            arm.paid(before - self._cost, effort)
            if self._cost < before:
                return self._steps
        return None

    def _all_arms(self) -> list[Arm]:
        """Return the arms, each with what it is thought to take."""
        blocks, places = self._numbered.blocks, self._numbered.locations
        arms = []
        for size in (*(size for size in SIZES if size < len(self._steps)), WHOLE):
            count = min(size, len(self._steps))
            moved, piles = min(blocks, count), min(places, count)
            for width, gathers in itertools.product(WIDTHS, (False, True)):
                if not gathers or (places >= MANY_PLACES and size < WHOLE):
                    arms.append(Arm(size, width, BEAM + STATE * moved * piles**2 * width * count, gathers=gathers))
        if self._problem.options.topple or places >= LEAST_PLACES:
            arms += [Arm(size, 0, TAIL + STEP * len(self._steps)) for size in TAILS]
        return arms

    def _window(self, arm: Arm, deadline: float) -> float:
        """Plan a window anew; return the effort."""
        begin, end = self._gather(arm.size) if arm.gathers else self._stretch(arm.size)
        steps, count = self._steps, len(self._steps)
        final = final_piles(self._numbered, arrangement_after(self._numbered, steps)) if end == count else None
        if end - begin < 2 or (end == count and final is None):
            return BEAM
        window = window_of(self._numbered, arrangement_after(self._numbered, steps[:begin]), steps[begin:end], final)
        if window is None:
            return BEAM
        cost = cost_of(steps[begin:end])
        key = hash((window.blocks, window.locations, window.problem.start, goal_piles(window.problem)))
        if self._least.get(key) == cost:
            return BEAM
        turned = window.whole and self._plainly_moved and self._draw.random() < 0.5
        problem = window.reversed() if turned else window.problem
        running = BeamPass(
            make_setting(problem, self._problem.options),
            self._code,
            cost + 1,
            arm.width,
            MOST_MEMORY,
            self._draw.getrandbits(30),
            weight=self._draw.choice(WEIGHTS),
        )
        moves: list[Move] | None = None
        while not running.over and left(deadline) > 0:
            found = running.advance()
            moves = moves if found is None else found
        made = None if moves is None else running.engine.steps(problem, moves)
        if running.over and not running.truncated:
            if len(self._least) >= MOST_KNOWN:
                self._least.clear()  # most of them are windows of plans that were left long ago
            self._least[key] = cost if made is None else cost_of(made)
        if made is not None:
            if turned:
                made = [(block, target, source) for block, source, target in reversed(made)]
            self._put(begin, end, window.in_plan(made), deadline)
        piles = min(problem.locations, problem.blocks)
        return BEAM + STATE * problem.blocks * piles**2 * running.expanded

    def _stretch(self, size: int) -> tuple[int, int]:
        """Draw a stretch of the plan; return its first step and the one after its last."""
        count = len(self._steps)
        begin = max(0, self._draw.randrange(1 - size // 2, max(2 - size // 2, count - size // 2)))
        return begin, min(count, begin + size)

    def _gather(self, size: int) -> tuple[int, int]:
        """Draw some locations, and bring their steps in some stretch together: return where they are then."""
        begin, end = self._stretch(size * self._draw.choice(STRETCHES))
        steps = self._steps[begin:end]
        places = set(places_of(self._draw.choice(steps)))
        for _ in range(self._draw.randint(1, MOST_JOINED)):
            places.update(places_of(self._draw.choice(steps)))
        while True:
            chosen = {index for index, step in enumerate(steps) if places.issuperset(places_of(step))}
            before, together, after = gathered(steps, chosen)
            if len(together) <= MOST_GATHERED * size:
                break
            steps = steps[: len(steps) // 2]
        begin_of_rest = begin + len(steps)
        self._steps = [*self._steps[:begin], *before, *together, *after, *self._steps[begin_of_rest:]]
        return begin + len(before), begin + len(before) + len(together)

    def _tail(self, arm: Arm, deadline: float) -> float:
        """Have the greedy planner make a tail anew; return the effort."""
        steps, count = self._steps, len(self._steps)
        begin = self._draw.randrange(count)
        target = final_piles(self._numbered, arrangement_after(self._numbered, steps))
        if target is None:
            return TAIL
        arrangement = arrangement_after(self._numbered, steps[:begin])
        start = tuple(tuple(pile) for pile in arrangement.piles)
        due = [NEVER] * self._numbered.blocks
        for index, step in enumerate(steps):
            if step[0] != TOPPLE:
                due[step[0]] = index
        options = self._problem.options
        construction = Construction(
            replace(self._numbered, start=start, table=tuple(sorted(arrangement.table))),
            target,
            topple=options.topple,
            cap=options.max_topple or self._numbered.blocks,
            due=due,
            noise=self._draw.choice(NOISES),
            disturbed=arm.size,
            draw=self._draw,
        )
        made = construction.run((), deadline, 1.1 * (count - begin) + 2)
        if made is not None:
            self._put(begin, count, made, deadline)
        return TAIL + STEP * len(construction.steps)

    def _put(self, begin: int, end: int, made: list[Step], deadline: float) -> None:
        """Put other steps in the place of some of the plan, if that is no worse."""
        first, last = max(0, begin - MARGIN), min(len(self._steps), end + MARGIN)
        changed = shorten([*self._steps[first:begin], *made, *self._steps[end:last]], deadline)
        gain = cost_of(self._steps[first:last]) - cost_of(changed)
        if gain < 0:
            return
        steps = [*self._steps[:first], *changed, *self._steps[last:]]
        if gain > 0:
            self._settled(steps, deadline)
        else:
            self._steps = steps

    def _settled(self, steps: list[Step], deadline: float) -> list[Step] | None:
        """Take over a plan without its detours; return it if it is better."""
        steps = shorten(steps, deadline)
        if DETOUR * len(steps) < left(deadline):
            steps = without_detours(self._numbered, steps, self._class_of)
        better = cost_of(steps) < self._cost
        self._steps, self._cost = steps, cost_of(steps)
        return steps if better else None
