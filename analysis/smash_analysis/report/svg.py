"""Figures of matplotlib as inline SVG that follows the page: its colours in light and dark, its font, no stray ids."""

from __future__ import annotations

import re
from io import BytesIO
from typing import TYPE_CHECKING
from xml.etree import ElementTree

from smash_analysis.charts.panels import COLOURS, GRID_COLOUR

if TYPE_CHECKING:
    from matplotlib.figure import Figure

REFERENCE = re.compile(r"url\(#([^)]+)\)")
LONG_NUMBER = re.compile(r"(\d+\.\d\d)\d+")
FONT = re.compile(r"font:\s*([\d.]+px)[^;]*|font-family:[^;]*;?")


def inline_svg(figure: Figure, title: str, words: str, key: str) -> str:
    """Return the figure as an `<svg>` element for HTML.

    Colours of the charts become CSS variables (`--curve-0`, `--grid`), black the colour of the text around it; a
    curve's group has `data-curve`, its name.

    Args:
        figure: what to draw.
        title: its accessible name.
        words: its accessible description.
        key: unique on the page; prefixes every id.
    """
    import matplotlib as mpl

    file = BytesIO()
    with mpl.rc_context({"svg.fonttype": "none", "svg.hashsalt": key}):
        figure.savefig(file, format="svg", transparent=True, metadata={"Date": None})
    root = ElementTree.fromstring(file.getvalue())
    _plain_names(root)
    for child in [child for child in root if child.tag == "metadata"]:
        root.remove(child)
    _tidy(root, key)
    for number, (name, text) in enumerate((("title", title), ("desc", words))):
        element = ElementTree.Element(name, {"id": f"{key}-{name}"})
        element.text = text
        root.insert(number, element)
    for name in ("width", "height", "version"):
        root.attrib.pop(name, None)
    root.attrib |= {
        "role": "img",
        "aria-labelledby": f"{key}-title",
        "aria-describedby": f"{key}-desc",
        "class": "plot",
    }
    return ElementTree.tostring(root, encoding="unicode")


def _plain_names(root: ElementTree.Element) -> None:
    """Drop the XML namespaces, which HTML knows by itself."""
    for element in root.iter():
        element.tag = element.tag.rpartition("}")[2]
        for name in [name for name in element.attrib if "}" in name]:
            element.attrib[name.rpartition("}")[2]] = element.attrib.pop(name)


def _tidy(root: ElementTree.Element, key: str) -> None:
    """Keep only the ids that are pointed at, under the page's names; mark the curves; restyle everything."""
    wanted = set()
    for element in root.iter():
        for style in element.findall("style"):
            element.remove(style)
        wanted |= {name for value in element.attrib.values() for name in REFERENCE.findall(value)}
        wanted.add(element.attrib.get("href", "").removeprefix("#"))
    for element in root.iter():
        element.attrib = {name: _attribute(name, value, key) for name, value in element.attrib.items()}
        name = element.attrib.pop("id", "")
        if name.startswith("curve:"):
            element.attrib["data-curve"] = name.removeprefix("curve:")
        elif name and name in wanted:
            element.attrib["id"] = f"{key}-{name}"


def _attribute(name: str, value: str, key: str) -> str:
    if name == "id":
        return value
    if name == "href":
        return f"#{key}-{value.removeprefix('#')}"
    value = LONG_NUMBER.sub(r"\1", REFERENCE.sub(lambda match: f"url(#{key}-{match.group(1)})", value))
    return _restyle(value) if name == "style" else value


def _restyle(style: str) -> str:
    style = FONT.sub(lambda match: f"font-size: {match.group(1)}" if match.group(1) else "", style)
    for number, colour in enumerate(COLOURS):
        style = re.sub(colour, f"var(--curve-{number})", style, flags=re.IGNORECASE)
    return style.replace(GRID_COLOUR, "var(--grid)").replace("#ffffff", "var(--paper)")
