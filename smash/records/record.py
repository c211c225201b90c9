"""What every record is: one JSON object a line, read as a type, and kept as it was read."""

from __future__ import annotations

import json
import math
import re
from functools import cached_property
from typing import Annotated, Any, TypeVar

import msgspec

from smash.problem.files.typed import typed, typed_json
from smash.problem.words import visible

T = TypeVar("T")
Count = Annotated[int, msgspec.Meta(ge=0, le=2**53)]
"""A number that tables can hold exactly."""
Amount = Annotated[float, msgspec.Meta(ge=0, le=1e12)]
Seconds = Amount
_CLOSING = (b"]]]]]]", b"}}}}}}", b"]}]}]}", b"}]}]}]", b"] ] ] ]", b"} } } }")
"""One of these stands in whatever is nested deeply: looked for first, as it is fast."""
_DEEP = re.compile(rb"(?:[\]}]\s*){32}")
"""What ends in so many brackets is no record, and too deep for some of its readers."""
_TOP_LEVEL = msgspec.json.Decoder(dict[str, msgspec.Raw])


class Record(msgspec.Struct, kw_only=True, frozen=True, dict=True):
    """One line of a file of records.

    Within a version of a format fields may be added, so unknown ones are let through and kept in `further`; one that
    goes, or changes what it means, makes a new version. A field that is added is optional: it has a default, which is
    what older records say by their silence.
    """

    @cached_property
    def document(self) -> dict[str, Any]:
        """The record as plain JSON data, with whatever else stood in its line where it was read."""
        line = self.__dict__.get("line")
        made = json.dumps(msgspec.to_builtins(self)) if line is None else line
        document: dict[str, Any] = json.loads(made)
        return document

    @cached_property
    def further(self) -> dict[str, Any]:
        """The fields of its line that this version of the format does not know."""
        line = self.__dict__.get("line")
        names = self.document if line is None else _TOP_LEVEL.decode(line)
        unknown = names.keys() - frozenset(self.__struct_fields__)
        return {name: self.document[name] for name in names if name in unknown} if unknown else {}


R = TypeVar("R", bound=Record)


class Commit(msgspec.Struct, frozen=True):
    """The commit of the code, and whether tracked files were changed; both None outside a repository."""

    hash: str | None
    dirty: bool | None


class Machine(msgspec.Struct, frozen=True):
    """The machine of the process that recorded; memory in MiB."""

    processor: str
    cores: Count | None
    usable_cores: Count | None
    memory_mib: Count
    system: str


def decoded(line: bytes, kind: type[T]) -> T:
    """Return the object of a line of JSON as a type; a record keeps what else stands there.

    Raises:
        msgspec.ValidationError: where it is JSON, and does not fit.
        ValueError: where it is no JSON.
    """
    if any(mark in line for mark in _CLOSING) and _DEEP.search(line):
        raise ValueError("nested too deeply")
    try:
        return _kept(typed_json(line, kind), "line", line)
    except msgspec.DecodeError:
        pass  # what Python writes and strict JSON does not have (lone surrogates), or no record: see below
    document = json.loads(line, parse_float=_finite, parse_constant=_finite)
    return _kept(typed(document, kind), "document", document)


def shown(record: R) -> R:
    """Return a record as tables and pages show it: in names, what cannot be printed is escaped."""
    line = record.__dict__.get("line")
    if line is not None and line.isascii() and b"\\" not in line and b"\x7f" not in line:
        return record
    document = {name: part if name == "log" else _visible(part) for name, part in record.document.items()}
    return record if document == record.document else _kept(typed(document, type(record)), "document", document)


def _finite(text: str) -> float:
    """Return a number of JSON.

    Raises:
        ValueError: where it is none: `NaN`, `Infinity`, or one that is too large.
    """
    number = float(text)
    if not math.isfinite(number):
        raise ValueError(f"{text} is no number of JSON")
    return number


def _kept(made: T, name: str, value: object) -> T:
    if isinstance(made, Record):
        made.__dict__[name] = value
    return made


def _visible(value: Any) -> Any:
    match value:
        case str():
            return visible(value)
        case list():
            return [_visible(part) for part in value]
        case dict():
            return {visible(name): _visible(part) for name, part in value.items()}
    return value
