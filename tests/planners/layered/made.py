"""Small problems for the tests of the layered models, and the optimum of a model."""

from smash.planners.milp.solvers import highs
from smash.problem import Costs, OnGoal, PlanOptions, PositionsGoal, StacksGoal, make_instance
from smash.problem.problem import Problem


def problem(start, goal, stacks="s t", buffers="", options=None, **more):
    """Return a problem whose piles, stacks and buffers are words; a mapping as goal is the whole arrangement."""
    start = {location: tuple(pile) for location, pile in start.items()}
    held = [block for carrier in more.get("carriers", ()) for block in carrier.holds]
    blocks = [*(block for pile in start.values() for block in pile), *more.get("table", ()), *held]
    if not isinstance(goal, PositionsGoal | OnGoal):
        goal = StacksGoal({location: tuple(pile) for location, pile in goal.items()})
    instance = make_instance(
        name="made",
        blocks=sorted(blocks),
        stacks=stacks.split(),
        buffers=buffers.split(),
        start=start,
        goal=goal,
        **more,
    )
    return Problem(instance, options or PlanOptions())


NO_TOPPLE = PlanOptions(topple=False)
REVERSED = {"s": "ba"}


def reversal(buffers="u v", options=None):
    """Return the problem of a pile a, b on s that is to be turned over; with topple 5, without 8."""
    return problem({"s": "ab"}, REVERSED, "s", buffers, options)


def priced(start, goal, stacks="s t", **more):
    """Return a problem whose picks cost 3."""
    return problem(start, goal, stacks, costs=Costs({"pick": 3}), **more)


def solved(model, seconds=10.0):
    """Return the solver's result for a model, which must be proven."""
    result = highs.solve(model.milp, time_limit=seconds)
    assert result.status in ("optimal", "infeasible")
    return result


def optimum(model):
    """Return the optimum of a model as a whole number, None where it is infeasible."""
    objective = solved(model).objective
    return None if objective is None else round(objective)
