#!/usr/bin/env python3
"""Print the part of requirements.lock that is needed: `.ci/locked.py [EXTRA…]`, the packages for planning always.

`all` is every extra but `dev`; a name of `[dependency-groups]` in pyproject.toml stands for that group alone, without
the packages for planning (`.ci/locked.py build`). One lock has one version of each package for everybody; an
environment gets the packages that its extras reach along the lock's own `# via` lines.
"""

from __future__ import annotations

import re
import sys
import tomllib
from collections import defaultdict
from pathlib import Path
from typing import Any

ROOT = Path(__file__).resolve().parents[1]
LOCK = ROOT / "requirements.lock"
ENTRY = re.compile(r"^(?=[A-Za-z0-9])", re.MULTILINE)
"""Where an entry begins: its hashes and who asks for it are indented."""
NAME = re.compile(r"[A-Za-z0-9][A-Za-z0-9._-]*")


def plain(word: str) -> str:
    """Return the name of a requirement as the index spells it."""
    found = NAME.match(word)
    assert found is not None, word
    return re.sub(r"[-_.]+", "-", found.group()).lower()


def entries() -> dict[str, tuple[str, list[str]]]:
    """Return name -> (the lines of its entry, the packages that ask for it)."""
    found: dict[str, tuple[str, list[str]]] = {}
    for entry in ENTRY.split(LOCK.read_text(encoding="utf-8"))[1:]:
        lines = entry.splitlines()
        asking = [line.strip("# ").removeprefix("via").strip() for line in lines if line.lstrip().startswith("#")]
        text = "\n".join(line for line in lines if not line.lstrip().startswith("#"))
        before, others = found.get(plain(entry), ("", []))  # several versions of one, each for some Pythons
        found[plain(entry)] = f"{before}\n{text}".strip(), [*others, *(plain(word) for word in asking if word)]
    return found


def asked(project: dict[str, Any], names: list[str]) -> set[str]:
    """Return the packages that pyproject.toml names for extras and groups.

    Raises:
        SystemExit: where one of them is neither.
    """
    tables = project["project"]
    extras, groups = tables["optional-dependencies"], project.get("dependency-groups", {})
    unknown = [name for name in names if name not in extras and name not in groups]
    if unknown:
        sys.exit(f"smash: no extra {', '.join(unknown)}; there are {', '.join([*extras, *groups])}")
    words = [] if names and all(name in groups for name in names) else [*tables["dependencies"]]
    waiting, seen = [*names], set()
    while waiting:
        name = waiting.pop()
        if name in seen:
            continue
        seen.add(name)
        for word in [*extras.get(name, []), *groups.get(name, [])]:
            if plain(word) == plain(tables["name"]):
                waiting += re.findall(r"[A-Za-z0-9-]+", word.partition("[")[2])
            else:
                words.append(word)
    return {plain(word) for word in words}


def reached(wanted: set[str], locked: dict[str, tuple[str, list[str]]]) -> list[str]:
    """Return the names of the lock that packages bring along, theirs included, in the lock's order.

    Raises:
        SystemExit: where the lock lacks one of the packages.
    """
    missing = sorted(wanted.difference(locked))
    if missing:
        sys.exit(f"smash: requirements.lock lacks {', '.join(missing)}; make lock makes it again")
    brought = defaultdict(set)
    for name, (_, asking) in locked.items():
        for parent in asking:
            brought[parent].add(name)
    waiting, found = [*wanted], set()
    while waiting:
        name = waiting.pop()
        if name not in found:
            found.add(name)
            waiting += brought[name]
    return [name for name in locked if name in found]


def main() -> None:
    """Print the lines."""
    with open(ROOT / "pyproject.toml", "rb") as file:
        project = tomllib.load(file)
    locked = entries()
    for name in reached(asked(project, sys.argv[1:]), locked):
        print(locked[name][0])


if __name__ == "__main__":
    main()
