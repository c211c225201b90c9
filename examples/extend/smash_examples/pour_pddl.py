"""The pour in PDDL: the first block to fall pays, the others follow, and the pour ends when the carrier is empty."""

from collections.abc import Iterator

from smash_baselines.names import Fact, Step
from smash_baselines.parts.carry import CarryPart, room
from smash_baselines.parts.part import Part, Telling

from smash.problem.model import Action, Instance, PlanOptions, State
from smash_examples.pour import Pour

TEXT = """
(:predicates
  (pouring ?c - carrier)            ; a pour of ?c is under way
  (all-room ?c - carrier ?k - count) ; ?c is empty when ?k blocks fit on it
)

(:functions (pour-cost) - number)

; --- pour.

(:action pour-begin
  :parameters (?c - carrier ?b - block ?room ?more - count)
  :precondition (and (hand-empty) (idle) (on-carrier ?b ?c) (room ?c ?room) (next ?room ?more))
  :effect (and (pouring ?c) (not (idle)) (not (on-carrier ?b ?c)) (on-table ?b) (not (room ?c ?room)) (room ?c ?more)
               (increase (total-cost) (pour-cost))))

(:action pour-drop
  :parameters (?c - carrier ?b - block ?room ?more - count)
  :precondition (and (pouring ?c) (on-carrier ?b ?c) (room ?c ?room) (next ?room ?more))
  :effect (and (not (on-carrier ?b ?c)) (on-table ?b) (not (room ?c ?room)) (room ?c ?more)
               (increase (total-cost) 0)))

(:action pour-end
  :parameters (?c - carrier ?k - count)
  :precondition (and (pouring ?c) (room ?c ?k) (all-room ?c ?k))
  :effect (and (idle) (not (pouring ?c))
               (increase (total-cost) 0)))
"""


class PourPart(Part):
    """`pour-begin`, `pour-drop`, `pour-end`."""

    kind = "pour"

    def needed(self, instance: Instance, options: PlanOptions) -> bool:
        """Return whether there is something to pour: the part of carriers is there."""
        return super().needed(instance, options) and CarryPart().needed(instance, options)

    def text(self, instance: Instance, options: PlanOptions) -> str:
        """Return the PDDL text above."""
        return TEXT

    def start(self, telling: Telling) -> Iterator[Fact]:
        """Yield how much room each empty carrier has."""
        for carrier in telling.instance.carriers:
            yield ("all-room", telling.layout.carriers[carrier.name], room(telling, carrier.name, 0))

    def costs(self, telling: Telling) -> Iterator[tuple[Fact, int]]:
        """Yield what a pour costs."""
        yield ("pour-cost",), telling.instance.costs.of(self.kind)

    def tells(self, telling: Telling, action: Action) -> bool:
        """Return whether it is a pour."""
        return isinstance(action, Pour)

    def steps(self, telling: Telling, state: State, action: Action) -> Iterator[Step]:
        """Yield a step for each block, and the end."""
        assert isinstance(action, Pour)
        carrier, blocks = telling.layout.carriers[action.carrier], sorted(state.carried[action.carrier])
        levels = [room(telling, action.carrier, left) for left in range(len(blocks), -1, -1)]
        for number, block in enumerate(blocks):
            name = "pour-drop" if number else "pour-begin"
            yield (name, carrier, telling.block(block), levels[number], levels[number + 1])
        yield ("pour-end", carrier, levels[-1])

    def action(self, telling: Telling, state: State, step: Step) -> Action | None:
        """Return the pour that has come to its end."""
        carriers = {short: name for name, short in telling.layout.carriers.items()}
        return Pour(carriers[step[1]]) if step[0] == "pour-end" else None
