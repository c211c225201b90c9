"""The gadget: the typed graph on which objects move as pebbles (paper, section "Method")."""

from smash.gadget.builder import AggregatingPart, GadgetBuilder
from smash.gadget.elements import Aggregate, Edge, EdgeKind, Node, NodeKey, NodeKind, Token
from smash.gadget.graph import Gadget
from smash.gadget.library import gadget_of, pick_and_place_gadget, smash_gadget

__all__ = [
    "Aggregate",
    "AggregatingPart",
    "Edge",
    "EdgeKind",
    "Gadget",
    "GadgetBuilder",
    "Node",
    "NodeKey",
    "NodeKind",
    "Token",
    "gadget_of",
    "pick_and_place_gadget",
    "smash_gadget",
]
