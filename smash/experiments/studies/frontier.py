"""What buffers buy: the exact cost of an instance against its number of buffers, with and without topple."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import asdict, dataclass
from time import perf_counter, process_time
from typing import Any

from smash.planners.protocol import Planner, Settings, ask
from smash.problem.buffers import with_buffers
from smash.problem.model import Instance, PlanOptions
from smash.problem.problem import Problem


@dataclass(frozen=True, slots=True)
class FrontierPoint:
    """One solve. `cost` and `lower_bound` are None where there is no plan, or no proof.

    Attributes:
        seconds: Wall time [s]; `cpu_seconds` is what this process computed in it, which other work does not lengthen.
    """

    instance: str
    blocks: int
    buffers: int
    topple: bool
    max_topple: int | None
    status: str
    cost: int | None
    lower_bound: int | None
    bound_origin: str | None
    seconds: float
    cpu_seconds: float

    def row(self) -> dict[str, Any]:
        """Return the point as a row of a table."""
        return asdict(self)


def frontier(
    instance: Instance, planner: Planner, most: int, budget: float, max_topple: int | None = None
) -> Iterator[FrontierPoint]:
    """Solve `instance` with 0 to `most` buffers, without and with topple.

    Counts below the number of buffers that hold blocks at the start are left out.

    Args:
        instance: the problem.
        planner: what solves it; one that proves optima makes the cost exact.
        most: the largest number of buffers.
        budget: of one solve [s].
        max_topple: the most blocks of one topple.
    """
    held = sum(1 for buffer in instance.buffers if instance.start[buffer])
    for buffers in range(held, most + 1):
        for topple in (False, True):
            started, computed = perf_counter(), process_time()
            problem = Problem(with_buffers(instance, buffers), PlanOptions(topple, max_topple if topple else None))
            result = ask(planner, problem, Settings(), budget)
            yield FrontierPoint(
                instance=instance.name,
                blocks=len(instance.blocks),
                buffers=buffers,
                topple=topple,
                max_topple=problem.options.max_topple,
                status=result.status,
                cost=result.cost,
                lower_bound=result.lower_bound,
                bound_origin=result.bound_origin,
                seconds=round(perf_counter() - started, 4),
                cpu_seconds=round(process_time() - computed, 4),
            )


def fewest_buffers(points: Iterable[FrontierPoint], topple: bool) -> dict[int, int]:
    """Return the costs on the frontier of one instance, each with the fewest buffers that reach it."""
    fewest: dict[int, int] = {}
    for point in sorted(points, key=lambda point: point.buffers):
        if point.topple == topple and point.cost is not None and point.cost < min(fewest, default=point.cost + 1):
            fewest[point.cost] = point.buffers
    return fewest
