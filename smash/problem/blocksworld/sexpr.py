"""Reading nested parentheses (PDDL's notation): comments dropped, names in lower case as PDDL ignores case."""

from __future__ import annotations

import re

from smash.problem.errors import MalformedFile

Expression = str | list["Expression"]

_TOKEN = re.compile(r"[()]|[^\s()]+")
MOST_NESTED = 200


def parse_expression(text: str, where: str) -> list[Expression]:
    """Return the one parenthesised expression of `text`.

    Raises:
        MalformedFile: where parentheses do not match or something stands outside of them; with the line.
    """
    root: list[Expression] = []
    open_lists = [root]
    opened_at: list[int] = []
    for number, line in enumerate(text.splitlines(), start=1):
        for token in _TOKEN.findall(line.split(";", 1)[0]):
            if token == "(":
                fresh: list[Expression] = []
                open_lists[-1].append(fresh)
                open_lists.append(fresh)
                opened_at.append(number)
                if len(opened_at) > MOST_NESTED:
                    raise MalformedFile(where, f"line {number}: nested deeper than {MOST_NESTED} parentheses")
            elif token == ")":
                if not opened_at:
                    raise MalformedFile(where, f"line {number}: a `)` without its `(`")
                open_lists.pop()
                opened_at.pop()
            elif not opened_at:
                raise MalformedFile(where, f"line {number}: {token!r} stands outside of parentheses")
            else:
                open_lists[-1].append(token.lower())
    if opened_at:
        raise MalformedFile(where, f"the `(` of line {opened_at[-1]} is never closed")
    if len(root) != 1 or not isinstance(root[0], list):
        raise MalformedFile(where, f"{len(root)} expressions; one `(define (problem …) …)` is allowed")
    return root[0]
