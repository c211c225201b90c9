"""Every figure of README and docs names its command and the record that it came from.

A paragraph, list or table with measured figures ends with a comment, `<!-- from: COMMAND -> RECORD -->`: the command
as a reader would type it, the record a file or folder of the repository, or `RECORD#words`, which stand in the file.
Several sources stand one a line. `<!-- from: the paper -->` and `<!-- from: stated -->` say of figures that nobody
measured here where they are from: the paper, or a choice (a budget, a size, a limit of the law).
"""

import re
from importlib.util import find_spec
from pathlib import Path

import pytest

from smash.cli import COMMANDS

ROOT = Path(__file__).parents[1]
PAGES = [ROOT / "README.md", *sorted(ROOT.glob("docs/**/*.md"))]
FIGURE = re.compile(
    r"\b\d[\d,.]* ?(?:ms|s|seconds?|CPU seconds|processor seconds|minutes|hours|MB|GB|MiB|cm|mm|times)\b"
    r"|\b\d[\d,.]* ?%|\b\d[\d,]* of (?:the |their )?\d[\d,]*\b"
)
SOURCE = re.compile(r"<!-- from: (.+?) -->")
NOT_MEASURED = {"the paper", "stated"}


def blocks(text):
    """Yield the paragraphs, lists and tables of a page, without code."""
    text = re.sub(r"^(```|~~~).*?^\1\s*$", "", text, flags=re.MULTILINE | re.DOTALL)
    yield from filter(None, map(str.strip, re.split(r"\n\s*\n", text)))


def without_source(text):
    """Return the blocks with figures that do not say where these are from."""
    return [b for b in blocks(text) if FIGURE.search(b) and not SOURCE.search(b)]


def fault_of(source):
    """Return what is wrong with a source, or None."""
    if source in NOT_MEASURED:
        return None
    command, arrow, record = source.partition(" -> ")
    if not arrow:
        return "no ` -> RECORD`"
    path, _, words = record.partition("#")
    if not (ROOT / path).exists():
        return f"no record {path}"
    if words and words not in (ROOT / path).read_text(encoding="utf-8"):
        return f"{path} does not say {words!r}"
    return fault_of_command(command.split())


def fault_of_command(words):
    """Return why a command cannot be one, or None."""
    match words:
        case ["make", target, *_]:
            known = re.search(rf"^{re.escape(target)}:", (ROOT / "Makefile").read_text(encoding="utf-8"), re.MULTILINE)
            return None if known else f"no target {target} in the Makefile"
        case ["smash", name, *_]:
            return None if name in COMMANDS else f"no command smash {name}"
        case ["python", "-m", "pytest", *_]:
            return None
        case ["python", "-m", module, *_]:
            return None if find_spec(module) else f"no module {module}"
        case _:
            return f"not a command of ours: {' '.join(words)}"


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.name)
def test_every_source_of_a_figure_is_there(page):
    sources = SOURCE.findall(page.read_text(encoding="utf-8"))
    assert {source: fault for source in sources if (fault := fault_of(source))} == {}


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.name)
def test_every_figure_says_its_source(page):
    assert without_source(page.read_text(encoding="utf-8")) == []


@pytest.mark.parametrize(
    ("text", "missing"),
    [
        ("It takes 3 s.", 1),
        ("It takes 3 s.\n<!-- from: stated -->", 0),
        ("Six of seven, 12 of 13.", 1),
        ("```\ntook 3 s\n```\n\nNo figure.", 0),
        ("| a |\n|---|\n| 40 % |\n<!-- from: make bench -> results/bench -->", 0),
    ],
)
def test_blocks_with_figures_are_told_from_others(text, missing):
    assert len(without_source(text)) == missing


@pytest.mark.parametrize(
    ("source", "fault"),
    [
        ("make bench -> results/bench", None),
        ("make bench", "no ` -> RECORD`"),
        ("make nothing -> results/bench", "no target nothing in the Makefile"),
        ("make bench -> results/nothing", "no record results/nothing"),
        ("make bench -> results/README.md#no such words", "results/README.md does not say 'no such words'"),
        ("smash nothing -> results", "no command smash nothing"),
        ("python -m smash.nothing -> results", "no module smash.nothing"),
        ("by hand -> results", "not a command of ours: by hand"),
    ],
)
def test_a_source_that_is_not_there_is_named(source, fault):
    assert fault_of(source) == fault
