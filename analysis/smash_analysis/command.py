"""The command line of the modules of tables and figures: `python -m smash_analysis.NAME RESULTS [--out DIR]`."""

from __future__ import annotations

import argparse
import sys
from collections.abc import Callable
from pathlib import Path
from typing import NoReturn

from smash.problem.errors import SmashError
from smash.problem.words import one_line


def fail(error: SmashError) -> NoReturn:
    """End with one line on stderr and the exit code of the error."""
    print(f"smash: {one_line(str(error))}", file=sys.stderr)
    sys.exit(error.exit_code)


def run(
    name: str, about: str | None, make: Callable[[Path, Path], list[Path]], folder: str = "", shown: str = ""
) -> None:
    """Read RESULTS and --out from the command line, make the files and say where they are; without records, say so.

    Args:
        name: of the module.
        about: what `--help` says.
        make: writes the files made of the records in a directory to another; returns them.
        folder: where below RESULTS they go if nothing else is said.
        shown: the file of them that is printed too.
    """
    parser = argparse.ArgumentParser(prog=f"python -m smash_analysis.{name}", description=about)
    parser.add_argument("results", type=Path, help="directory with the records (.jsonl)")
    parser.add_argument("--out", type=Path, help=f"default: {Path('RESULTS', folder)}")
    arguments = parser.parse_args()
    out = arguments.out or arguments.results / folder
    try:
        files = make(arguments.results, out)
    except SmashError as error:
        fail(error)
    if shown:
        print((out / shown).read_text(encoding="utf-8"))
    print("\n".join(str(file) for file in files))
