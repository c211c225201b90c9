"""PyBullet's window: whether there is a display for it, and what is seen in it."""

from __future__ import annotations

import ctypes
import ctypes.util
import os
import sys
from collections.abc import Callable
from typing import Any

from smash.execution.scene.marks import slot_marks
from smash.execution.scene.tabletop import Tabletop
from smash.problem.errors import Unsupported


def require_display() -> None:
    """Raise where no window can be opened: PyBullet would end the process without a word.

    Raises:
        Unsupported: without an X display that answers.
    """
    if not sys.platform.startswith("linux"):
        return
    name = os.environ.get("DISPLAY", "")
    library = ctypes.util.find_library("X11")
    if library is None:
        raise Unsupported("no window can be opened: libX11 is not installed")
    x11 = ctypes.CDLL(library)
    x11.XOpenDisplay.restype = ctypes.c_void_p
    x11.XCloseDisplay.argtypes = [ctypes.c_void_p]
    display = x11.XOpenDisplay(name.encode()) if name else None
    if not display:
        raise Unsupported(f"no window can be opened: the display {name!r} (DISPLAY) does not answer")
    x11.XCloseDisplay(display)


def furnish(client: Any, tabletop: Tabletop) -> None:
    """Look at the table from near by, and mark the slots on it."""
    client.configureDebugVisualizer(client.COV_ENABLE_GUI, 0)
    client.resetDebugVisualizerCamera(1.5, 30, -38, [0.0, 0.0, 0.15])
    for slot, half, colour in slot_marks(tabletop):
        shape = client.createVisualShape(client.GEOM_BOX, halfExtents=half, rgbaColor=[*colour, 1])
        turn = client.getQuaternionFromEuler([0, 0, slot.angle])
        client.createMultiBody(0, -1, shape, [slot.x, slot.y, half[2]], turn)


def words_to_stderr() -> Callable[[], None]:
    """Send what libraries print to standard error; the answer undoes it: standard output is for the episode."""
    sys.stdout.flush()
    kept = os.dup(1)
    os.dup2(2, 1)

    def undo() -> None:
        ctypes.CDLL(None).fflush(None)
        os.dup2(kept, 1)
        os.close(kept)

    return undo
