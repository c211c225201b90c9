"""Lines out of a pipe that anybody may write to: put together as they come, none longer than it may be."""

from __future__ import annotations

LONGEST_LINE = 1 << 26
"""Bytes of the longest line that a run may say: a plan of some million actions."""


class Lines:
    """Puts chunks together to lines."""

    def __init__(self) -> None:
        self._unread: list[bytes] = []
        self._length = 0

    def feed(self, chunk: bytes) -> list[bytes]:
        """Return the lines that a chunk ends, without their ends; one that is too long is cut off there and ended."""
        *ended, rest = chunk.split(b"\n")
        if ended:
            ended[0] = b"".join((*self._unread, ended[0]))
            self._unread, self._length = [], 0
        self._unread.append(rest)
        self._length += len(rest)
        if self._length > LONGEST_LINE:
            ended.append(b"".join(self._unread)[:LONGEST_LINE])
            self._unread, self._length = [], 0
        return ended
