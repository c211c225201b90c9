"""Which code decides what a stage makes: the rooms that its commands run, and of them only what a program says.

So a stage of tables is not stale where the executor has changed, nor any stage where a comment, a docstring or the
layout of a file has, or what is not run at all (tests, pages, examples).
"""

from __future__ import annotations

import ast
import hashlib
import shlex
from collections.abc import Iterable, Iterator
from functools import cache
from importlib.util import find_spec
from pathlib import Path

from smash_baselines.domains import DOMAINS

GROUND = frozenset({"smash/problem", "smash/records"})
ANALYSIS = GROUND | {"smash_analysis"}
PLANNING = GROUND | {
    *("smash/gadget", "smash/planners", "smash/forecast", "smash_baselines", "domains", "smash/cli/sweep.py"),
    *(f"smash/experiments/{name}" for name in ("environment.py", "isolation", "sweeps", "studies", "weighing")),
}
EVERYTHING = frozenset({"smash", "smash_baselines", "smash_analysis", "domains"})
ROOMS = {
    "smash sweep": PLANNING,
    "smash scaling": PLANNING | {"smash/cli/scaling.py"},
    "smash compare": PLANNING | ANALYSIS | {"smash/cli/compare.py", "smash/experiments/comparison.py"},
    "smash frontier": PLANNING | ANALYSIS | {"smash/cli/frontier.py"},
    "smash report": ANALYSIS | {"smash/cli/report.py"},
    "python -m smash.experiments.studies.benchmark": PLANNING,
    "python -m smash_analysis": ANALYSIS,
}
"""How a command begins, and the rooms that it runs; any other may run everything."""


def rooms_of(commands: Iterable[str]) -> frozenset[str]:
    """Return the rooms that the commands of a stage run."""
    rooms: frozenset[str] = frozenset()
    for command in commands:
        words = f"{shlex.join(shlex.split(command))} "
        rooms |= next(
            (mine for begin, mine in ROOMS.items() if words.startswith((f"{begin} ", f"{begin}."))), EVERYTHING
        )
    return rooms


@cache
def code_hash(rooms: frozenset[str]) -> str:
    """Return a hash of what the code of some rooms says as it stands, committed or not."""
    total = hashlib.sha256()
    for name, file in sorted(_files(rooms)):
        total.update(f"{name}\0{_said(file)}\n".encode())
    return total.hexdigest()


def _files(rooms: frozenset[str]) -> Iterator[tuple[str, Path]]:
    """Yield every file of the rooms, under its name within them."""
    for room in rooms:
        package, _, inner = room.partition("/")
        root = _root(package)
        place = root / inner
        for file in [place] if place.is_file() else place.rglob("*"):
            if file.is_file() and "__pycache__" not in file.parts and file.name != "py.typed":
                yield f"{package}/{file.relative_to(root).as_posix()}", file


def _root(package: str) -> Path:
    if package == "domains":
        return DOMAINS
    spec = find_spec(package)
    assert spec is not None  # they are installed together
    assert spec.submodule_search_locations is not None
    return Path(next(iter(spec.submodule_search_locations)))


class _Bare(ast.NodeTransformer):
    """Leaves out strings that stand alone: docstrings, and those under what they describe."""

    def visit_Expr(self, node: ast.Expr) -> ast.Expr | None:
        return None if isinstance(node.value, ast.Constant) and isinstance(node.value.value, str) else node


@cache
def _said(file: Path) -> str:
    content = file.read_bytes()
    if file.suffix == ".py":
        content = ast.dump(_Bare().visit(ast.parse(content))).encode()
    return hashlib.sha256(content).hexdigest()
