"""What contradicts what: claims about all plans of a problem, held against plans that somebody has.

A plan that the law accepts is a fact. A claim is a lower bound on the cost of every plan (of an optimal one, its cost),
or that there is none. A plan of a problem is a plan, at the same cost, of each problem that only allows more: topples
as well, larger ones, more empty buffers. So a claim is false where such a plan is cheaper than its bound, whoever
found it; and the claim that there is no plan is false too where start and goal alone show one (`Problem.infeasible`).
"""

from __future__ import annotations

import json
from collections import Counter, defaultdict
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from functools import cached_property

from smash.problem.files.instances import instance_document
from smash.problem.model import Instance, PlanOptions
from smash.problem.problem import Problem


@dataclass(frozen=True)
class Posed:
    """A problem as claims are about it: equal where everything but its names of empty buffers and its own is.

    Attributes:
        kin: all of the instance but its name and its empty buffers, as text.
        spare: where the empty buffers stand, how many at each place; at one place, None, where ways cost nothing.
        options: what plans may use.
    """

    kin: str
    spare: tuple[tuple[tuple[float, float] | None, int], ...]
    options: PlanOptions

    @classmethod
    def of(cls, instance: Instance, options: PlanOptions) -> Posed:
        """Return a problem, posed."""
        document = instance_document(instance)
        empty = [buffer for buffer in instance.buffers if not instance.start[buffer]]
        document["buffers"] = [buffer for buffer in instance.buffers if buffer not in empty]
        places = instance.costs.positions if instance.costs.travel else {}
        if "costs" in document:
            document["costs"]["positions"] = {name: at for name, at in places.items() if name not in empty}
        spare = Counter(places.get(buffer) for buffer in empty)
        del document["name"]
        return cls(json.dumps(document, sort_keys=True), tuple(spare.items()), options)

    def includes(self, other: Posed) -> bool:
        """Whether every plan of `other` is one of this problem too, at the same cost, but for names of buffers."""
        if self == other:
            return True
        if self.kin != other.kin or not self.options.includes(other.options):
            return False
        spare = dict(self.spare)
        return all(count <= spare.get(place, 0) for place, count in other.spare)


def claimed_infeasible(problem: Problem) -> bool | None:
    """Return whether the law alone bears out that a problem has no plan; None where it cannot say."""
    if problem.infeasible is not None:
        return True
    return False if all(kind.name == "topple" for kind in problem.kinds) else None


@dataclass(frozen=True)
class Fact:
    """A legal plan of a problem: its cost, who has it, and the problem's name for people."""

    posed: Posed
    cost: int
    who: str
    where: str


@dataclass(frozen=True)
class Claim:
    """What somebody says of all plans of a problem.

    Attributes:
        problem: what it is about.
        posed: the same, posed.
        bound: no plan is cheaper; None: there is no plan.
        who: says so.
        where: the problem's name for people.
    """

    problem: Problem
    posed: Posed
    bound: int | None
    who: str
    where: str

    def beaten_by(self, plan: Fact) -> bool:
        """Whether a plan shows that this is false."""
        return (self.bound is None or plan.cost < self.bound) and self.posed.includes(plan.posed)

    @cached_property
    def decided(self) -> bool | None:
        """Whether the law alone bears out that there is no plan; None where it cannot say, or a bound is claimed."""
        return None if self.bound is not None else claimed_infeasible(self.problem)


@dataclass(frozen=True)
class Contradiction:
    """A claim that is false, and in words why; the plan that shows it is None where start and goal alone do."""

    claim: Claim
    plan: Fact | None

    def __str__(self) -> str:
        claim, plan = self.claim, self.plan
        said = (
            "says that there is no plan" if claim.bound is None else f"says that no plan is cheaper than {claim.bound}"
        )
        if plan is None:
            return f"{claim.where}: {claim.who} {said}, start and goal show that there is one"
        elsewhere = "" if plan.where == claim.where else f" of {plan.where}, which is one of this too"
        return f"{claim.where}: {claim.who} {said}, {plan.who} has a plan of {plan.cost}{elsewhere}"


def contradictions(plans: Iterable[Fact], claims: Iterable[Claim]) -> Iterator[Contradiction]:
    """Yield every claim that is false, with the cheapest plan that shows it."""
    best: dict[Posed, Fact] = {}
    for plan in plans:
        known = best.get(plan.posed)
        if known is None or plan.cost < known.cost:
            best[plan.posed] = plan
    of_kin: defaultdict[str, list[Fact]] = defaultdict(list)
    for plan in best.values():
        of_kin[plan.posed.kin].append(plan)
    for claim in claims:
        beating = [plan for plan in of_kin[claim.posed.kin] if claim.beaten_by(plan)]
        if beating:
            yield Contradiction(claim, min(beating, key=lambda plan: plan.cost))
        elif claim.decided is False:
            yield Contradiction(claim, None)
