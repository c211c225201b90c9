"""The exhaustive judge of the tests agrees with the law's own step function."""

from collections import deque

from hypothesis import given, settings

from smash.problem import Law, State
from tests.oracle import optimal_cost
from tests.strategies import instances, plan_options


def by_the_law(instance, options):
    """Breadth-first search on the law's own actions, one by one."""
    law, start = Law(instance, options), State.start_of(instance)
    queue, seen = deque([(0, start)]), {start.key()}
    while queue:
        cost, state = queue.popleft()
        if law.goal_shortfall(state) is None:
            return cost
        for action in law.legal_actions(state):
            after = state.copy()
            law.apply(after, action)
            if after.key() not in seen:
                seen.add(after.key())
                queue.append((cost + 1, after))
    return None


@settings(max_examples=60, deadline=None)
@given(instances(max_blocks=3, max_buffers=1, odd_names=True), plan_options())
def test_exhaustive_search_and_the_law_find_the_same_optimum(instance, options):
    assert optimal_cost(instance, options) == by_the_law(instance, options)
