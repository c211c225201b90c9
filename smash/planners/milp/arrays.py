"""A mixed-integer linear program as arrays: built here, looked at or written to a file, and only then solved.

`highs.solve` and `gurobi.solve` take the same `Milp` and give the same `MilpResult`.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from time import perf_counter
from typing import Any, Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

MilpStatus = Literal["optimal", "feasible", "infeasible", "unknown"]
"""`optimal` and `infeasible` are the solver's proofs about the model, not about the instance behind it."""

OnSolution = Callable[[float, float, Floats], None]
"""`on_solution(seconds, objective, vector)`: called with each better solution; seconds since the solve began."""


@dataclass(frozen=True, slots=True)
class SparseRows:
    """A matrix in compressed rows, as solvers take it: columns ascend within a row, no place has two entries.

    Row r has the entries `indptr[r]` to `indptr[r + 1]` of `indices` (their columns) and `data` (their values).
    Shapes: `indptr`: (m + 1,); `indices`, `data`: (k,). Kept here because nothing else in planning needs SciPy.
    """

    indptr: NDArray[np.int32]
    indices: NDArray[np.int32]
    data: Floats

    @classmethod
    def of_entries(cls, rows: Ints, columns: Ints, values: Floats, shape: tuple[int, int]) -> SparseRows:
        """Return the matrix of `shape` (m, n) with the given entries, each of shape (k,); those at one place add up."""
        place = rows * shape[1] + columns
        order = np.argsort(place, kind="stable")
        place = place[order]
        first = np.flatnonzero(np.diff(place, prepend=-1))
        kept = order[first]
        return cls(
            indptr=np.concatenate([[0], np.bincount(rows[kept], minlength=shape[0]).cumsum()]).astype(np.int32),
            indices=columns[kept].astype(np.int32),
            data=np.add.reduceat(values[order], first) if len(first) else np.zeros(0),
        )

    @property
    def nnz(self) -> int:
        """Number of entries k."""
        return len(self.data)

    def __matmul__(self, vector: Floats) -> Floats:
        """Return the product with `vector` (shape (n,)), shape (m,)."""
        rows = np.repeat(np.arange(len(self.indptr) - 1), np.diff(self.indptr))
        return np.bincount(rows, weights=self.data * vector[self.indices], minlength=len(self.indptr) - 1).astype(float)


@dataclass(frozen=True, slots=True)
class Milp:
    """Minimise `objective @ x` under `row_lower <= matrix @ x <= row_upper` and `lower <= x <= upper`.

    Shapes: n columns, m rows; `objective`, `lower`, `upper`: (n,) floats; `integral`: (n,) bools;
    `matrix`: (m, n); `row_lower`, `row_upper`: (m,) floats, infinite where a side is free.
    `name` says what a column means, for files and for people.
    """

    objective: Floats
    lower: Floats
    upper: Floats
    integral: NDArray[np.bool_]
    matrix: SparseRows
    row_lower: Floats
    row_upper: Floats
    name: Callable[[int], str] = str

    @property
    def columns(self) -> int:
        """Number of variables n."""
        return len(self.objective)

    @property
    def rows(self) -> int:
        """Number of constraints m."""
        return len(self.row_lower)

    def size(self) -> dict[str, int]:
        """Return the counts of columns, integer columns, rows and non-zeros."""
        return {
            "columns": self.columns,
            "integer_columns": int(self.integral.sum()),
            "rows": self.rows,
            "nonzeros": self.matrix.nnz,
        }

    def violation(self, vector: Floats) -> float:
        """Return the largest violation of a row or a bound at `vector` (shape (n,)); 0 where it is feasible."""
        activity = self.matrix @ vector
        gaps = [self.row_lower - activity, activity - self.row_upper, self.lower - vector, vector - self.upper]
        return max(0.0, *(float(gap.max(initial=0.0)) for gap in gaps))


@dataclass(frozen=True, slots=True)
class MilpResult:
    """What a solver proved and found. `bound` is its dual bound on the objective, -inf where it has none."""

    status: MilpStatus
    objective: float | None
    bound: float
    vector: Floats | None
    seconds: float
    nodes: int


class OutOfTime(Exception):
    """A builder's deadline has passed."""


