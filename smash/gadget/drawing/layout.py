"""Where the nodes of a gadget are drawn.

Every location is a column, heights upward, its tops in one line. The TOPPLE node of a stack stands left of its
top; the TABLE node is a long bar under all columns; the interface nodes are a column of their own on the right. Every
carrier is a row of its own above all that, a box for each station.
"""

from __future__ import annotations

from dataclasses import dataclass

from smash.gadget.elements import NodeKind
from smash.gadget.graph import Gadget

Point = tuple[float, float]

SIDE = 0.95
"""Distance of a TOPPLE node from its column."""
DECK = 1.15
"""Half the width of a carrier's box, and the height of its row."""


@dataclass(frozen=True, slots=True)
class Layout:
    """Positions in units of one height; y grows upward, the top nodes are at y = 0.

    Attributes:
        nodes: (x, y) per node number; the TABLE node's is the middle of its bar.
        columns: x of each location.
        bar: (left, right, y) of the TABLE node, or None.
        interface: x of the interface column, or None.
        crest: y of the highest transfer arc.
        bus: y of the line that leads from the interface nodes to the tops.
        deck: y of the line that joins the carriers with the tops, or None.
    """

    nodes: tuple[Point, ...]
    columns: dict[str, float]
    bar: tuple[float, float, float] | None
    interface: float | None
    crest: float
    bus: float
    deck: float | None = None

    @property
    def top(self) -> float:
        """Upper end of everything."""
        if self.deck is not None:
            return max(y for _, y in self.nodes) + 0.75
        return self.bus + 0.3 if self.interface is not None else self.crest + 0.2

    @property
    def left(self) -> float:
        """Left end of everything."""
        return min((x for x, _ in self.nodes), default=0.0)

    @property
    def right(self) -> float:
        """Right end of everything."""
        return max((x for x, _ in self.nodes), default=0.0)


def arc_height(span: float, width: float) -> float:
    """Return how high the arc between two tops `span` apart rises, in a drawing of the given width."""
    return 0.45 + 0.34 * span * min(1.0, 8.0 / max(width, 1e-9))


def lay_out(gadget: Gadget) -> Layout:
    """Place the nodes of a gadget."""
    toppled = {aggregate.locks for aggregate in gadget.aggregates}
    columns: dict[str, float] = {}
    right = -1.3
    for location in gadget.locations:
        right += 1.3 + (0.75 if location in toppled else 0.0)
        columns[location] = right
    bottom = 1.0 - gadget.height
    has_table = any(node.kind is NodeKind.TABLE for node in gadget.nodes)
    interface = right + 1.9 if has_table else None
    first = min(columns.values(), default=0.0)
    crest = arc_height(right - first, right - first) if len(columns) > 1 else 0.45
    bar = (first - SIDE - 0.6, right + 2.6, bottom - 1.75) if has_table else None
    bus = crest + 0.45
    deck = bus + 0.45 if gadget.tokens else None
    decks = _decks(gadget, (first + right) / 2, bus + 1.35)
    nodes: list[Point] = []
    for number, node in enumerate(gadget.nodes):
        key = node.key
        match key.kind:
            case NodeKind.STACK:
                assert key.location is not None
                nodes.append((columns[key.location], float(key.index - gadget.height)))
            case NodeKind.TOPPLE:
                assert key.location is not None
                nodes.append((columns[key.location] - SIDE, 0.0))
            case NodeKind.TABLE:
                assert bar is not None
                nodes.append(((bar[0] + bar[1]) / 2, bar[2]))
            case NodeKind.INTERFACE:
                nodes.append((right + 1.9, float(key.index - gadget.height)))
            case NodeKind.CARRIER:
                nodes.append(decks[number])
    return Layout(tuple(nodes), columns, bar, interface, crest, bus, deck)


def _decks(gadget: Gadget, middle: float, lowest: float) -> dict[int, Point]:
    """Return the place of every carrier's node: a row per carrier, around `middle`, the first one at `lowest`."""
    places: dict[int, Point] = {}
    for row, token in enumerate(gadget.tokens):
        for number, node in enumerate(token.nodes.values()):
            x = middle + (number - (len(token.nodes) - 1) / 2) * 3.4
            places[node] = (x, lowest + row * DECK)
    return places
