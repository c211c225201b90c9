"""The search's functions one by one: a state of the law filed and taken in hand, and read back from there."""

from dataclasses import replace

from smash.planners.astar import state as states
from smash.planners.astar.task import make_setting
from smash.problem import Law, State
from smash.problem.views.numbered import Numbered


class Hand:
    """A problem's numbers, interpreted, with one state in hand."""

    def __init__(self, instance, options):
        self.instance = instance
        self.options = options
        self.law = Law(instance, options)
        self.problem = Numbered.of(instance)
        self.setting = make_setting(self.problem, options)
        self.task = self.setting.task
        self.cells = list(self.setting.cells)

    def row(self, state):
        """File a state of the law as `astar.task` describes it: per block what is below it."""
        task, number = self.task, self.problem.block_number
        row = [task.blocks + task.classes] * task.blocks
        for location, kind in zip(self.instance.locations, self.setting.class_of, strict=True):
            below = task.blocks + kind
            for block in state.piles[location]:
                row[number[block]] = below
                below = number[block]
        return row

    def take_up(self, state):
        """Take a state of the law in hand."""
        states.unpack(self.task, self.cells, self.row(state), 0)

    def filed(self):
        """Return the state in hand, filed."""
        row = [0] * self.task.blocks
        states.pack(self.task, self.cells, row, 0)
        return row

    def pairs(self, begin, count):
        """Return `count` pairs of the cells from `begin` on."""
        return [(self.cells[at], self.cells[at + 1]) for at in range(begin, begin + 2 * count, 2)]


def walked(instance, options, draw, steps=8):
    """Return a state that some legal actions lead to, with an empty hand."""
    law, state = Law(instance, options), State.start_of(instance)
    for _ in range(draw.randint(0, steps)):
        actions = list(law.legal_actions(state))
        if not actions:
            break
        law.apply(state, draw.choice(actions))
    if state.hand is not None:
        law.apply(state, draw.choice(list(law.legal_actions(state))))
    return state


def begun_at(instance, state):
    """Return the instance with another start."""
    start = {location: tuple(pile) for location, pile in state.piles.items()}
    return replace(instance, start=start, table=tuple(sorted(state.table)))
