"""Clauses fulfilled for the least cost: by both solvers, and by trying all."""

import itertools
import math
import random

import pytest

from smash.planners.precedence.clauses import Cheapest, Clauses

SOLVERS = [False, True]


def drawn(seed):
    """Return clauses over six variables that some values fulfil, and further ones, each with a positive literal."""
    draw = random.Random(seed)
    clauses = Clauses()
    variables = [clauses.variable(draw.choice((0, 1, 2))) for _ in range(6)]
    further = []
    for _ in range(8):
        clause = draw.sample(variables, draw.randint(1, 3))
        clause = [clause[0], *(draw.choice((-1, 1)) * literal for literal in clause[1:])]
        clauses.ask(clause) if draw.random() < 0.6 else further.append(clause)
    if draw.random() < 0.5:
        clauses.counts.append((tuple(draw.sample(variables, 4)), draw.randint(1, 3)))
    return clauses, further


def fulfilled(clauses, values):
    """Whether values, 1 where true, fulfil the clauses and the counts."""
    true = {number if value else -number for number, value in enumerate(values, start=1)}
    return all(not true.isdisjoint(clause) for clause in clauses.asked) and all(
        len(true.intersection(variables)) >= count for variables, count in clauses.counts
    )


def least(clauses):
    """Return the least cost of all values that fulfil the clauses."""
    return min(
        sum(map(int.__mul__, values, clauses.costs))
        for values in itertools.product((0, 1), repeat=len(clauses.costs))
        if fulfilled(clauses, values)
    )


@pytest.mark.parametrize("maxsat", SOLVERS)
@pytest.mark.parametrize("seed", range(25))
def test_nothing_cheaper_fulfils_them_however_many_become_known_later(seed, maxsat):
    clauses, further = drawn(seed)
    bounds = []
    solver = Cheapest(clauses, lambda bound: bounds.append(bound) or True, maxsat=maxsat)
    for clause in [None, *further]:
        if clause is not None:
            clauses.ask(clause)
        values = solver.solve(math.inf).astype(int).tolist()
        assert fulfilled(clauses, values)
        assert sum(map(int.__mul__, values, clauses.costs)) == least(clauses) == max([0, *bounds])
    assert bounds == sorted(bounds)
    solver.close()


def test_a_clause_is_asked_for_once():
    clauses = Clauses()
    one, other = clauses.variable(), clauses.variable(2)
    assert clauses.ask([other, one])
    assert not clauses.ask([one, other, one])
    assert clauses.asked == {(one, other): None}
