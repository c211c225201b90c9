"""PDDL files as text, in the encodings that are met: UTF-8 with or without a mark, UTF-16, Latin-1."""

from __future__ import annotations

import codecs
import os

from smash.problem.errors import MalformedFile
from smash.problem.files.documents import read_bytes

_MARKS = ((codecs.BOM_UTF8, "utf-8"), (codecs.BOM_UTF16_LE, "utf-16-le"), (codecs.BOM_UTF16_BE, "utf-16-be"))


def read_text(path: str | os.PathLike[str]) -> str:
    """Return the text of a file, whatever its encoding.

    Raises:
        MalformedFile: where it cannot be read, is too long or is no text.
    """
    return decoded(read_bytes(path, "PDDL files"), os.fspath(path))


def decoded(content: bytes, where: str) -> str:
    """Return the text of bytes. What is neither UTF-8 nor UTF-16 is taken as Latin-1, which every byte belongs to.

    Raises:
        MalformedFile: where it is no text.
    """
    for mark, encoding in _MARKS:
        if content.startswith(mark):
            return _checked(content[len(mark) :], encoding, where)
    if b"\0" in content[:4]:
        return _checked(content, "utf-16-be" if content[:1] == b"\0" else "utf-16-le", where)
    try:
        return _checked(content, "utf-8", where)
    except UnicodeDecodeError:
        return _checked(content, "latin-1", where)


def _checked(content: bytes, encoding: str, where: str) -> str:
    try:
        text = content.decode(encoding)
    except UnicodeDecodeError:
        if encoding == "utf-8":
            raise
        raise MalformedFile(where, f"no text: damaged {encoding.upper()}") from None
    if "\0" in text:
        raise MalformedFile(where, "no text: it holds zero bytes")
    return text
