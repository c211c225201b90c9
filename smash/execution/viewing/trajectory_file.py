"""The joint trajectory of an episode as a CSV file: `smash execute --trajectory FILE`.

One row per sample: `time` [s] from the beginning of the episode, the arm's joints [rad] by the names of the URDF,
`finger_opening` [m], how far each finger is sent from the middle. Rows follow one another at even steps, also while the
arm stands still.
Numbers are written in full, so that a file read back holds the same values bit for bit.
"""

from __future__ import annotations

import csv
import os
from collections.abc import Iterable, Iterator, Sequence
from pathlib import Path
from typing import Any, TypeVar

import numpy as np
from numpy.typing import NDArray

from smash.problem.errors import MalformedFile

FIRST, LAST = "time", "finger_opening"
"""Of the columns; between them stand the arm's joints."""

Sample = tuple[float, NDArray[np.float64], float]
"""A moment [s], what the arm was sent to [rad], shape (n,), and the fingers [m from the middle]."""
Row = TypeVar("Row", bound=tuple[Any, ...])

TRAJECTORY_INTERVAL = 0.01
"""Time between two rows of an exported trajectory [s]."""


def thinned(rows: Iterable[Row]) -> Iterator[Row]:
    """Leave out rows that follow another one too closely; the first entry of each is its time [s]."""
    due = float("-inf")
    for row in rows:
        moment = row[0]
        if moment >= due:
            yield row
            due = moment + TRAJECTORY_INTERVAL - 1e-6


def write_trajectory(path: str | os.PathLike[str], joints: Sequence[str], samples: Iterable[Sample]) -> None:
    """Write commanded joint positions with their times.

    Args:
        path: The file; it is overwritten.
        joints: Names of the arm's joints, n of them.
        samples: Time [s], joints [rad], shape (n,), and opening [m], in the order of time.
    """
    with Path(path).open("w", newline="", encoding="ascii") as stream:
        writer = csv.writer(stream, lineterminator="\n")
        writer.writerow((FIRST, *joints, LAST))
        for time, sent, opening in samples:
            writer.writerow([repr(float(value)) for value in (time, *sent, opening)])


def read_trajectory(
    path: str | os.PathLike[str],
) -> tuple[NDArray[np.float64], NDArray[np.float64], NDArray[np.float64]]:
    """Times [s], shape (N,), joints [rad], shape (N, n), and openings [m], shape (N,), of a file written here.

    Raises:
        MalformedFile: The header is another, or a row is not as many numbers.
    """
    lines = Path(path).read_text(encoding="utf-8").splitlines()
    header = lines[0].split(",") if lines else []
    if len(header) < 3 or (header[0], header[-1]) != (FIRST, LAST):
        raise MalformedFile(os.fspath(path), f"the first line must be {FIRST}, the arm's joints, {LAST}")
    rows = np.empty((len(lines) - 1, len(header)))
    for number, line in enumerate(lines[1:]):
        try:
            rows[number] = np.array(line.split(",", len(header)), dtype=np.float64).reshape(len(header))
        except ValueError:
            problem = f"line {number + 2}: {len(header)} numbers separated by commas are allowed"
            raise MalformedFile(os.fspath(path), problem) from None
    return rows[:, 0], rows[:, 1:-1], rows[:, -1]
