"""The gadget: the typed graph on which objects move as pebbles (paper, section "Method")."""

from smash.gadget.graph import Aggregate, Edge, EdgeKind, Gadget, GadgetBuilder, Node, NodeKey, NodeKind, Token
from smash.gadget.library import gadget_of, pick_and_place_gadget, smash_gadget
from smash.gadget.parts import AggregatingPart

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
