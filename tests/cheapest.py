"""Uniform-cost search over the law's own states: the judge of small instances of any family and any costs."""

import heapq
import itertools

from smash.problem import Instance, Law, PlanOptions, State


def cheapest_plan(instance: Instance, options: PlanOptions | None = None, most_states: int = 200_000):
    """Return (cost, actions) of a cheapest plan, or None where there is none.

    Raises:
        MemoryError: after `most_states` states, so that no test takes this for an answer.
    """
    law, start, ties = Law(instance, options), State.start_of(instance), itertools.count()
    queue = [(0, next(ties), start, ())]
    closed = set()
    while queue:
        cost, _, state, actions = heapq.heappop(queue)
        if state.key() in closed:
            continue
        closed.add(state.key())
        if len(closed) > most_states:
            raise MemoryError(f"more than {most_states} states")
        if law.goal_shortfall(state) is None:
            return cost, actions
        for action in law.legal_actions(state):
            after = state.copy()
            price = law.cost(after, action)
            law.apply(after, action)
            if after.key() not in closed:
                heapq.heappush(queue, (cost + price, next(ties), after, (*actions, action)))
    return None
