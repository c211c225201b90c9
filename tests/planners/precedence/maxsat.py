"""The fewest blocks put aside by core-guided MaxSAT: a second proof, which shares nothing with the planner's.

RC2 (Ignatiev, Morgado and Marques-Silva) of python-sat finds the fewest blocks that hit the cycles known so far; the
judge's own events (`events.py`) say which cycles its answer leaves, until it leaves none.
"""

from graphlib import CycleError, TopologicalSorter

from pysat.examples.rc2 import RC2
from pysat.formula import WCNF

from tests.planners.precedence.events import relations


def fewest_aside(graph):
    """Return how many blocks have to be put aside, on top of those that move in any case."""
    after = {}
    for earlier, later in relations(graph, ()):
        after.setdefault(earlier, []).append(later)
    movers = [b for _, begin, end in graph.piles for b in range(begin, end) if graph.placed[b]]
    turns = {block: _turns(block, after, set(movers)) for block in movers}
    formula = WCNF()
    for clause in _short_cycles(turns):
        formula.append([block + 1 for block in clause])
    for block in movers:
        formula.append([-(block + 1)], weight=1)
    solver = RC2(formula, adapt=True, exhaust=True, minz=True)
    while True:
        aside = {literal - 1 for literal in solver.compute() if 0 < literal <= len(graph.blocks)}
        left = list(_cycles_left(turns, aside))
        if not left:
            return solver.cost
        for cycle in left:
            solver.add_clause([block + 1 for block in cycle])


def _turns(block, after, movers):
    """Return the blocks that are placed after `block` has left its start pile, its own placement apart."""
    reached = set()
    waiting = [event for event in after.get(("R", block), ()) if event != ("P", block)]
    while waiting:
        event = waiting.pop()
        if event not in reached:
            reached.add(event)
            waiting.extend(after.get(event, ()))
    return {name for kind, name in reached if kind == "P"} & movers


def _short_cycles(turns):
    for first, following in turns.items():
        if first in following:
            yield [first]
        for second in following:
            if first < second and first in turns[second]:
                yield [first, second]
            elif first not in turns[second]:
                yield from (
                    [first, second, third] for third in turns[second] if first in turns[third] and third > first
                )


def _cycles_left(turns, aside):
    """Yield cycles that `aside` does not hit, then those left when a block of each is put aside too."""
    aside = set(aside)
    while True:
        order = TopologicalSorter({b: {c for c in turns[b] if c not in aside} for b in turns if b not in aside})
        try:
            order.prepare()
        except CycleError as left:
            cycle = _shortest(turns, left.args[1][:-1][::-1])
            yield cycle
            aside.add(cycle[0])
        else:
            return


def _shortest(turns, cycle):
    """Return `cycle` without what can be left out of it: where a block leads to a later one, those between."""
    if cycle[1 % len(cycle)] not in turns[cycle[0]]:
        cycle = cycle[::-1]
    at = 0
    while at < len(cycle):
        ahead = max(other for other in range(at + 1, len(cycle) + 1) if cycle[other % len(cycle)] in turns[cycle[at]])
        del cycle[at + 1 : ahead]
        at += 1
    return cycle
