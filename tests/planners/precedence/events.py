"""The events of a precedence graph drawn out edge by edge: the judge of cycles and of what hits them all.

Written from `docs/theory.md` ("The precedence graph"), apart from the planner's passes over matrices.
"""

import itertools
from graphlib import CycleError, TopologicalSorter


def freed_by(graph, chosen):
    """Return the numbers of the blocks that some of the choices frees, by location and height at the start."""
    freed = set()
    for number in chosen:
        location, low, high, _ = graph.choices[number]
        standing = graph.demands.keep[location], graph.demands.leaving[location]
        freed |= {graph.blocks.index(standing[1][height - standing[0] - 1]) for height in range(low, high + 1)}
    return freed


def in_order(graph, direct):
    """Return whether the events can be ordered if the blocks `direct` move once, straight to their places."""
    before = TopologicalSorter()
    for earlier, later in relations(graph, direct):
        before.add(later, earlier)
    try:
        before.prepare()
    except CycleError:
        return False
    return True


def relations(graph, direct):
    """Yield what comes before what; a block that moves directly has one event for its removal and its placement."""
    in_pile = {block for _, begin, end in graph.piles for block in range(begin, end)}

    def placement(block):
        return ("R" if block in direct and block in in_pile else "P", block)

    for first, (_, begin, end) in zip(graph.first, graph.piles, strict=True):
        for upper, lower in itertools.pairwise(range(begin, end)):
            yield ("R", upper), ("R", lower)
        if first >= 0 and placement(first) != ("R", end - 1):
            yield ("R", end - 1), placement(first)
    for chain in graph.chains:
        for under, upper in itertools.pairwise(chain.tolist()):
            yield placement(under), placement(upper)
    for block in in_pile - set(direct):
        if graph.placed[block]:
            yield ("R", block), ("P", block)


def hits_all(graph, chosen):
    """Return whether the choices leave no cycle and topple every block that only a topple removes for nothing."""
    freed = freed_by(graph, chosen)
    direct = {block for block in range(len(graph.blocks)) if graph.placed[block]} - freed
    return freed.issuperset(graph.must_free) and in_order(graph, direct)


def cheapest_hitting_cost(graph):
    """Return the least cost of choices that hit everything, by trying all sets of choices."""
    every = range(len(graph.choices))
    sets = (chosen for size in range(len(every) + 1) for chosen in itertools.combinations(every, size))
    return min(sum(graph.choices[c].cost for c in chosen) for chosen in sets if hits_all(graph, chosen))


def removed_before_placed(graph, block, other):
    """Return whether the first removal of `block` is before the final placement of `other`, whoever moves directly."""
    after = {}
    for earlier, later in relations(graph, ()):
        if (earlier, later) != (("R", block), ("P", block)) or block != other:
            after.setdefault(earlier, []).append(later)
    reached, waiting = set(), [("R", block)]
    while waiting:
        for event in after.get(waiting.pop(), ()):
            if event not in reached:
                reached.add(event)
                waiting.append(event)
    return ("P", other) in reached
