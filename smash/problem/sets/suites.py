"""Instance sets: the committed ones by name, any directory of instance files by its path."""

from __future__ import annotations

import os
from collections.abc import Iterator
from pathlib import Path

from smash.problem import arguments
from smash.problem.errors import MalformedFile
from smash.problem.files.instances import read_instance
from smash.problem.model import Instance
from smash.problem.sets.generators import generate
from smash.problem.sets.open_instances import FAMILIES, open_set

SUITES = Path(__file__).parent / "committed"
SUITE_SEED = 2026
SUITE_COUNT = 20
PAPER_SUITES = {f"{kind}-{size}": (kind, size) for kind in ("single", "multi") for size in (4, 6, 9)}
"""The committed benchmark sets: name -> (benchmark, blocks); 20 instances with 12 buffers each."""


def suite_names() -> list[str]:
    """Return the names of the committed sets."""
    return sorted(path.name for path in SUITES.iterdir() if path.is_dir())


def suite_files(name: str | os.PathLike[str]) -> list[Path]:
    """Return the instance files of a committed set or of a directory, sorted by name; an instance file is its own set.

    Raises:
        MalformedFile: where it is none of these, or holds no instance file.
    """
    where = arguments.path(name)
    directory = SUITES / where if where in suite_names() else Path(where)
    if directory.is_file():
        return [directory]
    if not directory.is_dir():
        known = ", ".join(suite_names())
        raise MalformedFile(where, f"neither a directory of instance files nor a committed set ({known})")
    files = sorted(directory.glob("*.json"))
    if not files:
        raise MalformedFile(where, "the directory holds no instance file (*.json)")
    return files


def read_suite(name: str | os.PathLike[str]) -> list[Instance]:
    """Read all instances of a set.

    Args:
        name: a committed set (`suite_names`), a directory of instance files, or one instance file.

    Raises:
        MalformedFile: where one of them is refused, or two have the same name.
    """
    instances: dict[str, Instance] = {}
    for file in suite_files(name):
        instance = read_instance(file)
        if instance.name in instances:
            raise MalformedFile(str(file), f"`name`: {instance.name!r} stands twice in the set")
        instances[instance.name] = instance
    return list(instances.values())


def generated_names() -> list[str]:
    """Return the names of the committed sets that `made_again` makes."""
    return [*PAPER_SUITES, *FAMILIES]


def made_again(name: str) -> Iterator[Instance]:
    """Generate the instances of a committed set anew.

    Raises:
        KeyError: where no generated set is called so.
    """
    if name in FAMILIES:
        return open_set(name, SUITE_SEED)
    kind, size = PAPER_SUITES[name]
    return iter(generate(kind, size, count=SUITE_COUNT, seed=SUITE_SEED))
