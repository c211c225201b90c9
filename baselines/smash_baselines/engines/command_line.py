"""The command line of a planner outside: taken apart as a shell would, run without one."""

from __future__ import annotations

import os
import shlex
import shutil
import sys
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

from smash.problem.errors import SmashError, Unsupported

DOMAIN, PROBLEM, PLAN = "{domain}", "{problem}", "{plan}"
PLACES = (DOMAIN, PROBLEM, PLAN)
"""What stands for the files that a program is handed, and for the one that it is to write."""


@dataclass(frozen=True, slots=True)
class CommandLine:
    """A program and its arguments, with places for files.

    Attributes:
        words: the program, then its arguments.
    """

    words: tuple[str, ...]

    @classmethod
    def parse(cls, text: str) -> CommandLine:
        """Take a command line apart; quotes are those of a shell, nothing else of one means anything.

        Raises:
            SmashError: where it is none, or hands over no problem.
        """
        try:
            words = tuple(shlex.split(text))
        except ValueError as error:
            raise SmashError(f"--command: {error} in {text!r}") from None
        if not words or words[0] in PLACES:
            raise SmashError(f"--command: {text!r} names no program")
        if not any(PROBLEM in word for word in words):
            example = "'PLANNER {domain} {problem} {plan}'"
            raise SmashError(f"--command: {text!r} has no place for the {PROBLEM}; {example} is an example")
        return cls(words)

    @property
    def writes_plan(self) -> bool:
        """Whether the program is told where to write its plan."""
        return any(PLAN in word for word in self.words)

    def missing(self) -> str | None:
        """Return that the program is not there, or None."""
        return None if self._program() is not None else f"no program {self.words[0]!r} on the PATH"

    def filled(self, files: Mapping[str, Path]) -> list[str]:
        """Return the program and its arguments, to be run in any folder.

        A relative path of a file is one of the folder where this process works.

        Args:
            files: the file of each place.

        Raises:
            Unsupported: where the program is not there.
        """
        program = self._program()
        if program is None:
            raise Unsupported(f"not installed: {self.missing()}")
        return [program, *(_filled(word, files) for word in self.words[1:])]

    def _program(self) -> str | None:
        """Return the path of the program: on the PATH, or beside the Python that runs this."""
        beside = os.pathsep.join([os.environ.get("PATH", os.defpath), os.path.dirname(sys.executable)])
        found = shutil.which(self.words[0], path=beside)
        return None if found is None else os.path.abspath(found)


def _filled(word: str, files: Mapping[str, Path]) -> str:
    filled = word
    for place, file in files.items():
        filled = filled.replace(place, str(file))
    return os.path.abspath(word) if filled == word and os.path.isfile(word) else filled
