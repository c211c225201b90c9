"""No planner that says `optimal`, `infeasible` or a bound is ever contradicted by another, on random problems."""

import random
import sys
from time import process_time

import pytest

from smash.planners.protocol import Settings, ask
from smash.planners.registry import get_planner, planner_names
from smash.problem import PlanOptions
from smash.problem.errors import Unsupported
from smash.problem.problem import Problem
from smash.problem.sets.open_instances import Shape, draw_instance
from tests.relations import related

PROBLEMS = 2_000
SOME = 40
"""Those of `make test-slow`: about two minutes; the others are for the night (`make test-nightly`)."""
BATCH = 98
BUDGET = 5.0
"""Seconds of each plan: what is not proven by then claims less, and is compared all the same."""


def drawn(number):
    """Draw problem `number`: every goal kind, up to five blocks, starts on buffers, on the table and in the hand."""
    if number % 3 == 0:
        return related(number, most_blocks=5)
    draw = random.Random(f"contradictions-{number}")
    blocks, kind = draw.randint(2, 5), draw.choice(["stacks", "positions", "on"])
    shape = Shape(
        blocks=blocks,
        stacks=draw.randint(2, 2 + (blocks > 4)),
        buffers=draw.randint(0, 3),
        kind=kind,
        listed=1.0 if kind == "stacks" else draw.choice([0.4, 0.7, 1.0]),
        toppled=draw.choice([0.0, 0.0, 0.4]) if blocks > 3 else 0.0,
    )
    options = PlanOptions(draw.random() < 0.5, draw.choice([None, None, 1, 2]))
    return Problem(draw_instance(f"contradictions-{number}", shape, draw), options)


def provers():
    """Return the planners that prove something and can run here."""
    names = [name for name in planner_names() if ":" not in name and getattr(get_planner(name), "proves", False)]
    return [name for name in names if getattr(get_planner(name), "missing", lambda: None)() is None]


def asked(problem, names):
    """Return what each planner that takes a problem says of it."""
    said = {}
    for name in names:
        try:
            said[name] = ask(get_planner(name), problem, Settings(), BUDGET)
        except Unsupported:
            continue
    return said


def contradictions(said):
    """Return what cannot all be true."""
    found = []
    plans = {name: plan for name, plan in said.items() if plan.actions is not None}
    for name, plan in said.items():
        for other, better in plans.items():
            if plan.status == "infeasible":
                found.append(f"{name} says that there is no plan, {other} has one of cost {better.cost}")
            elif plan.lower_bound is not None and plan.lower_bound > better.cost:
                found.append(f"{name} proves {plan.lower_bound}, {other} has a plan of cost {better.cost}")
    return found


def looked_at(numbers):
    """Return what is contradicted in some problems, and how many claims each planner made of them."""
    names, found, claims = provers(), [], {}
    for number in numbers:
        problem = drawn(number)
        said = asked(problem, names)
        for name, plan in said.items():
            assert plan.actions is None or problem.law.check(plan.actions).accepted, (number, name)
            claims[name] = claims.get(name, 0) + (plan.status in ("optimal", "infeasible"))
        found += [f"{number}: {line}" for line in contradictions(said)]
    return found, claims


@pytest.mark.slow
@pytest.mark.timeout(1200)
def test_no_planner_is_contradicted_on_some_random_problems():
    found, claims = looked_at(range(SOME))
    assert not found
    assert {"smash", "astar", "precedence"} <= set(claims)
    assert min(claims.values()) > 0


@pytest.mark.nightly
@pytest.mark.timeout(7200)
@pytest.mark.parametrize("batch", range((PROBLEMS - SOME) // BATCH))
def test_no_planner_is_contradicted(batch):
    begin = SOME + batch * BATCH
    found, _ = looked_at(range(begin, begin + BATCH))
    assert not found


def main():
    """Look at problems from a number on until so many seconds of this process are spent, and count the claims."""
    first, seconds = int(sys.argv[1]), float(sys.argv[2])
    total, number = {}, first
    while process_time() < seconds and number < PROBLEMS:
        found, claims = looked_at([number])
        assert not found, found
        for name, count in claims.items():
            total[name] = total.get(name, 0) + count
        number += 1
        print(number - first, total, f"{process_time():.0f} s", flush=True)


if __name__ == "__main__":
    main()
