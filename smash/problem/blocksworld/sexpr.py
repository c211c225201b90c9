"""Reading nested parentheses (PDDL's notation): comments dropped, names in lower case as PDDL ignores case."""

from __future__ import annotations

import re

from smash.problem.errors import MalformedFile

Expression = str | list["Expression"]

_TOKEN = re.compile(r";[^\r\n]*|[()]|[^\s();]+")
"""A comment ends at a line feed or a carriage return, and at nothing else that is taken for an end of line."""
_LINE_END = re.compile(r"\r\n|\r|\n")
MOST_NESTED = 200


def parse_expression(text: str, where: str) -> list[Expression]:
    """Return the one parenthesised expression of `text`.

    Raises:
        MalformedFile: where parentheses do not match or something stands outside of them; with the line.
    """
    root: list[Expression] = []
    here = root
    enclosing: list[list[Expression]] = []
    opened_at: list[int] = []
    names: dict[str, str] = {}
    for match in _TOKEN.finditer(text):
        token = match[0]
        if token == "(":
            fresh: list[Expression] = []
            here.append(fresh)
            enclosing.append(here)
            opened_at.append(match.start())
            here = fresh
            if len(enclosing) > MOST_NESTED:
                problem = f"nested deeper than {MOST_NESTED} parentheses"
                raise MalformedFile(where, f"line {_line(text, match.start())}: {problem}")
        elif token == ")":
            if not enclosing:
                raise MalformedFile(where, f"line {_line(text, match.start())}: a `)` without its `(`")
            here = enclosing.pop()
            opened_at.pop()
        elif token[0] == ";":
            continue
        elif not enclosing:
            problem = f"{shortened(token)!r} stands outside of parentheses"
            raise MalformedFile(where, f"line {_line(text, match.start())}: {problem}")
        else:
            name = token.lower()
            here.append(names.setdefault(name, name))
    if opened_at:
        raise MalformedFile(where, f"the `(` of line {_line(text, opened_at[-1])} is never closed")
    if len(root) != 1 or not isinstance(root[0], list):
        raise MalformedFile(where, f"{len(root)} expressions; one `(define (problem …) …)` is allowed")
    return root[0]


def _line(text: str, position: int) -> int:
    return len(_LINE_END.findall(text, 0, position)) + 1


def show(expression: Expression) -> str:
    """Return an expression as it is written; the end of a long one is left out."""
    if isinstance(expression, str):
        return shortened(expression)
    return "(" + " ".join(show(part) for part in expression[:6]) + (" …" if len(expression) > 6 else "") + ")"


def shortened(name: str, most: int = 60) -> str:
    """Return a name with the end of a long one left out."""
    return name if len(name) <= most else name[:most] + "…"
