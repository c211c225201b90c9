"""What every record is: one JSON object a line, read as a type, and kept as it was read."""

from __future__ import annotations

import json
from functools import cached_property
from typing import Any, TypeVar

import msgspec

T = TypeVar("T")
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
        return {name: self.document[name] for name in names if name not in self.__struct_fields__}


class Commit(msgspec.Struct, frozen=True):
    """The commit of the code, and whether tracked files were changed; both None outside a repository."""

    hash: str | None
    dirty: bool | None


class Machine(msgspec.Struct, frozen=True):
    """The machine of the process that recorded; memory in MiB."""

    processor: str
    cores: int | None
    usable_cores: int | None
    memory_mib: int
    system: str


def decoded(line: bytes, kind: type[T], escaped: bool = False) -> T:
    """Return the object of a line of JSON as a type; a record keeps what else stands there.

    Args:
        line: the text.
        kind: the type.
        escaped: whether names that are no Unicode text (a lone surrogate, which JSON allows and a table does not) are
            escaped.

    Raises:
        msgspec.ValidationError: where it is JSON, and does not fit.
        ValueError: where it is no JSON.
    """
    odd = escaped and b"\\ud" in line.lower()
    if not odd:
        try:
            return _kept(msgspec.json.decode(line, type=kind), "line", line)
        except msgspec.DecodeError:
            pass  # what Python writes and strict JSON does not have (lone surrogates, NaN), or no record: see below
    document = json.loads(line)
    if odd:
        document = _encodable(document)
    return _kept(msgspec.convert(document, kind), "document", document)


def _kept(made: T, name: str, value: object) -> T:
    if isinstance(made, Record):
        made.__dict__[name] = value
    return made


def _encodable(value: Any) -> Any:
    match value:
        case str():
            return value.encode(errors="backslashreplace").decode()
        case list():
            return [_encodable(part) for part in value]
        case dict():
            return {_encodable(name): _encodable(part) for name, part in value.items()}
    return value
