"""Write docs/licences.md's table: every package of requirements.lock, its licence, and what brings it.

Licences are what the installed packages say of themselves, so all of them must be there: `make licences` sees to it.
What stands in the table already is kept for those that this Python cannot have.
"""

from __future__ import annotations

import re
import sys
import tomllib
from importlib.metadata import Distribution, distributions

import locked

PAGE = locked.ROOT / "docs" / "licences.md"
BEGIN, END = "<!-- made by `make licences`: begin -->\n", "<!-- made by `make licences`: end -->\n"
SAID_ELSEWHERE = {
    "cmeel-qhull": "Qhull",
    "configspace": "BSD-3-Clause",
    "didppy": "MIT OR Apache-2.0",
    "mlcroissant": "Apache-2.0",
    "uv": "MIT OR Apache-2.0",
}
"""Of packages whose metadata does not say it: what stands in their repositories."""
LONGEST = 60
ROW = re.compile(r"^\| ([a-z0-9-]+) \| ([^|]+) \| ([^|]+) \|", re.MULTILINE)


def licence(package: Distribution) -> str:
    """Return a package's licence as its metadata says it; empty where they do not."""
    metadata = package.metadata
    expression = metadata.get("License-Expression")
    if expression:
        return str(expression)
    classified = [
        line.split(" :: ")[-1] for line in metadata.get_all("Classifier", []) if line.startswith("License ::")
    ]
    words = str(metadata.get("License", "")).strip()
    if words and words != "UNKNOWN" and len(words) <= LONGEST and "\n" not in words:
        return words
    return " AND ".join(word for word in classified if word != "DFSG approved")


def bringers() -> dict[str, list[str]]:
    """Return package -> `planning`, the extras and the groups whose packages it is among."""
    project = tomllib.loads((locked.ROOT / "pyproject.toml").read_text(encoding="utf-8"))
    entries = locked.entries()
    planning = locked.reached(locked.asked(project, []), entries)
    found: dict[str, list[str]] = {name: [] for name in entries}
    for name in planning:
        found[name] = ["planning"]
    extras = [name for name in project["project"]["optional-dependencies"] if name != "all"]
    for extra in [*extras, *project.get("dependency-groups", {})]:
        for name in locked.reached(locked.asked(project, [extra]), entries):
            if name not in planning:
                found[name].append(extra)
    return found


def table(earlier: str) -> str:
    """Return the table, in the lock's order.

    Raises:
        SystemExit: where the licence of a package is not known.
    """
    tool = locked.ROOT / ".venvs" / "lock" / "lib"
    places = [*sys.path, *map(str, tool.glob("python*/site-packages"))]
    there = {locked.plain(package.name): package for package in distributions(path=places)}
    before = {name: (version, said) for name, version, said in ROW.findall(earlier)}
    brought = bringers()
    lines, unknown = ["| package | version | licence | for |", "|---|---|---|---|"], []
    for name, (text, _) in locked.entries().items():
        version = re.split(r"==|\s", text)[1]
        if "win32" in text.splitlines()[0] and "!=" not in text.splitlines()[0]:
            continue
        package = there.get(name)
        said = SAID_ELSEWHERE.get(name) or (licence(package) if package is not None else "")
        said = said or (before[name][1] if before.get(name, ("", ""))[0] == version else "")
        if not said:
            unknown.append(name)
        lines.append(f"| {name} | {version} | {said} | {', '.join(brought[name])} |")
    if unknown:
        sys.exit(f"smash: no licence is known of {', '.join(unknown)}: are they installed?")
    return "\n".join(lines) + "\n"


def main() -> None:
    """Write the table between its marks."""
    text = PAGE.read_text(encoding="utf-8")
    before, _, rest = text.partition(BEGIN)
    earlier, _, after = rest.partition(END)
    PAGE.write_text(before + BEGIN + table(earlier) + END + after, encoding="utf-8")


if __name__ == "__main__":
    main()
