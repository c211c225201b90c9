"""Arguments of functions that users call: what is wrong with one is a line, as what is wrong with a file is."""

from __future__ import annotations

import os

from smash.problem.errors import SmashError


def whole_number(what: str, given: object, least: int, most: int | None = None) -> int:
    """Return a whole number.

    Args:
        what: the argument's name.
        given: what stands for it.
        least: the least that is allowed.
        most: the most that is allowed; None: no limit.

    Raises:
        SmashError: where it is none, or out of these limits.
    """
    fits = isinstance(given, int) and not isinstance(given, bool) and given >= least
    if not fits or (most is not None and isinstance(given, int) and given > most):
        allowed = f"whole numbers, {least} and more" if most is None else f"whole numbers, {least} to {most}"
        raise SmashError(f"{what}: {given!r} is not allowed; {allowed}")
    assert isinstance(given, int)
    return given


def truth(what: str, given: object) -> bool:
    """Return True or False.

    Raises:
        SmashError: where it is neither.
    """
    if not isinstance(given, bool):
        raise SmashError(f"{what}: {given!r} is not allowed; True or False")
    return given


def text(what: str, given: object) -> str:
    """Return a string.

    Raises:
        SmashError: where it is none.
    """
    if not isinstance(given, str):
        raise SmashError(f"{what}: {given!r} is not allowed; a string is")
    return given


def path(given: object) -> str:
    """Return a path as a string.

    Raises:
        SmashError: where it is no path.
    """
    if not isinstance(given, str | os.PathLike):
        raise SmashError(f"{given!r} is no path of a file")
    return str(os.fspath(given))
