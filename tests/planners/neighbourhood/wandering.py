"""Plans that wander before they go to the goal."""

import math
import random

from smash.planners.greedy import greedy_steps
from smash.planners.neighbourhood.course import steps_of
from smash.problem.model import Instance, State
from smash.problem.problem import Problem


def wandering_plan(instance, options, seed, count=8):
    """Return a problem and a legal plan of it that begins with drawn actions; None where it has none."""
    problem = Problem(instance, options)
    draw, state, actions = random.Random(seed), State.start_of(instance), []
    while len(actions) < count or state.hand is not None:
        legal = list(problem.law.legal_actions(state))
        if not legal:
            break
        actions.append(draw.choice(legal))
        problem.law.apply(state, actions[-1])
    start = {location: tuple(pile) for location, pile in state.piles.items()}
    moved = Instance(
        "moved", instance.blocks, instance.stacks, instance.buffers, start, instance.goal, tuple(sorted(state.table))
    )
    rest = next(greedy_steps(Problem(moved, options), math.inf), None)
    return None if rest is None else (problem, [*steps_of(problem.numbered, actions), *rest])


def verdict_on(problem, steps):
    """Return what the law says to a plan."""
    return problem.law.check(problem.numbered.actions(steps))
