"""Documents in and out: JSON and TOML read strictly, text written whole or not at all."""

from __future__ import annotations

import json
import os
import re
import tempfile
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
from typing import Any, Literal, get_args, get_origin

import msgspec

from smash.problem.errors import MalformedFile
from smash.problem.files.typed import typed

MOST_BYTES = 16 * 2**20
"""Longest file of those that somebody writes for us: all that is made of it stays well below 1 GB; 10,000 blocks need
1 MB."""


def parse_json(text: str | bytes, where: str) -> Any:
    """Parse one JSON document; a key that stands twice in one object is refused.

    Raises:
        MalformedFile: where the text is no JSON.
    """

    def unique(pairs: list[tuple[str, Any]]) -> dict[str, Any]:
        seen: dict[str, Any] = {}
        for key, value in pairs:
            if key in seen:
                raise MalformedFile(where, f"the key {key!r} stands twice in one object")
            seen[key] = value
        return seen

    try:
        return json.loads(text, object_pairs_hook=unique)
    except UnicodeDecodeError:
        raise MalformedFile(where, "not UTF-8 text") from None
    except RecursionError:
        raise MalformedFile(where, "JSON nested too deeply") from None
    except ValueError as error:
        raise MalformedFile(where, f"not JSON: {error}") from None


def parse_toml(content: bytes, where: str) -> dict[str, Any]:
    """Parse one TOML document.

    Raises:
        MalformedFile: where the content is no TOML.
    """
    import tomllib  # planning reads none: not worth its import at every start

    try:
        return tomllib.loads(content.decode())
    except UnicodeDecodeError:
        raise MalformedFile(where, "not UTF-8 text") from None
    except RecursionError:
        raise MalformedFile(where, "TOML nested too deeply") from None
    except ValueError as error:  # a whole number that Python refuses to read is no TOMLDecodeError
        raise MalformedFile(where, f"not TOML: {error}") from None


def read_bytes(path: str | os.PathLike[str], kind: str | None = None) -> bytes:
    """Return the content of a file.

    Args:
        path: of the file.
        kind: what files of its kind are called, where they have `MOST_BYTES` at most; None: its length is not limited.

    Raises:
        MalformedFile: where it cannot be read, or is too long.
    """
    try:
        with Path(path).open("rb") as file:
            content = file.read(-1 if kind is None else MOST_BYTES + 1)
            if kind is None or len(content) <= MOST_BYTES:
                return content
            size, most = os.fstat(file.fileno()).st_size / 2**20, MOST_BYTES // 2**20
        much = f"{size:.1f} MiB are" if size > most else f"more than {most} MiB are"  # of a device nobody knows it
        raise MalformedFile(os.fspath(path), f"{much} too much; {kind} of up to {most} MiB are read")
    except (OSError, ValueError) as error:
        reason = error.strerror if isinstance(error, OSError) else str(error)
        raise MalformedFile(os.fspath(path), f"cannot be read: {reason}") from None


def read_text(path: str | os.PathLike[str]) -> str:
    """Return the text of a file.

    Raises:
        MalformedFile: where it cannot be read, or is not UTF-8.
    """
    try:
        return read_bytes(path).decode()
    except UnicodeDecodeError:
        raise MalformedFile(os.fspath(path), "not UTF-8 text") from None


def write_text(path: str | os.PathLike[str], text: str) -> None:
    """Write a file whole or not at all (a temporary file beside it, then a rename).

    Raises:
        MalformedFile: where it cannot be written.
    """
    target = Path(path)
    if not target.exists() or target.is_file():
        with replacing(target) as temporary:
            temporary.write_text(text, encoding="utf-8")
        return
    try:  # /dev/stdout, a pipe: nothing to rename
        target.write_text(text, encoding="utf-8")
    except OSError as error:
        raise MalformedFile(os.fspath(path), f"cannot be written: {error.strerror}") from None


