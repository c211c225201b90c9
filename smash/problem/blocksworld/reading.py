"""How a PDDL file tells a blocks world: what its predicates say and its actions do; by their usual spellings."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

from smash.problem.blocksworld.world import MOVE, PUT, RELATIONS, TAKE, Kind, Meaning

TABLE_NAMES = frozenset({"table", "the-table", "thetable", "table1", "table-1", "floor", "ground"})
"""Without a domain: the object that is the table, where `(on a table)` is said."""
HAND_TYPES = frozenset({"robot", "arm", "hand", "gripper"})
"""Without a domain: types of objects that are the hand and not a block."""
USUAL = {
    "on": ("on", "on-block", "onblock", "on-top", "on-top-of", "ontopof"),
    "ontable": ("ontable", "on-table", "on-the-table", "onthetable", "at-table"),
    "clear": ("clear", "is-clear", "isclear"),
    "holding": ("holding", "holds", "hold", "in-hand", "inhand", "held"),
    "handempty": (
        *("handempty", "hand-empty", "emptyhand", "empty-hand", "armempty", "arm-empty", "emptyarm", "empty-arm"),
        *("gripperempty", "gripper-empty", "handfree", "hand-free", "armfree", "arm-free", "free-hand", "free-arm"),
    ),
}
"""Relation -> the names under which files tell it; an underscore counts as a hyphen."""
USUAL_OPPOSITES = {"handempty": ("handfull", "hand-full", "armfull", "arm-full")}
_RELATION_OF = {name: (relation, True) for relation, names in USUAL.items() for name in names}
_RELATION_OF |= {name: (relation, False) for relation, names in USUAL_OPPOSITES.items() for name in names}
USUAL_ACTIONS: dict[str, tuple[str, ...]] = {
    "pick-up": ("pick-up", "pickup"),
    "put-down": ("put-down", "putdown"),
    "stack": ("stack",),
    "unstack": ("unstack",),
    "move-b-to-b": ("move-b-to-b", "move-block-to-block", "move-from-block-to-block"),
    "move-b-to-t": ("move-b-to-t", "move-block-to-table", "move-to-table", "move-from-block-to-table"),
    "move-t-to-b": ("move-t-to-b", "move-table-to-block", "move-from-table", "move-from-table-to-block"),
}


def usual(name: str) -> str:
    """Return a name with hyphens for underscores."""
    return name.replace("_", "-")


def usual_relation(predicate: str) -> tuple[str, bool] | None:
    """Return the relation that a predicate's name usually says, and whether it says it or its opposite; or None."""
    return _RELATION_OF.get(usual(predicate))


@dataclass(frozen=True, slots=True)
class Template:
    """How an action's arguments tell a step.

    Attributes:
        action: the action's name.
        kind: what it does.
        roles: of each argument `block`, `source`, `target`, or None (it says nothing).
        fixed: the objects that always stand at an argument: place and object.
        from_table: whether the block comes from the table, or from a block; None: either.
        to_table: whether it goes to the table, or to a block; None: either.
    """

    action: str
    kind: Kind
    roles: tuple[str | None, ...]
    fixed: tuple[tuple[int, str], ...] = ()
    from_table: bool | None = None
    to_table: bool | None = None


def _usual_templates() -> tuple[Template, ...]:
    forms: dict[str, tuple[Kind, tuple[str, ...], bool | None, bool | None]] = {
        "pick-up": (TAKE, ("block",), True, None),
        "put-down": (PUT, ("block",), None, True),
        "stack": (PUT, ("block", "target"), None, False),
        "unstack": (TAKE, ("block", "source"), False, None),
        "move-b-to-b": (MOVE, ("block", "source", "target"), False, False),
        "move-b-to-t": (MOVE, ("block", "source"), False, True),
        "move-t-to-b": (MOVE, ("block", "target"), True, False),
    }
    return tuple(
        Template(action, kind, roles, from_table=from_table, to_table=to_table)
        for action, (kind, roles, from_table, to_table) in forms.items()
    )


USUAL_TEMPLATES = _usual_templates()


@dataclass(frozen=True)
class Reading:
    """How a file tells a blocks world.

    Attributes:
        hand: whether there is a hand: blocks are taken and put, not moved.
        meanings: predicate -> what it says.
        table: the object that is the table; None where there is none.
        others: the objects that are neither a block nor the table.
        templates: what each action does.
        by_name: whether the usual spellings were taken, and no domain.
        derived: what the predicates say that rules derive; goals may name them.
    """

    hand: bool
    meanings: Mapping[str, Meaning]
    table: str | None = None
    others: frozenset[str] = frozenset()
    templates: tuple[Template, ...] = USUAL_TEMPLATES
    by_name: bool = True
    derived: Mapping[str, Meaning] = field(default_factory=dict)

    def predicate_of(self, relation: str) -> str | None:
        """Return the predicate that says a relation; None where none does."""
        found = (name for name, meaning in self.meanings.items() if meaning.relation == relation and meaning.positive)
        return next(found, None)

    def fact(self, relation: str, *blocks: str) -> str:
        """Return what is said of blocks, in the words of the file where it has some."""
        predicate = self.predicate_of(relation)
        if predicate is None and relation == "ontable" and self.table is not None:
            predicate, blocks, relation = self.predicate_of("on"), (*blocks, self.table), "on"
        if predicate is None:
            return f"({' '.join((relation, *blocks))})"
        return f"({' '.join(self.meanings[predicate].atom(predicate, blocks))})"

    def said(self) -> str:
        """Return in words which predicate says which relation."""
        said = []
        for relation in RELATIONS:
            for name, meaning in self.meanings.items():
                if meaning.relation == relation:
                    turned = " (reversed)" if list(meaning.places) != sorted(meaning.places) else ""
                    said.append(f"{relation if meaning.positive else f'not {relation}'} = {name}{turned}")
        if self.table is not None:
            said.append(f"the table = {self.table}")
        return ", ".join(said)
