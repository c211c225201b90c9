"""An aggregating action: a carrier is tipped over, and all that lies on it falls into the table region."""

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

from smash.problem.actions.kind import AggregatingKind, Hop
from smash.problem.model import TABLE, Aggregating, Instance, PlanOptions, State


@dataclass(frozen=True, slots=True)
class Pour(Aggregating):
    """Tip `carrier` over."""

    carrier: str

    def __str__(self) -> str:
        return f"pour {self.carrier!r}"


class PourKind(AggregatingKind[Pour]):
    """Gathers what lies on a carrier, leaves it in the table region at unknown poses, as a topple does."""

    name = "pour"
    action = Pour
    form = '["pour", carrier]'
    grounded = False

    def available(self, instance: Instance) -> bool:
        """An instance with carriers has it."""
        return bool(instance.carriers)

    def refusal(self, instance: Instance, options: PlanOptions, state: State, action: Pour) -> str | None:
        """Return why the pour is illegal, or None."""
        if action.carrier not in state.carried:
            return f"no carrier is called {action.carrier!r}"
        return None if state.carried[action.carrier] else f"{action.carrier!r} is empty"

    def apply(self, state: State, action: Pour) -> None:
        """Move what is on the carrier to the table region."""
        state.table |= state.carried[action.carrier]
        state.carried[action.carrier].clear()

    def legal(self, instance: Instance, options: PlanOptions, state: State) -> Iterator[Pour]:
        """Yield a pour of each carrier that holds something."""
        yield from (Pour(carrier) for carrier, blocks in state.carried.items() if blocks)

    def gathered(self, state: State, action: Pour) -> tuple[str, ...]:
        """Return the blocks on the carrier."""
        return tuple(sorted(state.carried[action.carrier]))

    def hops(self, instance: Instance, options: PlanOptions) -> Iterator[Hop]:
        """Yield the way from each station to the table region."""
        for carrier in instance.carriers:
            for station in carrier.stations:
                yield Hop(station, TABLE, instance.costs.of(self.name), carrier.capacity)

    def read(self, entry: list[Any]) -> Pour | None:
        """Return the pour of `["pour", carrier]`."""
        match entry:
            case [_, str(carrier)]:
                return Pour(carrier)
        return None

    def write(self, action: Pour) -> list[str | int]:
        """Return `["pour", carrier]`."""
        return [self.name, action.carrier]
