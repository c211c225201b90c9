"""The outcome model of a scene: trials of topples, and the times of picks and places that are rehearsed for it."""

from __future__ import annotations

from collections.abc import Iterable, Iterator

import msgspec
import numpy as np

from smash.execution.rehearsal import Rehearsal
from smash.execution.scene.tabletop import Slot, Tabletop
from smash.forecast.durations import TimedMove, fit
from smash.forecast.expected import Forecaster
from smash.forecast.model import Landed, MoveTimes, OutcomeModel, Spot, Toppled
from smash.motion.robots import load_robot
from smash.problem.actions.topple import Topple
from smash.problem.errors import SmashError
from smash.problem.making import make_instance
from smash.problem.model import TABLE, Action, Pick, Place, PositionsGoal, State
from smash.problem.problem import Problem
from smash.records.trials import Trial

TROUBLE = 20.0
"""Seconds that a block costs which cannot be grasped when its turn comes: six actions more, as the committed episodes
that were planned anew had on average."""
ROUNDS = 60
"""Random arrangements that are rehearsed for the times of picks and places."""
FEWEST = 4
"""Blocks of the smallest arrangement."""
MOVES = 10
"""Blocks that are moved in each."""
TOPPLED_FIRST = 0.7
"""Share of the arrangements in which a pile is toppled first."""
REBUILT = 0.5
"""Share of its blocks that go back to where the pile was toppled: a pile grows beside those that still lie."""
TO_STACK = 0.6
"""Share of the blocks that go to a stack's place; the others go to a buffer's."""
DIGITS = 4


def outcome_model(tabletop: Tabletop, trials: Iterable[Trial], *, rounds: int = ROUNDS, seed: int = 0) -> OutcomeModel:
    """Make the model of a scene.

    Args:
        tabletop: The scene.
        trials: Topples in it; those whose blocks landed at an unknown time are left out. That no push was found is an
            outcome, too.
        rounds: Random arrangements that are rehearsed.
        seed: Of these.

    Raises:
        SmashError: where no trial can be used, they are of several engines, or the blocks of the scene differ.
    """
    require_modelled(tabletop)
    trials = list(trials)
    engines = {trial.engine for trial in trials}
    if len(engines) > 1:
        raise SmashError(f"an outcome model is of one engine; the trials are of {' and '.join(sorted(engines))}")
    topples = tuple(_toppled(trial) for trial in trials if trial.seconds is not None or not trial.landings)
    if not any(topple.landed for topple in topples):
        raise SmashError("an outcome model takes trials with landings and times: none has both; make the map again")
    bare = OutcomeModel(
        scene=tabletop.name,
        layout=tabletop.fingerprint,
        engine=engines.pop(),
        side=tabletop.side,
        highest=tabletop.highest,
        ready=_ready(tabletop)[0],
        ready_height=_ready(tabletop)[1],
        stacks=tuple(map(_spot, tabletop.stacks)),
        buffers=tuple(map(_spot, tabletop.buffers)),
        moves=MoveTimes({}, 0.0, 0.0, 1),
        trouble=TROUBLE,
        stuck=1.0,
        topples=topples,
    )
    tried = list(tried_moves(tabletop, bare, rounds, seed))
    dangers = sum(danger for _, danger in tried)
    stuck = sum(move is None and danger > 0.0 for move, danger in tried)
    return msgspec.structs.replace(
        bare,
        moves=fit(move for move, _ in tried if move is not None),
        stuck=round(min(1.0, (stuck + 0.5) / (dangers + 1.0)), DIGITS),
    )


def require_modelled(tabletop: Tabletop) -> None:
    """Refuse a scene that no outcome model can be made of.

    Raises:
        SmashError: where its blocks are no cubes of one size, or the robot reaches no pile worth a rehearsal.
    """
    if not tabletop.uniform:
        words = f"an outcome model knows cubes of one size alone, and scene {tabletop.name!r} has boxes"
        raise SmashError(f"{words}: the map is made without it")
    if tabletop.highest < FEWEST:
        words = f"an outcome model is made of piles of {FEWEST} blocks or more"
        raise SmashError(f"{words}, and the robot of scene {tabletop.name!r} reaches no more than {tabletop.highest}")


