"""Exhaustive search over states, written apart from the package's law: the judge of small instances in tests."""

from smash.problem import Instance, OnGoal, PlanOptions, PositionsGoal, StacksGoal

State = tuple[tuple[tuple[str, ...], ...], frozenset[str]]


def optimal_cost(instance: Instance, options: PlanOptions | None = None, most_states: int = 300_000) -> int | None:
    """Return the fewest actions that reach the goal, or None where no plan exists.

    Breadth-first over costs: a transfer (pick and place) costs 2, a topple 1.

    Raises:
        MemoryError: after `most_states` states, so that no test takes this for an answer.
    """
    options = options or PlanOptions()
    stacks = len(instance.stacks)
    start = (tuple(instance.start[location] for location in instance.locations), frozenset(instance.table))
    layers: list[list[State]] = [[_canonical(start, stacks)], [], []]
    if instance.hand is not None:  # the first action is a place
        piles, table = start
        put = [(*piles[:at], (*pile, instance.hand), *piles[at + 1 :]) for at, pile in enumerate(piles)]
        layers = [[], [_canonical((after, table), stacks) for after in put], []]
    seen: set[State] = set()
    cost = 0
    while any(layers):
        for state in layers[0]:
            if state in seen:
                continue
            seen.add(state)
            if len(seen) > most_states:
                raise MemoryError(f"more than {most_states} states")
            if _holds(instance, state):
                return cost
            for step, after in _moves(state, stacks, options):
                layers[step].append(_canonical(after, stacks))
        layers = [layers[1], layers[2], []]
        cost += 1
    return None


def _canonical(state: State, stacks: int) -> State:
    piles, table = state
    return piles[:stacks] + tuple(sorted(piles[stacks:])), table


def _moves(state: State, stacks: int, options: PlanOptions):
    piles, table = state
    sources = [(pile[-1], index) for index, pile in enumerate(piles) if pile] + [(block, None) for block in table]
    for block, source in sources:
        empty_seen = False
        for target, pile in enumerate(piles):
            if target == source or (target >= stacks and not pile and empty_seen):
                continue
            empty_seen = empty_seen or (target >= stacks and not pile)
            after = list(piles)
            after[target] = (*pile, block)
            if source is not None:
                after[source] = piles[source][:-1]
            yield 2, (tuple(after), table if source is not None else table - {block})
    if not options.topple:
        return
    for index, pile in enumerate(piles[:stacks]):
        for falling in range(1, min(len(pile), options.max_topple or len(pile)) + 1):
            after = list(piles)
            after[index] = pile[: len(pile) - falling]
            yield 1, (tuple(after), table | frozenset(pile[len(pile) - falling :]))


def _holds(instance: Instance, state: State) -> bool:
    piles, table = state
    goal = instance.goal
    if isinstance(goal, StacksGoal):
        wanted = tuple(tuple(goal.stacks.get(location, ())) for location in instance.stacks)
        return not table and piles[: len(wanted)] == wanted
    where = {block: (index, height) for index, pile in enumerate(piles) for height, block in enumerate(pile, start=1)}
    if isinstance(goal, PositionsGoal):
        index_of = {location: index for index, location in enumerate(instance.locations)}
        return all(where.get(block) == (index_of[at], height) for block, (at, height) in goal.positions.items())
    assert isinstance(goal, OnGoal)
    for upper, under in goal.on.items():
        if upper not in where or under not in where:
            return False
        (index, height), (index_under, height_under) = where[upper], where[under]
        if index != index_under or height != height_under + 1:
            return False
    if not all(block in where and where[block][1] == 1 for block in goal.bottom):
        return False
    if not all(block in table or (block in where and where[block][1] == 1) for block in goal.ontable):
        return False
    tops = {pile[-1] for pile in piles if pile}
    return all(block in table or block in tops for block in goal.clear)
