"""Costs from durations: what the executor's actions took, as a cost per kind of action and per metre of travel.

The model is the law's own (`smash.problem.costs`): a base for each kind, and the same for each metre that blocks travel
through the air. It is fitted by least squares without negative values to every action that an episode carried out as
planned; so the same figures that a planner adds up are the ones that were measured.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, replace

import numpy as np
from scipy.optimize import nnls

from smash.problem.costs import Costs
from smash.problem.errors import IllegalAction
from smash.problem.files.plans import action_from_list
from smash.problem.model import Instance, State
from smash.problem.rules import Law
from smash.records.episodes import Performed

MILLIMETRES = 1000.0


@dataclass(frozen=True, slots=True)
class Duration:
    """One action that was carried out: its kind, how far it moved blocks [m], how long it took [s]."""

    kind: str
    travel: float
    seconds: float


@dataclass(frozen=True, slots=True)
class Fit:
    """Fitted costs.

    Attributes:
        bases: Seconds of an action of each kind without travel.
        per_metre: Seconds of a metre of travel.
        counts: Actions of each kind.
        spread: Standard deviation of measured less fitted durations of each kind [s].
        explained: Share of the durations' variance that the fit explains (R squared).
    """

    bases: Mapping[str, float]
    per_metre: float
    counts: Mapping[str, int]
    spread: Mapping[str, float]
    explained: float

    def costs(self, positions: Mapping[str, tuple[float, float]]) -> Costs:
        """The cost model in milliseconds."""
        actions = {kind: max(1, round(1000 * base)) for kind, base in self.bases.items()}
        return Costs(actions, float(round(1000 * self.per_metre)), dict(positions), "ms")


def durations(
    actions: Iterable[Performed], instance: Instance, positions: Mapping[str, tuple[float, float]]
) -> Iterator[Duration]:
    """Yield the actions that an episode carried out, up to the first that did not go as planned.

    Args:
        actions: As the episode records them.
        instance: What was rearranged.
        positions: Where places are [m].
    """
    law = Law(replace(instance, costs=Costs(travel=MILLIMETRES, positions=positions)))
    state = State.start_of(instance)
    for row in actions:
        action = action_from_list(row.action, "episode")
        if row.outcome != "done" or row.attempts > 1 or law.refusal(state, action) is not None:
            return
        travel = (law.cost(state, action) - 1) / MILLIMETRES
        try:
            law.apply(state, action)
        except IllegalAction:
            return
        if not row.aside:  # else its time holds another pick and place
            yield Duration(str(row.action[0]), travel, float(row.times.execution))


def fit(measured: Iterable[Duration]) -> Fit:
    """Fit bases and travel.

    Raises:
        ValueError: where nothing was measured.
    """
    rows = list(measured)
    if not rows:
        raise ValueError("no action was carried out")
    kinds = list(dict.fromkeys(row.kind for row in rows))
    design = np.array([[*(float(row.kind == kind) for kind in kinds), row.travel] for row in rows])
    seconds = np.array([row.seconds for row in rows])
    solution, _ = nnls(design, seconds)
    left = seconds - design @ solution
    total = float(((seconds - seconds.mean()) ** 2).sum())
    of_kind = {kind: left[design[:, index] > 0] for index, kind in enumerate(kinds)}
    return Fit(
        bases=dict(zip(kinds, (float(value) for value in solution), strict=False)),
        per_metre=float(solution[-1]),
        counts={kind: len(part) for kind, part in of_kind.items()},
        spread={kind: float(part.std()) for kind, part in of_kind.items()},
        explained=1.0 - float((left**2).sum()) / total if total else 1.0,
    )
