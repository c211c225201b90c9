"""Instances as pictures: the piles of start and goal, as a reader sees the table from the front."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

from smash.problem.pictures import block_colours, ink_on
from smash.records.runs import RunRecord

SIDE, GAP, FLOOR = 26, 12, 22
"""Edge of a block, room between piles, and room for the names under them [px]."""
MOST_BLOCKS = 40
"""Larger instances are counted, not drawn: their blocks could not be told apart."""


@dataclass(frozen=True, slots=True)
class Box:
    """One block: where it stands [px], what is written on it, whether the goal names it, and its colours."""

    x: int
    y: int
    text: str
    name: str
    aimed: bool
    colour: str
    ink: str


@dataclass(frozen=True, slots=True)
class Pile:
    """One location: its middle [px] and its name; an empty one is only a line."""

    x: int
    text: str
    name: str


@dataclass(frozen=True, slots=True)
class Scene:
    """One arrangement: title, size [px], blocks, locations, and the same in words."""

    title: str
    width: int
    height: int
    boxes: list[Box]
    piles: list[Pile]
    words: str


@dataclass(frozen=True, slots=True)
class Card:
    """One instance: its name, scenes, a line on the goal, known costs, runs behind it, and replays (text, link)."""

    name: str
    scenes: list[Scene]
    note: str
    costs: list[tuple[str, ...]]
    entries: list[int] = field(default_factory=list)
    replays: list[tuple[str, str]] = field(default_factory=list)


def scenes(document: dict[str, Any]) -> tuple[list[Scene], str]:
    """Return start and goal of a `smash-instance/1` object, and what the goal asks in words."""
    stacks, goal = [str(name) for name in document["stacks"]], document["goal"]
    start = {name: [str(block) for block in pile] for name, pile in document["start"].items()}
    used = [*stacks, *(name for name in document["buffers"] if start.get(name))]
    piles = [(name, start.get(name, [])) for name in used]
    table = [str(block) for block in document.get("table", [])]
    piles += [("table", [block]) for block in table]
    piles += [("hand", [str(document["hand"])])] if document.get("hand") is not None else []
    wanted, aimed, note = _goal(goal, stacks)
    tallest = max([1, *(len(pile) for _, pile in [*piles, *wanted])])
    colours = block_colours([str(block) for block in document["blocks"]])
    return [
        _scene(title, shown, aimed, tallest, colours) for title, shown in (("Start", piles), ("Goal", wanted))
    ], note


def _goal(goal: dict[str, Any], stacks: Sequence[str]) -> tuple[list[tuple[str, list[str]]], set[str], str]:
    """Return the goal's piles, the blocks that stand out, and the goal in words."""
    match goal["kind"]:
        case "stacks":
            return [(name, list(goal["stacks"].get(name, []))) for name in stacks], set(), "every block has its place"
        case "positions":
            piles: dict[str, list[tuple[int, str]]] = {}
            for block, (location, height) in goal["positions"].items():
                piles.setdefault(location, []).append((height, block))
            drawn = [(name, [block for _, block in sorted(piles.get(name, []))]) for name in stacks]
            return drawn, set(goal["positions"]), "the marked blocks; the rest may be anywhere"
    above = {under: upper for upper, under in goal["on"].items()}
    bottom, ontable, clear = (list(goal.get(key, [])) for key in ("bottom", "ontable", "clear"))
    single = [block for block in dict.fromkeys([*bottom, *ontable]) if block not in above and block not in goal["on"]]
    towers = []
    for base in [*(b for b in above if b not in goal["on"]), *single]:
        tower = [base]
        while tower[-1] in above:
            tower.append(above[tower[-1]])
        under = "at the bottom" if base in bottom else "on the table" if base in ontable else "on anything"
        towers.append((under, tower))
    note = "these towers, at any location" + (f"; clear: {', '.join(clear)}" if clear else "")
    return towers, {block for _, tower in towers for block in tower}, note


def _scene(
    title: str,
    piles: Sequence[tuple[str, list[str]]],
    aimed: Iterable[str],
    tallest: int,
    colours: Mapping[str, str],
) -> Scene:
    marked = set(aimed)
    boxes, names = [], []
    for column, (location, pile) in enumerate(piles):
        left = GAP // 2 + column * (SIDE + GAP)
        names.append(Pile(left + SIDE // 2, _short(location, 5), location))
        for level, block in enumerate(pile):
            up, colour = (tallest - 1 - level) * SIDE + 2, colours[block]
            boxes.append(Box(left, up, _short(block, 4), block, block in marked, colour, ink_on(colour)))
    said = "; ".join(f"{location}: {', '.join(pile) or 'empty'}" for location, pile in piles)
    width = max(1, len(piles)) * (SIDE + GAP)
    return Scene(title, width, tallest * SIDE + FLOOR, boxes, names, f"{title}, each pile from the bottom: {said}")


def _short(name: str, most: int) -> str:
    return name if len(name) <= most else name[: most - 1] + "…"


def drawable(record: RunRecord) -> bool:
    """Return whether the instance of a record is small enough to be drawn."""
    return record.blocks <= MOST_BLOCKS
