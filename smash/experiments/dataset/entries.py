"""What a data set holds of a problem: instance, number of buffers, variant, the best plan and bound, and a proof."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from time import perf_counter
from typing import Literal

from smash.experiments.best_known.files import LIST, goal_kind, read_best_known
from smash.experiments.best_known.standing import open_instances, options_of, variant_name
from smash.experiments.planning import plan
from smash.planners.precedence.certify import certify
from smash.problem.buffers import with_buffers
from smash.problem.certificate import Certificate, why_not_certified
from smash.problem.model import Action, Instance, PlanOptions
from smash.problem.problem import Problem
from smash.problem.sets.open_instances import FAMILIES
from smash.problem.sets.suites import PAPER_SUITES, read_suite

BUFFERS = range(13)
"""Of the paper's sets: every number that its ablation asks about."""
PROOF_SECONDS = 2.0
"""For the search of one certificate."""
Standing = Literal["optimal", "open"]


@dataclass(frozen=True, slots=True)
class Entry:
    """One problem and what is known of it.

    Attributes:
        set: the committed set of the instance.
        instance: with the buffers of this problem.
        options: what a plan may use.
        cost: of the best plan known [actions]; None where there is none.
        lower_bound: no plan has fewer actions.
        bound_origin: what proves that.
        actions: the best plan.
        found_by: what found it.
    """

    set: str
    instance: Instance
    options: PlanOptions
    cost: int | None
    lower_bound: int | None
    bound_origin: str | None
    actions: tuple[Action, ...] | None
    found_by: str

    @property
    def variant(self) -> str:
        """`topple`, `no-topple` or `max-topple-M`."""
        return variant_name(self.options)

    @property
    def name(self) -> str:
        """Its name in the data set: instance, number of buffers, variant."""
        return f"{self.instance.name}/B{len(self.instance.buffers)}/{self.variant}"

    @property
    def status(self) -> Standing:
        """`optimal` where the best plan is proven so, else `open`."""
        return "optimal" if self.cost is not None and self.cost == self.lower_bound else "open"

    @property
    def goal(self) -> str:
        """The kind of its goal."""
        return goal_kind(self.instance)


def paper_entries(sets: list[str] | None = None, count: int | None = None, budget: float = 30.0) -> Iterator[Entry]:
    """Yield the problems of the paper's sets, each with 0 to 12 buffers, with and without topple, solved anew.

    Args:
        sets: which; all where None.
        count: only the first so many instances of each.
        budget: wall time of a solve [s].
    """
    for name in PAPER_SUITES if sets is None else sets:
        for instance in read_suite(name)[:count]:
            for buffers in BUFFERS:
                problem = with_buffers(instance, buffers)
                for topple in (True, False):
                    yield _solved(name, problem, topple, budget)


def _solved(name: str, instance: Instance, topple: bool, budget: float) -> Entry:
    found = plan(instance, budget=budget, topple=topple)
    by = found.incumbents[-1].origin if found.incumbents else ""
    return Entry(
        name, instance, found.options, found.cost, found.lower_bound, found.bound_origin, found.actions, f"smash: {by}"
    )


def open_entries() -> Iterator[Entry]:
    """Yield the problems of the open sets, as the list of best known plans has them."""
    known = read_best_known(LIST)
    homes = {instance.name: family for family in FAMILIES for instance in read_suite(family)}
    for entry in known.sorted():
        yield Entry(
            homes[entry.instance],
            open_instances()[entry.instance],
            options_of(entry.variant),
            entry.cost,
            entry.lower_bound,
            entry.bound.origin if entry.bound is not None else None,
            known.actions(entry) if entry.cost is not None else None,
            entry.found.by if entry.found is not None else "",
        )


def certificate_of(entry: Entry) -> Certificate | None:
    """Return a certificate that proves the cost of an entry optimal, or None where none was found.

    A certificate counts no places to wait, so where few of them make plans dearer there is none.
    """
    if entry.status != "optimal" or why_not_certified(entry.instance, entry.options) is not None:
        return None
    found = certify(Problem(entry.instance, entry.options), perf_counter() + PROOF_SECONDS, cost=entry.cost)
    return found if found.bound == entry.cost else None