@dataclass(slots=True)
class MilpBuilder:
    """Collects columns and rows in blocks of arrays; `build` makes the `Milp`.

    Past `deadline` [s, clock of `perf_counter`] adding rows and `build` raise `OutOfTime`: every loop that makes a
    model adds rows, so that none of them runs on.
    """

    deadline: float = math.inf
    _costs: list[Floats] = field(default_factory=list)
    _lower: list[Floats] = field(default_factory=list)
    _upper: list[Floats] = field(default_factory=list)
    _integral: list[NDArray[np.bool_]] = field(default_factory=list)
    _columns: int = 0
    _entries: list[tuple[Ints, Ints, Floats]] = field(default_factory=list)
    _row_lower: list[Floats] = field(default_factory=list)
    _row_upper: list[Floats] = field(default_factory=list)
    _rows: int = 0

    @property
    def columns(self) -> int:
        """Number of columns so far."""
        return self._columns

    def costs(self) -> Floats:
        """Return the objective so far, shape (columns,)."""
        return _joined(self._costs)

    def add_columns(
        self,
        count: int,
        *,
        cost: ArrayLike = 0.0,
        lower: ArrayLike = 0.0,
        upper: ArrayLike = 1.0,
        integral: bool = True,
    ) -> Ints:
        """Append `count` columns (binaries by default) and return their indices, shape (count,)."""
        for store, value in ((self._costs, cost), (self._lower, lower), (self._upper, upper)):
            store.append(np.broadcast_to(np.asarray(value, dtype=float), (count,)))
        self._integral.append(np.full(count, integral))
        indices = np.arange(self._columns, self._columns + count)
        self._columns += count
        return indices

    def add_rows(
        self,
        rows: ArrayLike,
        columns: ArrayLike,
        values: ArrayLike,
        *,
        count: int,
        lower: ArrayLike = -np.inf,
        upper: ArrayLike = np.inf,
    ) -> None:
        """Append `count` rows by their entries.

        Args:
            rows: row of each entry, counted from 0 within this block; shape (k,).
            columns: column of each entry; shape (k,). Entries at one place add up.
            values: coefficient of each entry, or one for all.
            count: number of rows.
            lower: lower sides, shape (count,) or one for all.
            upper: upper sides, shape (count,) or one for all.

        Raises:
            OutOfTime: where the deadline has passed.
        """
        self._check_time()
        at = np.asarray(rows, dtype=np.int64).ravel()
        where = np.asarray(columns, dtype=np.int64).ravel()
        self._entries.append((at + self._rows, where, np.broadcast_to(np.asarray(values, dtype=float), at.shape)))
        self._row_lower.append(np.broadcast_to(np.asarray(lower, dtype=float), (count,)))
        self._row_upper.append(np.broadcast_to(np.asarray(upper, dtype=float), (count,)))
        self._rows += count

    def add_row(self, columns: ArrayLike, values: ArrayLike, *, lower: float = -np.inf, upper: float = np.inf) -> None:
        """Append one row."""
        where = np.asarray(columns, dtype=np.int64).ravel()
        self.add_rows(np.zeros(len(where)), where, values, count=1, lower=lower, upper=upper)

    def add_sums(
        self, terms: Sequence[tuple[Ints, float]], *, lower: ArrayLike = -np.inf, upper: ArrayLike = np.inf
    ) -> None:
        """Append rows that sum arrays of columns: row r is the sum over the terms of `value * columns[r]`.

        Args:
            terms: arrays of columns, each of shape (rows, ...), with their value; columns of -1 are left out.
            lower: lower sides, shape (rows,) or one for all.
            upper: upper sides, shape (rows,) or one for all.

        Raises:
            OutOfTime: where the deadline has passed.
        """
        count = terms[0][0].shape[0]
        if not count:
            return
        rows, columns, values = [], [], []
        for block, value in terms:
            flat = block.reshape(count, math.prod(block.shape[1:]))
            index = np.broadcast_to(np.arange(count)[:, None], flat.shape)
            there = flat >= 0
            rows.append(index[there])
            columns.append(flat[there])
            values.append(np.full(int(there.sum()), value))
        self.add_rows(
            np.concatenate(rows),
            np.concatenate(columns),
            np.concatenate(values),
            count=count,
            lower=lower,
            upper=upper,
        )

    def build(self, name: Callable[[int], str] = str) -> Milp:
        """Return the model.

        Raises:
            OutOfTime: where the deadline has passed.
        """
        self._check_time()
        rows, columns, values = (_joined([entry[part] for entry in self._entries]) for part in range(3))
        shape = (self._rows, self._columns)
        matrix = SparseRows.of_entries(rows.astype(np.int64), columns.astype(np.int64), values, shape)
        return Milp(
            objective=_joined(self._costs),
            lower=_joined(self._lower),
            upper=_joined(self._upper),
            integral=np.concatenate(self._integral) if self._integral else np.zeros(0, dtype=bool),
            matrix=matrix,
            row_lower=_joined(self._row_lower),
            row_upper=_joined(self._row_upper),
            name=name,
        )

    def _check_time(self) -> None:
        if perf_counter() > self.deadline:
            raise OutOfTime


def _joined(parts: list[Any]) -> Floats:
    return np.concatenate(parts).astype(float) if parts else np.zeros(0)
