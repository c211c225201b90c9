"""Runs a notebook as a kernel would, cell by cell, and hands back what each cell shows."""

import ast
import json


def run_notebook(path):
    """Return the value of the last expression of every code cell that has one, in order; its semicolon hides none."""
    values, names = [], {"__name__": "__main__"}
    for number, cell in enumerate(json.loads(path.read_text(encoding="utf-8"))["cells"]):
        if cell["cell_type"] != "code":
            continue
        tree = ast.parse("".join(cell["source"]), f"{path.name}[{number}]")
        last = tree.body.pop() if isinstance(tree.body[-1], ast.Expr) else None
        exec(compile(tree, f"{path.name}[{number}]", "exec"), names)
        if last is not None:
            values.append(eval(compile(ast.Expression(last.value), f"{path.name}[{number}]", "eval"), names))
    return values
