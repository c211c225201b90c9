"""How fast a spline can be followed: the two passes of TOPP-RA, and the motion of constant accelerations between them.

The linear programs are toppra's, which are compiled; the passes over its grid are made here. They give what toppra's
own classes give, to the last bit, in a third of the time: those look for solvers that are not installed whenever one of
them is made, and evaluate one moment after another (Pham & Pham, A New Approach to Time-Optimal Path Parameterization
Based on Reachability Analysis, 2018, algorithm 1).
"""

from __future__ import annotations

from collections.abc import Sequence
from math import inf, isnan, nan
from math import pow as power
from typing import Any

import numpy as np
from numpy.typing import NDArray

TINY, SMALL = 1e-8, 1e-5
"""What counts as a rounding error of a squared speed, in a step and at the start."""
RETRIES = 10
"""So often in a row a step of the forward pass is tried again, a little slower."""


class Parameterized:
    """A spline followed from rest to rest, each interval of a grid at one acceleration along it.

    Args:
        spline: Positions [rad] over the way along the path: called with ways of shape (T,) and the order of the
            derivative, it answers in shape (T, n).
        grid: Ways along the path, rising, shape (N + 1,).
        squares: Squared speeds along it at these, shape (N + 1,).
    """

    def __init__(self, spline: Any, grid: NDArray[np.float64], squares: NDArray[np.float64]) -> None:
        self._spline = spline
        self._grid = grid
        self._speeds = np.sqrt(squares)
        ways = np.diff(grid)
        # The squares of the roots, not what the roots were taken of: their last bits are toppra's.
        self._rises = 0.5 * np.diff(self._speeds**2) / ways
        self._times = np.append(0.0, np.cumsum(2 * ways / (self._speeds[:-1] + self._speeds[1:])))

    @property
    def duration(self) -> float:
        """[s]."""
        return float(self._times[-1])

    def at(self, times: NDArray[np.float64]) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Positions [rad] and velocities [rad/s] at `times` [s], shape (T,), within the duration: (T, n) each."""
        index = np.minimum(np.searchsorted(self._times, times, side="right") - 1, len(self._rises) - 1)
        since, rises, speeds = times - self._times[index], self._rises[index], self._speeds[index]
        # The C library's power, as of single numbers: it is not always the rounded product.
        square = np.array([power(moment, 2) for moment in since.tolist()])
        ways = self._grid[index] + since * speeds + 0.5 * square * rises
        return self._spline(ways), self._spline(ways, 1) * (speeds + since * rises)[:, None]


def parameterized(spline: Any, grid: NDArray[np.float64], constraints: Sequence[Any]) -> Parameterized | None:
    """The fastest such motion that keeps the constraints, or None where there is none.

    Args:
        spline: A toppra path.
        grid: From its beginning to its end, rising, shape (N + 1,).
        constraints: Of toppra, linear ones.
    """
    # toppra loads a plotting library: a second that `smash plan` must not pay.
    from toppra.solverwrapper.cy_seidel_solverwrapper import seidelWrapper

    solver = seidelWrapper(constraints, spline, grid, solve_lp1d=True)
    controllable = _backward(solver, len(grid) - 1)
    squares = None if controllable is None else _forward(solver, np.diff(grid).tolist(), controllable)
    return None if squares is None else Parameterized(spline, grid, np.array(squares))


def _backward(solver: Any, count: int) -> list[tuple[float, float]] | None:
    """The least and the greatest squared speed at each grid point from which the end can be reached at rest."""
    slowest, fastest = np.array([-1e-9, 1.0]), np.array([1e-9, -1.0])
    controllable = [(0.0, 0.0)]
    for stage in range(count - 1, -1, -1):
        least_then, greatest_then = controllable[-1]
        greatest = float(solver.solve_stagewise_optim(stage, None, fastest, nan, nan, least_then, greatest_then)[1])
        least = float(solver.solve_stagewise_optim(stage, None, slowest, nan, nan, least_then, greatest_then)[1])
        if isnan(least) or isnan(greatest):
            return None
        controllable.append((0.0 if least < 0.0 else least, greatest))
    return controllable[::-1]


def _forward(solver: Any, ways: Sequence[float], controllable: Sequence[tuple[float, float]]) -> list[float] | None:
    """The greatest squared speed at each grid point, from rest."""
    if controllable[0][0] > SMALL or controllable[0][1] < -SMALL:
        return None
    squares, objective, tries = [0.0], np.array([-inf, -1.0]), 0
    while len(squares) <= len(ways):
        stage, now = len(squares) - 1, squares[-1]
        least, greatest = controllable[stage + 1]
        objective[0] = -2 * ways[stage]
        rise = float(solver.solve_stagewise_optim(stage, None, objective, now, now, least, greatest)[0])
        if not isnan(rise):
            then = now + 2 * ways[stage] * rise
            squares.append(min(greatest, max(least, then - TINY, 0.9999 * then)))
            tries = 0
        elif tries < RETRIES:
            squares[-1], tries = max(now - TINY, 0.999 * now), tries + 1
        else:
            return None
    return squares
