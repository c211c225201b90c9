"""Files of JSON lines that a kill may cut off in their last line."""

from __future__ import annotations

import os
from collections.abc import Callable
from pathlib import Path


def set_damaged_aside(path: Path, whole: Callable[[bytes], bool]) -> bool:
    """Move a last line that is not whole from `NAME.jsonl` to `NAME.damaged`.

    Args:
        path: the file; it need not be there.
        whole: whether a line, its end included, is what the file is made of.

    Returns:
        Whether there was such a line.
    """
    if not path.is_file():
        return False
    content = path.read_bytes()
    end = content.rstrip(b"\n").rfind(b"\n") + 1
    last = content[end:]
    if not last or (last.endswith(b"\n") and whole(last)):
        return False
    with open(path.with_suffix(".damaged"), "ab") as aside:
        aside.write(last.rstrip(b"\n") + b"\n")
    os.truncate(path, end)
    return True
