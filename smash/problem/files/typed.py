"""Parsed data as typed objects, by msgspec, whatever thread asks.

msgspec prepares a type when it is first decoded, and fills in what it knows of it piece by piece: a second thread that
decodes the same type meanwhile reads what is not there yet, and the process ends with a segmentation fault. So nobody
decodes but here, one thread at a time. That costs nothing: msgspec holds the interpreter all along.
"""

from __future__ import annotations

import os
from threading import RLock
from typing import Any, TypeVar, overload

import msgspec

T = TypeVar("T")
_TURN = RLock()


def _anew() -> None:
    """A process that was forked while another thread decoded would wait for that thread, which it has not."""
    global _TURN
    _TURN = RLock()


if hasattr(os, "register_at_fork"):
    os.register_at_fork(after_in_child=_anew)


@overload
def typed(document: Any, kind: type[T], *, strict: bool = True) -> T: ...


@overload
def typed(document: Any, kind: Any, *, strict: bool = True) -> Any: ...


def typed(document: Any, kind: Any, *, strict: bool = True) -> Any:
    """Return parsed data as a type.

    Args:
        document: of dicts, lists, strings, numbers.
        kind: a type that msgspec knows.
        strict: whether a string is no number.

    Raises:
        msgspec.ValidationError: where it does not fit.
    """
    with _TURN:
        return msgspec.convert(document, kind, strict=strict)


def typed_json(text: bytes | str, kind: type[T]) -> T:
    """Return JSON text as a type.

    Raises:
        msgspec.ValidationError: where it is JSON, and does not fit.
        msgspec.DecodeError: where it is no JSON.
    """
    with _TURN:
        return msgspec.json.decode(text, type=kind)
