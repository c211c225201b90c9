"""Texts of others in our own lines: names that are no words must not steer a terminal or break a table."""

from __future__ import annotations


def visible(text: str) -> str:
    """Return a text with everything that cannot be printed escaped: control characters, lone surrogates, breaks."""
    if text.isprintable():
        return text
    return "".join(letter if letter.isprintable() else ascii(letter)[1:-1] for letter in text)


def one_line(text: str) -> str:
    """Return a text as one line: runs of white space as one space, everything else that cannot be printed escaped."""
    return visible(" ".join(text.split()))


def counted(number: int, thing: str) -> str:
    """Return how many there are of something: `1 run`, `2 runs`, `1,000 runs`."""
    return f"{number:,} {thing}" + ("" if number == 1 else "s")