def require_writable(*paths: Path | None) -> None:
    """Refuse files that could not be written before long work begins; None stands for no file.

    Raises:
        MalformedFile: about the first that is a directory, is asked for twice, or whose directory is missing or closed.
    """
    asked = [path for path in paths if path is not None]
    for number, path in enumerate(asked):
        if path.is_dir():
            raise MalformedFile(str(path), "cannot be written: it is a directory")
        if path in asked[:number]:
            raise MalformedFile(str(path), "cannot be written: it is asked for twice")
        if not path.exists() or path.is_file():
            try:
                tempfile.TemporaryFile(dir=path.parent).close()
            except OSError:
                raise MalformedFile(str(path), "cannot be written: its directory is missing or closed") from None


@contextmanager
def replacing(path: Path) -> Iterator[Path]:
    """A name beside `path`, with its ending, for what shall be there whole or not at all.

    Raises:
        MalformedFile: where it cannot be written.
    """
    temporary = path.with_name(f".{os.getpid()}.part.{path.name}")
    try:
        yield temporary
        temporary.replace(path)
    except OSError as error:
        raise MalformedFile(os.fspath(path), f"cannot be written: {error.strerror or error}") from None
    finally:
        temporary.unlink(missing_ok=True)


def convert(document: Any, kind: Any, where: str) -> Any:
    """Check a parsed document against a msgspec type; one-line `MalformedFile` where it does not fit.

    Raises:
        MalformedFile: with the place and, for an unknown key, the allowed ones.
    """
    try:
        return typed(document, kind)
    except UnicodeEncodeError:
        raise MalformedFile(where, "a key is no Unicode text (half of a surrogate pair)") from None
    except RecursionError:
        raise MalformedFile(where, "nested too deeply") from None
    except msgspec.ValidationError as error:
        message = str(error).replace("`$.", "`").removeprefix("Object contains ")
        message = message.replace("Object missing", "missing")
        allowed = _allowed(message, kind)
        raise MalformedFile(where, message + (f"; allowed: {', '.join(allowed)}" if allowed else "")) from None


def _allowed(message: str, kind: Any) -> list[str]:
    """Return the keys, or the words, that are allowed where msgspec found another one; none where it says so itself."""
    path = re.findall(r"\w+", message.split(" - at ")[1]) if " - at " in message else []
    for name in path:
        if not name.isdigit():
            kind = next((f.type for f in _fields(kind) if f.encode_name == name), None)
    if message.startswith("unknown field"):
        return [field.encode_name for field in _fields(kind)]
    return [str(word) for word in _words(kind)] if message.startswith("Invalid enum value") else []


def _fields(kind: Any) -> tuple[msgspec.structs.FieldInfo, ...]:
    """Return the fields of the one struct that a type is made of."""
    if isinstance(kind, type) and issubclass(kind, msgspec.Struct):
        return msgspec.structs.fields(kind)
    return next((found for part in get_args(kind) if (found := _fields(part))), ())


def _words(kind: Any) -> tuple[Any, ...]:
    """Return the values of the one `Literal` that a type is made of."""
    if get_origin(kind) is Literal:
        return get_args(kind)
    return next((found for part in get_args(kind) if (found := _words(part))), ())


def check_format(document: Any, where: str, *wanted: str) -> None:
    """Refuse a document that does not say one of the wanted `format`s.

    Raises:
        MalformedFile: where it says another one or none.
    """
    if not isinstance(document, dict):
        raise MalformedFile(where, f"not a JSON object; a {wanted[0]} file is one")
    found = document.get("format")
    if found not in wanted:
        allowed = f"{wanted[0]!r} is" if len(wanted) == 1 else f"{' and '.join(map(repr, wanted))} are"
        raise MalformedFile(where, f"`format`: {found!r} is not allowed; {allowed}")


def one_key_a_line(document: Mapping[str, Any]) -> str:
    """Return the JSON text of a document, one key a line."""
    lines = [f" {json.dumps(key)}: {json.dumps(value)}" for key, value in document.items()]
    return "{\n" + ",\n".join(lines) + "\n}\n"
