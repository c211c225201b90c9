"""The steps of a reproduction: a short TOML file, and what each step's products are made from.

A step's commands are words, not shell: the first is `smash` or `python`, `{out}` is the directory of the products and
`{here}` that of the file. A step writes into `{out}/NAME` alone.
"""

from __future__ import annotations

import hashlib
import os
import re
import shlex
import sys
from collections.abc import Sequence
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path
from typing import cast

import msgspec

import smash
from smash.experiments.environment import versions
from smash.planners.registry import DEFAULT
from smash.problem.errors import MalformedFile
from smash.problem.files.documents import convert, parse_toml, read_bytes

PROGRAMS = {"smash": (sys.executable, "-m", "smash"), "python": (sys.executable,)}
PACKAGES = ("coal", "matplotlib", "ompl", "pandas", "pin", "pybullet", "toppra")
"""Distributions that decide what is made, beside those that decide what a planner answers."""
CODE = ("smash", "baselines", "analysis", "domains")
"""The folders whose content decides what a command makes."""


class Step(msgspec.Struct, forbid_unknown_fields=True, frozen=True):
    """One `[[steps]]` table.

    `minutes` is the estimated time on 2 quiet cores; `products` are patterns below `{out}`, each of which must be met;
    `after` names earlier steps whose products it uses, as far as there are any; `requires` packages without which it is
    not run; `leaves_out` says what
    of the whole it does not do, and why; `not_copied` are products that are too large for `--copy-to`.
    """

    name: str
    about: str
    minutes: float
    commands: list[str]
    products: list[str]
    after: list[str] = []
    requires: list[str] = []
    leaves_out: str = ""
    not_copied: list[str] = []

    def words(self, out: Path, here: Path) -> list[list[str]]:
        """Return the commands as they are started."""
        places = {"{out}": str(out), "{here}": str(here)}
        return [_command(shlex.split(command), places) for command in self.commands]

    def inputs(self, here: Path) -> list[Path]:
        """Return the files beside the steps file that the commands name."""
        words = [word for command in self.commands for word in shlex.split(command)]
        named = [here / word.removeprefix("{here}/") for word in words if word.startswith("{here}/")]
        return sorted({file for file in named if file.is_file()})

    def lacking(self) -> list[str]:
        """Return the required packages that are not installed."""
        return [package for package in self.requires if not _installed(package)]


class Steps(msgspec.Struct, forbid_unknown_fields=True, frozen=True):
    """A steps file."""

    name: str
    about: str
    steps: list[Step]


class MadeFrom(msgspec.Struct, frozen=True):
    """Whatever decides a step's products: hashes of its inputs and of the code, versions of the packages."""

    commands: list[str]
    code: str
    packages: dict[str, str]
    inputs: dict[str, str]
    uses: dict[str, str]

    def changes(self, now: MadeFrom) -> list[str]:
        """Return in words what is different now."""
        words = []
        if self.commands != now.commands:
            words.append("its commands have changed")
        for name in sorted({*self.inputs, *now.inputs}):
            if self.inputs.get(name) != now.inputs.get(name):
                words.append(f"{name} has changed")
        if self.code != now.code:
            words.append("the code has changed")
        for name in sorted({*self.packages, *now.packages}):
            if self.packages.get(name) != now.packages.get(name):
                words.append(f"{name} was {self.packages.get(name, 'missing')}")
        words += [f"{name} was made anew" for name in now.uses if self.uses.get(name) != now.uses[name]]
        return words


def read_steps(path: Path) -> Steps:
    """Read a steps file.

    Raises:
        MalformedFile: with one line that says where and what is allowed.
    """
    where = os.fspath(path)
    steps = cast(Steps, convert(parse_toml(read_bytes(path), where), Steps, where))
    _check(steps, where)
    return steps


def _check(steps: Steps, where: str) -> None:
    def expect(holds: bool, part: str, problem: str) -> None:
        if not holds:
            raise MalformedFile(where, f"`{part}`: {problem}")

    plain = re.compile(r"[A-Za-z0-9][A-Za-z0-9._-]*")
    expect(plain.fullmatch(steps.name) is not None, "name", f"{steps.name!r} is no plain file name")
    expect(bool(steps.steps), "steps", "empty; at least one is needed")
    before: list[str] = []
    for index, step in enumerate(steps.steps):
        at = f"steps[{index}]"
        fits = plain.fullmatch(step.name) is not None and step.name not in RESERVED
        expect(fits, f"{at}.name", f"{step.name!r} is no plain folder name, or one of {', '.join(RESERVED)}")
        expect(step.name not in before, f"{at}.name", f"{step.name!r} stands twice")
        expect(step.minutes > 0, f"{at}.minutes", f"{step.minutes} is not allowed; above 0")
        expect(bool(step.commands), f"{at}.commands", "empty; at least one is needed")
        for command in step.commands:
            problem = _problem(command)
            expect(not problem, f"{at}.commands", problem)
        expect(bool(step.products), f"{at}.products", "empty; at least one is needed")
        for product in step.products:
            inside = product.startswith(f"{step.name}/") and ".." not in Path(product).parts
            expect(inside, f"{at}.products", f"{product!r} does not lie in the step's folder {step.name}/")
        for name in step.after:
            expect(name in before, f"{at}.after", f"{name!r} is no earlier step; there are: {', '.join(before)}")
        before.append(step.name)


RESERVED = ("logs", "records", "manifest.json", "MANIFEST.md")
"""Names in the directory of a reproduction that are not a step's."""


def _problem(command: str) -> str:
    try:
        words = shlex.split(command)
    except ValueError as error:
        return f"{command!r}: {error}"
    if not words or words[0] not in PROGRAMS:
        return f"{command!r} does not begin with {' or '.join(PROGRAMS)}"
    return ""


def _command(words: Sequence[str], places: dict[str, str]) -> list[str]:
    started = [*PROGRAMS[words[0]]]
    for word in words[1:]:
        for place, path in places.items():
            word = word.replace(place, path)
        started.append(word)
    return started


def _installed(package: str) -> bool:
    try:
        version(package)
    except PackageNotFoundError:
        return False
    return True


def made_from(step: Step, here: Path, code: str, uses: dict[str, str]) -> MadeFrom:
    """Return what the step would be made from now; `uses` has a hash of the products of each step that it uses."""
    inputs = {file.name: file_hash(file) for file in step.inputs(here)}
    packages = versions(DEFAULT) | {name: version(name) for name in PACKAGES if _installed(name)}
    return MadeFrom(list(step.commands), code, packages, inputs, uses)


def code_hash() -> str:
    """Return a hash of all of this code as it stands, committed or not."""
    total = hashlib.sha256()
    root = Path(smash.__file__).parent.parent
    for folder in CODE:
        for file in sorted((root / folder).rglob("*")):
            if file.is_file() and "__pycache__" not in file.parts:
                total.update(f"{file.relative_to(root)}\0{file_hash(file)}\n".encode())
    return total.hexdigest()


def file_hash(file: Path) -> str:
    """Return the SHA-256 of a file."""
    with open(file, "rb") as content:
        return hashlib.file_digest(content, "sha256").hexdigest()