def tried_moves(
    tabletop: Tabletop, model: OutcomeModel, rounds: int, seed: int
) -> Iterator[tuple[TimedMove | None, float]]:
    """Yield the picks and places of random arrangements: as they are foreseen, what they take, and the danger.

    Of an action without a motion there is None; danger is that of a pick from the table region, by the forecast.
    """
    rehearsal = Rehearsal(tabletop, model)
    for number in range(rounds):
        generator = np.random.default_rng([seed, number])
        problem = _random_problem(tabletop, generator)
        actions = list(_random_actions(problem, tabletop, generator))
        forecaster = Forecaster(problem, model)
        walk = forecaster.begin()
        for done in rehearsal.of(problem, actions, seed=number):
            origin, first = walk.hand, walk.first
            lying = isinstance(done.action, Pick) and done.action.source == TABLE
            danger = forecaster.danger(walk, done.action.block) if lying and isinstance(done.action, Pick) else 0.0
            forecaster.step(walk, done.action)
            if isinstance(done.action, Pick | Place):
                kind = "pick" if isinstance(done.action, Pick) else "place"
                taken = done.seconds
                yield None if taken is None else TimedMove(kind, origin, walk.hand, lying, first, taken), danger


def _random_problem(tabletop: Tabletop, generator: np.random.Generator) -> Problem:
    """Four to nine blocks in random piles on the scene's stacks."""
    count = int(generator.integers(FEWEST, min(9, tabletop.highest) + 1))
    stacks = [f"s{number}" for number in range(1, len(tabletop.stacks) + 1)]
    buffers = [f"u{number}" for number in range(1, len(tabletop.buffers) + 1)]
    start: dict[str, list[str]] = {}
    for number in range(1, count + 1):
        start.setdefault(str(generator.choice(stacks)), []).append(f"b{number}")
    blocks = [f"b{number}" for number in range(1, count + 1)]
    return Problem(
        make_instance(name="random", blocks=blocks, stacks=stacks, buffers=buffers, start=start, goal=PositionsGoal({}))
    )


def _random_actions(problem: Problem, tabletop: Tabletop, generator: np.random.Generator) -> Iterator[Action]:
    """A topple, perhaps; then blocks from anywhere to anywhere, those that lie on the table first."""
    state, law, instance = State.start_of(problem.instance), problem.law, problem.instance

    def do(action: Action) -> Action:
        law.carry_out(state, action)
        return action

    slots = tabletop.bind(instance)
    piled = [location for location in instance.stacks if state.piles[location] and slots[location].directions]
    toppled = None
    if piled and generator.random() < TOPPLED_FIRST:
        toppled = location = str(generator.choice(piled))
        yield do(Topple(location, int(generator.integers(1, len(state.piles[location]) + 1))))
    for _ in range(MOVES):
        tops = [Pick(pile[-1], location) for location, pile in state.piles.items() if pile]
        picks = [Pick(block, TABLE) for block in sorted(state.table)] or tops
        pick = picks[int(generator.integers(len(picks)))]
        places = instance.stacks if generator.random() < TO_STACK or not instance.buffers else instance.buffers
        targets = [location for location in places if location != pick.source] or list(places)
        rebuilt = toppled is not None and pick.source == TABLE and generator.random() < REBUILT
        yield do(pick)
        yield do(Place(pick.block, toppled if rebuilt and toppled else str(generator.choice(targets))))


def _ready(tabletop: Tabletop) -> tuple[Spot, float]:
    """Where the hand is at the arm's ready pose, and how high."""
    robot = load_robot(tabletop.robot)
    x, y, z = (float(value) for value in robot.forward(robot.ready).position)
    return Spot(round(float(np.hypot(x, y)), DIGITS), round(float(np.arctan2(y, x)), DIGITS)), round(z, DIGITS)


def _spot(slot: Slot) -> Spot:
    headings = tuple(round(slot.heading(direction), DIGITS) for direction in slot.directions)
    return Spot(slot.radius, round(slot.angle, DIGITS), headings, slot.highest, slot.falling)


def _toppled(trial: Trial) -> Toppled:
    landed = tuple(
        Landed(round(entry.along, DIGITS), round(entry.aside, DIGITS), entry.graspable) for entry in trial.landings
    )
    return Toppled(trial.height, trial.falling, trial.seed, trial.stands, round(trial.seconds or 0.0, 2), landed)
