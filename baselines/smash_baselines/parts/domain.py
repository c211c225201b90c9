"""The family's domains: the parts that an instance needs, put together into one PDDL domain."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping, Sequence

SECTIONS = (":types", ":predicates", ":functions")
"""What parts add lines to; everything after them is actions."""


def domain_name(files: Sequence[str]) -> str:
    """Return the PDDL name of the domain of these parts: `smash-costs-topple-carry`."""
    return "-".join(["smash-costs", *files[1:]])


def domain_text(texts: Mapping[str, str]) -> str:
    """Return the PDDL text of the domain of these parts, comments included.

    Args:
        texts: their texts by name; the first is pick and place.
    """
    merged: dict[str, list[str]] = {section: [] for section in SECTIONS}
    actions: list[str] = []
    for text in texts.values():
        for start, end in _forms(text):
            section = text[start + 1 : end].split(maxsplit=1)[0]
            if section in merged:
                merged[section].append(text[start + 1 : end - 1].removeprefix(section).strip())
        actions.append(text[text.index("; ---") :].rstrip())
    lines = [f"(define (domain {domain_name(list(texts))})", "(:requirements :strips :typing :action-costs)", ""]
    for section, added in merged.items():
        lines += [f"({section}", *(f"  {words}" for words in added if words), ")", ""]
    return "\n".join([*lines, "\n\n".join(actions), ")", ""])


def extended_text(text: str, old: str, new: str, added: str) -> str:
    """Return the PDDL text of a domain with a part of the same form as those of the family added to it.

    Args:
        text: the domain.
        old: its PDDL name.
        new: the PDDL name of the result.
        added: types and predicates, then actions after a line `; --- …`.
    """
    sections = {added[start + 1 : end].split(maxsplit=1)[0]: added[start + 1 : end - 1] for start, end in _forms(added)}
    inside = text.index("(define") + 1
    pieces, done = [], 0
    for start, end in _forms(text[inside:]):
        section = text[inside + start + 1 : inside + end].split(maxsplit=1)[0]
        if section in SECTIONS and section in sections:
            lines = sections[section].removeprefix(section).strip()
            pieces += [text[done : inside + end - 1].rstrip(), f"\n    {lines})"]
            done = inside + end
    rest = text[done:].rstrip().removesuffix(")").rstrip()
    actions = added[added.index("; ---") :].rstrip()
    return "".join([*pieces, rest, f"\n\n{actions}\n)\n"]).replace(f"(domain {old})", f"(domain {new})", 1)


def text_without_costs(text: str) -> str:
    """Return the PDDL text of a domain without what it says of costs."""
    text = re.sub(r"\s*\(increase \(total-cost\) \d+\)", "", text)
    text = re.sub(r"\s*\(:functions \(total-cost\) - number\)", "", text)
    return text.replace(" :action-costs", "").replace(" Cost 1.", "")


def _forms(text: str) -> Iterator[tuple[int, int]]:
    """Yield where each top-level parenthesised form starts and ends; comments are skipped."""
    depth, start, comment = 0, 0, False
    for index, character in enumerate(text):
        if comment:
            comment = character != "\n"
        elif character == ";":
            comment = True
        elif character == "(":
            start = start if depth else index
            depth += 1
        elif character == ")":
            depth -= 1
            if not depth:
                yield start, index + 1
