"""PDDL's typed lists (`a b - block c - (either block cube)`) and the hierarchy of types."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field

from smash.problem.blocksworld.sexpr import Expression, show
from smash.problem.errors import MalformedFile

OBJECT = "object"
"""The type of everything, and of what is listed without a type."""
Types = tuple[str, ...]
"""The types of one thing: more than one where the list says `either`."""


def typed_list(listed: Sequence[Expression], where: str, part: str) -> list[tuple[str, Types]]:
    """Return the names of a typed list, each with its types.

    Args:
        listed: the list.
        where: the file, for errors.
        part: the part of it, for errors.

    Raises:
        MalformedFile: where an entry is neither a name nor a type.
    """
    typed: list[tuple[str, Types]] = []
    waiting: list[str] = []
    entries = iter(listed)
    for entry in entries:
        if entry == "-":
            types = _types(next(entries, None), where, part)
            typed += [(name, types) for name in waiting]
            waiting = []
        elif isinstance(entry, str):
            waiting.append(entry)
        else:
            raise MalformedFile(where, f"`{part}`: {show(entry)} is no name")
    return typed + [(name, (OBJECT,)) for name in waiting]


def _types(entry: Expression | None, where: str, part: str) -> Types:
    match entry:
        case str() if entry != "-":
            return (entry,)
        case ["either", *types] if types and all(isinstance(name, str) for name in types):
            return tuple(name for name in types if isinstance(name, str))
    shown = "nothing" if entry is None else show(entry)
    raise MalformedFile(where, f"`{part}`: {shown} stands after `-`; a type, or (either TYPE …), is allowed")


@dataclass(frozen=True)
class TypeTree:
    """Which type is one of which; a type that nobody declared is one of `object` alone."""

    parents: Mapping[str, Types] = field(default_factory=dict)

    @classmethod
    def of(cls, listed: Sequence[Expression], where: str) -> TypeTree:
        """Read the section `:types`.

        Raises:
            MalformedFile: where it is no typed list.
        """
        parents: dict[str, Types] = {}
        for name, types in typed_list(listed, where, ":types"):
            parents[name] = parents.get(name, ()) + types
        return cls(parents)

    def all_of(self, types: Iterable[str]) -> frozenset[str]:
        """Return types and all that they are one of."""
        found = {OBJECT}
        waiting = list(types)
        while waiting:
            name = waiting.pop()
            if name not in found:
                found.add(name)
                waiting += self.parents.get(name, ())
        return frozenset(found)

    def fits(self, types: Iterable[str], wanted: Iterable[str]) -> bool:
        """Return whether a thing of `types` may stand where `wanted` is asked for."""
        return not self.all_of(types).isdisjoint(wanted)
