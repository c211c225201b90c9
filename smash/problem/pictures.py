"""Small pictures in SVG, written by hand: what instances and plans show of themselves in a notebook.

They need no library. `smash.gadget.drawing` draws with matplotlib, to files of every kind, in the same colours.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import NamedTuple

INK, GREY, PAPER = "#2b2d33", "#8a8f99", "#ffffff"
PINK, PALE_PINK = "#d6337c", "#fbe3ee"
PALE = "#eceef2"
PALETTE = (
    "#f0a202", "#3a86c8", "#2a9d6f", "#e4572e", "#8e6bbf", "#6cc3d5", "#b5bd3f", "#c97b9a", "#7f6a5b", "#1b5e7b",
    "#f7c873", "#97c9f0", "#94d7b8", "#f3a48c", "#cdb8e8", "#4b8a3c", "#a23b5a", "#5a5f8f", "#d9b38c", "#607d8b",
)  # fmt: skip
SIDE, PITCH, FLOOR, HEAD, MARGIN = 28, 40, 22, 26, 10
"""Edge of a block, from one pile to the next, room for a pile's name, for the title, and around it all [px]."""
WIDEST, TALLEST = 760, 600
"""A larger picture is shown smaller, and chips go on in the next row [px]."""


class Arrangement(NamedTuple):
    """Piles (name, blocks bottom first) side by side under a title, and blocks in the table region."""

    title: str
    piles: Sequence[tuple[str, Sequence[str]]]
    table: Sequence[str] = ()


class Chip(NamedTuple):
    """A step of a plan in words; `bold` where it moves several blocks at once."""

    words: str
    bold: bool = False


def block_colours(blocks: Sequence[str]) -> dict[str, str]:
    """Return a fill colour per block, in order; colours repeat after twenty."""
    return {block: PALETTE[number % len(PALETTE)] for number, block in enumerate(blocks)}


def ink_on(colour: str) -> str:
    """Return black or white, whichever is read better on `colour` (`#rrggbb`)."""
    red, green, blue = (int(colour[at : at + 2], 16) for at in (1, 3, 5))
    return INK if 0.299 * red + 0.587 * green + 0.114 * blue > 135 else "white"


def short(name: str, most: int = 4) -> str:
    """Return a name that fits into a small place."""
    shown = name if name.isprintable() else name.encode("unicode_escape").decode("ascii")
    return shown if len(shown) <= most else shown[: most - 1] + "…"


def arrangements_svg(arrangements: Sequence[Arrangement], blocks: Sequence[str]) -> str:
    """Return arrangements side by side as one SVG picture, each block in its colour."""
    colours = block_colours(blocks)
    tallest = max((len(pile) for arrangement in arrangements for _, pile in arrangement.piles), default=0)
    ground = HEAD + max(1, tallest) * SIDE
    parts, left, bottom = [], MARGIN, ground + FLOOR
    for arrangement in arrangements:
        parts.append(_text(left, 14, arrangement.title, INK, anchor="start"))
        for number, (location, pile) in enumerate(arrangement.piles):
            parts += _pile(left + number * PITCH, ground, location, pile, colours)
        width = max(PITCH * len(arrangement.piles), 7 * len(arrangement.title), 4 * PITCH)
        if arrangement.table:
            parts += _table(left, ground + FLOOR + 8, width, arrangement.table, colours)
            bottom = max(bottom, ground + FLOOR + 8 + _table_height(width, arrangement.table))
        left += width + 2 * MARGIN
    return _svg(left, bottom + MARGIN, parts)


def chips_svg(title: str, chips: Sequence[Chip]) -> str:
    """Return a title and the steps of a plan under it, row by row, as one SVG picture."""
    parts, x, y, widest = [_text(MARGIN, 16, title, INK, anchor="start")], MARGIN, HEAD, 7 * len(title)
    for chip in chips:
        words = short(chip.words, 60)
        width = 7 * len(words) + 14
        if x > MARGIN and x + width > WIDEST:
            x, y = MARGIN, y + 30
        line, fill = (PINK, PALE_PINK) if chip.bold else (GREY, PALE)
        parts.append(_box(x, y, width, 24, fill, line, 6))
        parts.append(_text(x + width / 2, y + 16, words, INK))
        x += width + 6
        widest = max(widest, x)
    return _svg(widest + MARGIN, y + (24 if chips else 0) + MARGIN, parts)


def _pile(x: float, ground: float, location: str, pile: Sequence[str], colours: dict[str, str]) -> Iterator[str]:
    yield f'<path d="M{x} {ground + 1}h{SIDE + 4}" stroke="{GREY}" stroke-width="2"/>'
    yield _text(x + SIDE / 2 + 2, ground + 15, short(location, 6), INK, hover=location)
    for height, block in enumerate(pile, start=1):
        yield from _block(x + 2, ground - height * SIDE, block, colours)


def _table_height(width: float, table: Sequence[str]) -> int:
    rows = -(-len(table) // max(1, int((width - 12) // (SIDE + 4))))
    return 22 + rows * (SIDE + 4)


def _table(x: float, y: float, width: float, table: Sequence[str], colours: dict[str, str]) -> Iterator[str]:
    yield _box(x, y, width, _table_height(width, table), PALE_PINK, PINK, 6)
    yield _text(x + 6, y + 14, "table region", PINK, anchor="start")
    a_row = max(1, int((width - 12) // (SIDE + 4)))
    for number, block in enumerate(table):
        row, column = divmod(number, a_row)
        yield from _block(x + 6 + column * (SIDE + 4), y + 19 + row * (SIDE + 4), block, colours)


def _block(x: float, y: float, block: str, colours: dict[str, str]) -> Iterator[str]:
    yield _box(x, y, SIDE, SIDE, colours[block], PAPER, 4)
    name, size = short(block), 12 if len(block) <= 3 else 10
    yield _text(x + SIDE / 2, y + SIDE / 2 + 4, name, ink_on(colours[block]), hover=block, size=size)


def _box(x: float, y: float, width: float, height: float, fill: str, line: str, radius: float) -> str:
    place = f'x="{x:g}" y="{y:g}" width="{width:g}" height="{height:g}" rx="{radius:g}"'
    return f'<rect {place} fill="{fill}" stroke="{line}"/>'


def _text(
    x: float, y: float, words: str, colour: str, *, anchor: str = "middle", hover: str = "", size: int = 12
) -> str:
    title = f"<title>{_escaped(hover)}</title>" if hover else ""
    look = f'fill="{colour}" text-anchor="{anchor}" font-size="{size}"'
    return f'<text x="{x:g}" y="{y:g}" {look}>{_escaped(words)}{title}</text>'


def _escaped(words: str) -> str:
    """Return words as XML takes them: without characters that it does not know."""
    known = words if words.isprintable() else words.encode("unicode_escape").decode("ascii")
    return known.replace("&", "&amp;").replace("<", "&lt;").replace(">", "&gt;")


def _svg(width: float, height: float, parts: Sequence[str]) -> str:
    share = min(1.0, WIDEST / width, TALLEST / height)
    size = f'width="{share * width:.0f}" height="{share * height:.0f}" viewBox="0 0 {width:g} {height:g}"'
    font = 'font-family="Helvetica, Arial, sans-serif"'
    ground = f'<rect width="{width:g}" height="{height:g}" fill="{PAPER}"/>'
    return f'<svg xmlns="http://www.w3.org/2000/svg" {size} {font}>{ground}{"".join(parts)}</svg>'
