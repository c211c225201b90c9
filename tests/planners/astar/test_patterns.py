"""Pattern databases: exact for all blocks together, never above a cheapest plan, and in use they change no answer."""

import math
import random
from time import perf_counter

import pytest

from smash.planners.astar import driver, pattern_sets
from smash.planners.astar.compiled import INTERPRETED
from smash.planners.astar.engine import StoreEngine
from smash.planners.astar.pattern_sets import PatternBuilder, Patterns, takes_patterns
from smash.planners.astar.patterns import PATTERNS, pattern_bound
from smash.planners.astar.search import BEST, PROVEN, UPPER
from smash.planners.astar.task import make_setting
from smash.problem import PlanOptions, PositionsGoal, StacksGoal, make_instance
from smash.problem.views.numbered import Numbered
from tests.oracle import optimal_cost

NO_TOPPLE = PlanOptions(topple=False)


def drawn(seed, most_blocks=5):
    """Draw start and goal over two to four locations, of which the goal leaves some empty.

    Of odd seeds it lists the lower parts of its piles alone (a `positions` goal).
    """
    draw = random.Random(seed)
    blocks = [f"b{number}" for number in range(draw.randint(2, most_blocks))]
    stacks = [f"s{number}" for number in range(draw.randint(2, 3))]
    buffers = [f"u{number}" for number in range(draw.randint(3 - len(stacks), 1))]

    def arrangement(places):
        piles = {place: [] for place in places}
        for block in draw.sample(blocks, len(blocks)):
            piles[draw.choice(places)].append(block)
        return {place: tuple(pile) for place, pile in piles.items()}

    wanted = arrangement(stacks)
    listed = {place: pile[: draw.randint(0, len(pile))] for place, pile in wanted.items()}
    positions = {block: (place, height) for place, pile in listed.items() for height, block in enumerate(pile, 1)}
    goal = PositionsGoal(positions) if seed % 2 else StacksGoal(wanted)
    return make_instance(arrangement(stacks + buffers), goal, name="x", blocks=blocks, stacks=stacks, buffers=buffers)


@pytest.fixture(autouse=True)
def one_partition_alone(monkeypatch):
    """No time is left for further ones."""
    monkeypatch.setattr(pattern_sets, "ENTRY_SECONDS", 1e6)


def bound_at_start(problem, patterns):
    setting = make_setting(problem, NO_TOPPLE)
    engine = StoreEngine(setting, INTERPRETED, False)
    engine.unpack_start()
    return pattern_bound(engine.task, engine.cells, patterns.layout, patterns.tables)


@pytest.mark.parametrize("seed", range(40))
def test_one_pattern_of_all_blocks_is_the_cost_of_a_cheapest_plan(seed, monkeypatch):
    instance = drawn(seed)
    problem = Numbered.of(instance)
    builder = PatternBuilder(problem, INTERPRETED)
    monkeypatch.setattr(builder, "_size", lambda seconds: problem.blocks)
    assert bound_at_start(problem, builder.build(perf_counter() + 100)) == optimal_cost(instance, NO_TOPPLE)


@pytest.mark.parametrize("seed", range(40))
def test_disjoint_patterns_add_up_to_no_more(seed, monkeypatch):
    instance = drawn(seed)
    problem = Numbered.of(instance)
    builder = PatternBuilder(problem, INTERPRETED, seed)
    monkeypatch.setattr(builder, "_size", lambda seconds: min(2, problem.blocks))
    patterns = builder.build(perf_counter() + 100)
    assert patterns.layout[PATTERNS] == math.ceil(problem.blocks / 2)
    assert bound_at_start(problem, patterns) <= optimal_cost(instance, NO_TOPPLE)
    built = list(patterns.tables)
    assert 255 not in built  # three locations reach every arrangement


@pytest.mark.parametrize("seed", range(12))
def test_a_search_with_them_proves_the_same_cost(seed, machine_code):
    instance = drawn(seed + 100, 6)
    problem = Numbered.of(instance)
    engine = StoreEngine(make_setting(problem, NO_TOPPLE), machine_code, True)
    builder = PatternBuilder(problem, machine_code, seed)
    builder._size = lambda seconds: min(3, problem.blocks)
    engine.patterns = builder.build(perf_counter() + 100)
    engine.share = 10**6
    engine.open(100_000, engine.first_bound(), 200)
    assert engine.expand() == PROVEN
    assert engine.counter(UPPER) == optimal_cost(instance, NO_TOPPLE)
    assert len(engine.steps(problem, engine.path())) * 2 == engine.counter(UPPER) or engine.counter(BEST) < 0


def test_what_is_not_a_transfer_between_few_places_has_none():
    instance = drawn(1)
    assert takes_patterns(Numbered.of(instance), NO_TOPPLE)
    assert not takes_patterns(Numbered.of(instance), PlanOptions())


def test_none_bound_nothing():
    problem = Numbered.of(drawn(2))
    assert bound_at_start(problem, Patterns.none(False)) == 0


def test_the_driver_builds_them_once_its_search_has_lasted(monkeypatch, machine_code):
    monkeypatch.setattr(driver, "PATTERN_AFTER", -1.0)
    monkeypatch.setattr(driver, "INTERPRETED_NODES", 4)
    instance = drawn(107, 6)
    problem = Numbered.of(instance)
    best = optimal_cost(instance, NO_TOPPLE)
    search = driver.StateSearch(problem, NO_TOPPLE, best + 3)
    found = None
    while search.ended is None:
        found = search.run(perf_counter() + 60) or found
    assert search.patterns is not None
    assert search.lower_bound == best == 2 * len(found)
