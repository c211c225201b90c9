"""Lower bounds are reported as soon as they are proven, by the planner itself and through the default planner."""

import pytest

from smash.planners.protocol import IncumbentLog, Relay, SolveOptions
from smash.planners.registry import get_planner
from smash.problem.sets.suites import read_suite


class Listener:
    """An `on_incumbent` that hears bounds too."""

    def __init__(self):
        self.costs = []
        self.bounds = []

    def __call__(self, seconds, cost, actions):
        self.costs.append(cost)

    def bound(self, seconds, bound, origin):
        assert seconds >= 0
        self.bounds.append((bound, origin))


@pytest.mark.parametrize("topple", [True, False])
@pytest.mark.parametrize("name", ["smash", "precedence", "astar", "smash-layered", "greedy"])
def test_reported_bounds_rise_to_the_result(name, topple):
    heard = Listener()
    result = get_planner(name).solve(read_suite("multi-4")[0], SolveOptions(topple), 20.0, heard)
    values = [bound for bound, _ in heard.bounds]
    assert values == sorted(set(values))
    if result.lower_bound is None:
        assert not heard.bounds
    else:
        assert heard.bounds[-1] == (result.lower_bound, result.bound_origin)
    if name != "greedy":
        assert result.status == "optimal"
        assert result.lower_bound == heard.costs[-1]


def test_a_plain_function_is_an_on_incumbent_as_ever():
    costs = []
    result = get_planner("smash").solve(
        read_suite("multi-4")[0], SolveOptions(), 20.0, lambda _seconds, cost, _actions: costs.append(cost)
    )
    assert result.status == "optimal"
    assert costs[-1] == result.lower_bound


def test_a_log_keeps_the_best_bound_and_hands_it_on():
    heard = Listener()
    log = IncumbentLog(read_suite("multi-4")[0], SolveOptions(), heard)
    relay = Relay(log, "part")
    log.prove(3, "first")
    relay.bound(0.0, 2, "worse")
    relay.bound(0.0, 3, "no better")
    relay.bound(0.0, 5, "better")
    assert heard.bounds == [(3, "first"), (5, "better")]
    result = log.result()
    assert (result.status, result.lower_bound, result.bound_origin) == ("unknown", 5, "better")
