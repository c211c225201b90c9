"""The plan in an answer: a JSON list of actions, lines that name actions, or steps in PDDL. Linear in the text."""

from __future__ import annotations

import ast
import json
import re
from collections.abc import Iterator
from contextlib import suppress
from typing import Any, cast

from smash.problem.actions.registry import FAMILY
from smash.problem.errors import MalformedFile
from smash.problem.files.plans import action_from_list
from smash.problem.model import Action

DIGITS = 9
"""Of the longest number that is read as one."""
NAMES = ("pick", "place", *FAMILY)

_NUMBER = r"-?\d++(?:\.\d++)?+(?:[eE][+-]?\d++)?+"
_SCALAR = rf"""(?:"(?:[^"\\\n]|\\.)*+"|'[^'\\\n]*+'|{_NUMBER}|true|false|null)"""
_FLAT = rf"\[\s*+(?:{_SCALAR}\s*+(?:,\s*+{_SCALAR}\s*+)*+)?+\]"
LISTS = re.compile(rf"\[\s*+(?:{_FLAT}\s*+(?:,\s*+{_FLAT}\s*+)*+)?+\]")
"""A JSON list of flat lists, also with the quotes of Python; nothing is tried twice."""

_BREAK = r"""[\s,()\[\]"'`*|]"""
_WORD = r"""[^\s,()\[\]"'`*|]"""
_BETWEEN = rf"(?:(?:from|off|on|onto|to|into|at|height|->|=>|→){_BREAK}++)*"
WORDS = re.compile(
    rf"[\W_]*+(?:(?:step|action|move)[\W_]++)?+(?:\d++[.):]*+[\W_]*+)?+"
    rf"(?:(?:and|then|first|next|finally)[\W_]++)*+(?P<name>{'|'.join(NAMES)}){_BREAK}++"
    rf"(?P<first>{_WORD}++){_BREAK}++{_BETWEEN}(?P<second>{_WORD}++)",
    re.IGNORECASE,
)
"""An action in words: its name and two arguments, whatever signs stand around them."""

ARROW = re.compile(r"[-=]>|→")

STEP = re.compile(r"[^\w(]*+(?:\d[\d.):]*+[^\w(]*+)?+\(([^()]++)\)")
"""A step of a plan in PDDL, on a line of its own."""


def answered_actions(text: str) -> tuple[Action, ...]:
    """Return the plan in an answer: the last JSON list of actions in it, else its lines that name actions.

    A list of lists that is none of actions, such as a picture of a state, counts as a plan only where nothing else is
    there.

    Raises:
        MalformedFile: where there is no plan, or an action is none.
    """
    lists = [_parsed(match[0]) for match in LISTS.finditer(text)]
    plans = [listed for listed in lists if any(map(_is_action, listed))]
    listed = plans[-1] if plans else list(_in_words(text))
    if not listed and not lists:
        raise MalformedFile("answer", "holds no plan: neither a JSON list of actions nor lines that name them")
    return tuple(
        action_from_list(entry, f"answer, action {number}") for number, entry in enumerate(listed or lists[-1], 1)
    )


def answered_steps(text: str) -> list[tuple[str, ...]]:
    """Return the steps of the plan in an answer to a prompt in PDDL: its lines `(name argument ...)`.

    Raises:
        MalformedFile: where there is no plan.
    """
    found = [tuple(match[1].lower().split()) for match in map(STEP.match, text.splitlines()) if match]
    steps = [step for step in found if step]
    if not steps:
        raise MalformedFile("answer", "holds no plan: no line (name argument ...)")
    return steps


def _parsed(text: str) -> list[list[Any]]:
    found: list[list[Any]] = [[text[:40]]]  # an escape that JSON has not, a number such as 01
    with suppress(ValueError):
        return cast(list[list[Any]], json.loads(text, parse_int=_number))
    if "'" in text and "\\" not in text:
        with suppress(ValueError, SyntaxError, MemoryError):
            found = ast.literal_eval(text)
    return found


def _is_action(entry: list[Any]) -> bool:
    return bool(entry) and isinstance(entry[0], str) and entry[0] in NAMES


def _in_words(text: str) -> Iterator[list[Any]]:
    for match in _in_lines(ARROW.sub(r" \g<0> ", text)):
        first, second = (match[part].rstrip(".,;:") or match[part] for part in ("first", "second"))
        name = match["name"].lower()
        yield [name, first, _number(second) if name == "topple" and second.isdecimal() else second]


def _in_lines(text: str) -> Iterator[re.Match[str]]:
    """Yield the actions in words with which lines begin, and those that follow each directly."""
    for line in text.splitlines():
        at = 0
        while match := WORDS.match(line, at):
            yield match
            at = match.end()


def _number(text: str) -> int | str:
    """Return a number; one of too many digits stays a text, which is none."""
    return int(text) if len(text) <= DIGITS else f"{text[:DIGITS]}…"
