"""Best known costs and lower bounds of the open instances: what is known of each, and how it gets better.

A plan gets on the list only by the law; a lower bound only from a run of a sweep, or by a certificate that is checked.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cache
from pathlib import Path

import msgspec

from smash.problem.errors import MalformedFile
from smash.problem.files.plans import read_plan
from smash.problem.model import Action, Instance, PlanOptions
from smash.problem.rules import Law
from smash.problem.sets.open_instances import FAMILIES
from smash.problem.sets.suites import read_suite
from smash.records.runs import RunRecord, instance_hash
from smash.records.variants import variant_options

PLANS = "plans"
"""The directory of the plans, beside the list."""


class Found(msgspec.Struct, frozen=True):
    """Who or what found a plan or proved a bound: planner or person, its method, version, commit, seconds, date."""

    by: str
    origin: str
    version: str = ""
    commit: str = ""
    seconds: float | None = None
    date: str = ""


class Entry(msgspec.Struct, frozen=True):
    """What is known of an instance in one variant; its buffers are part of the instance.

    `cost` and `lower_bound` count actions; None where there is none.
    """

    instance: str
    variant: str
    cost: int | None = None
    found: Found | None = None
    lower_bound: int | None = None
    bound: Found | None = None

    @property
    def proven(self) -> bool:
        """Whether the best plan is proven optimal."""
        return self.cost is not None and self.cost == self.lower_bound

    @property
    def gap(self) -> int | None:
        """Actions between the best cost and the best lower bound."""
        return None if self.cost is None else self.cost - (self.lower_bound or 0)

    @property
    def plan_file(self) -> str:
        """The file of its plan, in the list's directory."""
        return f"{PLANS}/{self.instance}.{self.variant}.json" if self.cost is not None else ""


@cache
def open_instances() -> Mapping[str, Instance]:
    """Return the instances of the committed open sets by name."""
    return {instance.name: instance for family in FAMILIES for instance in read_suite(family)}


def variant_name(options: PlanOptions) -> str:
    """Return the name of what a plan may use: `topple`, `no-topple` or `max-topple-M`."""
    if not options.topple:
        return "no-topple"
    return "topple" if options.max_topple is None else f"max-topple-{options.max_topple}"


def options_of(variant: str) -> PlanOptions:
    """Return what a plan of a variant may use.

    Raises:
        MalformedFile: where it is no variant.
    """
    options = variant_options(variant)
    if options is None:
        raise MalformedFile(variant, "no variant; `topple`, `no-topple` or `max-topple-M`")
    return options


@dataclass(slots=True)
class BestKnown:
    """The list: entries by (instance, variant), and the plans that were added since it was read."""

    directory: Path
    entries: dict[tuple[str, str], Entry] = field(default_factory=dict)
    plans: dict[tuple[str, str], tuple[Action, ...]] = field(default_factory=dict)

    def variants(self, instance: str) -> list[str]:
        """Return the variants of an instance that are on the list."""
        return [variant for name, variant in self.entries if name == instance]

    def add_variant(self, instance: str, variant: str) -> None:
        """Put a variant of an open instance on the list; it takes over what the others of the instance know."""
        if (instance, variant) in self.entries:
            return
        self.entries[instance, variant] = Entry(instance, variant)
        for other in [self.entries[instance, name] for name in self.variants(instance)]:
            if other.found is not None:
                self.offer_plan(instance, self.actions(other), other.found)
            if other.lower_bound is not None and other.bound is not None:
                self.offer_bound(instance, options_of(other.variant), other.lower_bound, other.bound)

    def offer_plan(self, instance: str, actions: tuple[Action, ...], found: Found) -> list[Entry]:
        """Take a plan into every variant of the instance that it improves; return their entries as they were."""
        improved = []
        for variant in self.variants(instance):
            entry = self.entries[instance, variant]
            if entry.cost is not None and entry.cost <= len(actions):
                continue
            if Law(open_instances()[instance], options_of(variant)).check(actions).accepted:
                improved.append(entry)
                self.entries[instance, variant] = msgspec.structs.replace(entry, cost=len(actions), found=found)
                self.plans[instance, variant] = actions
        return improved

    def offer_bound(self, instance: str, options: PlanOptions, bound: int, found: Found) -> list[Entry]:
        """Take a lower bound on the plans under `options` into every variant that it holds for; as `offer_plan`."""
        improved = []
        for variant in self.variants(instance):
            entry = self.entries[instance, variant]
            if options.includes(options_of(variant)) and bound > (entry.lower_bound or -1):
                improved.append(entry)
                self.entries[instance, variant] = msgspec.structs.replace(entry, lower_bound=bound, bound=found)
        return improved

    def offer_record(self, record: RunRecord) -> list[Entry] | None:
        """Take the plan and the bound of a run; None where it is not of an open instance as it is committed."""
        instance = open_instances().get(record.instance)
        if instance is None or record.instance_hash != instance_hash(instance):
            return None
        self.add_variant(instance.name, record.variant)
        if record.outcome == "refused":
            return []
        plan = record.plan
        source = Found(
            by=record.label,
            origin=plan.incumbents[-1].origin if plan.incumbents else "",
            version=record.versions.get("smash-testbed", ""),
            commit=(record.commit.hash or "")[:10],
            seconds=round(plan.incumbents[-1].seconds, 2) if plan.incumbents else None,
            date=record.started[:10],
        )
        improved = self.offer_plan(instance.name, plan.actions, source) if plan.actions is not None else []
        if plan.lower_bound is not None:
            seconds = None if record.wall_seconds is None else round(record.wall_seconds, 2)
            prover = msgspec.structs.replace(source, origin=plan.bound_origin or "", seconds=seconds)
            improved += self.offer_bound(instance.name, plan.options, plan.lower_bound, prover)
        return improved

    def actions(self, entry: Entry) -> tuple[Action, ...]:
        """Return the best known plan of an entry.

        Raises:
            MalformedFile: where its file is missing or holds none.
        """
        added = self.plans.get((entry.instance, entry.variant))
        file = self.directory / entry.plan_file
        actions = added if added is not None else read_plan(file).actions
        if actions is None:
            raise MalformedFile(str(file), "holds no plan")
        return actions

    def sorted(self) -> list[Entry]:
        """Return the entries: by instance, the variant that allows most first."""
        return sorted(self.entries.values(), key=lambda entry: (entry.instance, _order(entry.variant)))


def _order(variant: str) -> tuple[bool, float]:
    options = options_of(variant)
    return (not options.topple, -(options.max_topple or float("inf")))
