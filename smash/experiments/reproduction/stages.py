"""The stages of a reproduction: a short TOML file, and what each stage's products are made from.

A stage's commands are words, not shell: the first is `smash` or `python`, `{out}` is the directory of the products and
`{here}` that of the file. A stage writes into `{out}/NAME` alone.
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

from smash.experiments.environment import versions
from smash.experiments.reproduction.code import code_hash, rooms_of
from smash.planners.registry import DEFAULT
from smash.problem.errors import MalformedFile
from smash.problem.files.documents import convert, parse_toml, read_bytes

PROGRAMS = {"smash": (sys.executable, "-m", "smash"), "python": (sys.executable,)}
OR = " or "
"""Between packages of which one is enough."""
PACKAGES = ("coal", "matplotlib", "mujoco", "ompl", "pandas", "pin", "pybullet", "toppra")
"""Distributions that decide what is made, beside those that decide what a planner answers."""


class Stage(msgspec.Struct, forbid_unknown_fields=True, frozen=True):
    """One `[[steps]]` table.

    `minutes` is the estimated time on 2 quiet cores; `products` are patterns below `{out}`, each of which must be met;
    `after` names earlier stages whose products it uses, as far as there are any; `requires` packages without which it
    is not run (`a or b`: without either); `leaves_out` says what of the whole it does not do, and why; `not_copied` are
    products that are too large for `--copy-to`.
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
        """Return the files beside the file of stages that the commands name."""
        words = [word for command in self.commands for word in shlex.split(command)]
        named = [here / word.removeprefix("{here}/") for word in words if word.startswith("{here}/")]
        return sorted({file for file in named if file.is_file()})

    def lacking(self) -> list[str]:
        """Return the required packages that are not installed."""
        return [words for words in self.requires if not any(map(_installed, words.split(OR)))]


class Stages(msgspec.Struct, forbid_unknown_fields=True, frozen=True):
    """A file of stages."""

    name: str
    about: str
    stages: list[Stage] = msgspec.field(name="steps")


class MadeFrom(msgspec.Struct, frozen=True):
    """Whatever decides a stage's products: hashes of its inputs and of its code, versions of the packages."""

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


def read_stages(path: Path) -> Stages:
    """Read a file of stages.

    Raises:
        MalformedFile: with one line that says where and what is allowed.
    """
    where = os.fspath(path)
    stages = cast(Stages, convert(parse_toml(read_bytes(path), where), Stages, where))
    _check(stages, where)
    return stages


def _check(stages: Stages, where: str) -> None:
    def expect(holds: bool, part: str, problem: str) -> None:
        if not holds:
            raise MalformedFile(where, f"`{part}`: {problem}")

    plain = re.compile(r"[A-Za-z0-9][A-Za-z0-9._-]*")
    expect(plain.fullmatch(stages.name) is not None, "name", f"{stages.name!r} is no plain file name")
    expect(bool(stages.stages), "steps", "empty; at least one is needed")
    before: list[str] = []
    for index, stage in enumerate(stages.stages):
        at = f"steps[{index}]"
        fits = plain.fullmatch(stage.name) is not None and stage.name not in RESERVED
        expect(fits, f"{at}.name", f"{stage.name!r} is no plain folder name, or one of {', '.join(RESERVED)}")
        expect(stage.name not in before, f"{at}.name", f"{stage.name!r} stands twice")
        expect(stage.minutes > 0, f"{at}.minutes", f"{stage.minutes} is not allowed; above 0")
        expect(bool(stage.commands), f"{at}.commands", "empty; at least one is needed")
        for command in stage.commands:
            problem = _problem(command)
            expect(not problem, f"{at}.commands", problem)
        expect(bool(stage.products), f"{at}.products", "empty; at least one is needed")
        for product in stage.products:
            inside = product.startswith(f"{stage.name}/") and ".." not in Path(product).parts
            expect(inside, f"{at}.products", f"{product!r} does not lie in the stage's folder {stage.name}/")
        for name in stage.after:
            expect(name in before, f"{at}.after", f"{name!r} is no earlier stage; there are: {', '.join(before)}")
        before.append(stage.name)


RESERVED = ("logs", "records", "manifest.json", "MANIFEST.md")
"""Names in the directory of a reproduction that are not a stage's."""


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


def made_from(stage: Stage, here: Path, uses: dict[str, str]) -> MadeFrom:
    """Return what the stage would be made from now; `uses` has a hash of the products of each stage that it uses."""
    inputs = {file.name: file_hash(file) for file in stage.inputs(here)}
    packages = versions(DEFAULT) | {name: version(name) for name in PACKAGES if _installed(name)}
    return MadeFrom(list(stage.commands), code_hash(rooms_of(stage.commands)), packages, inputs, uses)


def file_hash(file: Path) -> str:
    """Return the SHA-256 of a file."""
    with open(file, "rb") as content:
        return hashlib.file_digest(content, "sha256").hexdigest()
