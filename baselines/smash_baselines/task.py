"""The compiler: an instance to a PDDL domain and problem, as text that any planner reads."""

from __future__ import annotations

import json
from collections.abc import Collection, Iterable, Iterator
from dataclasses import dataclass
from pathlib import Path

from smash.problem.files.documents import write_text
from smash.problem.model import Instance, OnGoal, PlanOptions, PositionsGoal, StacksGoal
from smash.problem.problem import Problem
from smash_baselines.encodings import Encoding, encoding_for
from smash_baselines.facts import Facts, facts_of
from smash_baselines.goal_words import told
from smash_baselines.names import Fact, Names
from smash_baselines.parts.layout import Layout

HEADER = ";; smash-names: "
"""Before the line of JSON that says how the objects of a problem are called in the instance."""
GOAL_KINDS = {StacksGoal: "stacks", PositionsGoal: "positions", OnGoal: "on"}


@dataclass(frozen=True, slots=True)
class PddlTask:
    """An instance compiled to PDDL, with what is needed to read plans back.

    Its goal is the one that PDDL is told (`smash_baselines.goal_words.told`).
    """

    instance: Instance
    options: PlanOptions
    encoding: Encoding
    names: Names
    facts: Facts

    @property
    def domain_text(self) -> str:
        """The domain."""
        return self.encoding.text

    @property
    def problem_text(self) -> str:
        """The problem."""
        objects = [f"    {' '.join(members)} - {kind}" for kind, members in self.facts.objects.items() if members]
        costs = self.encoding.costs
        lines = [
            HEADER + json.dumps(_header(self)),
            "(define (problem smash)",
            f"  (:domain {self.encoding.domain})",
            "  (:objects\n" + "\n".join(objects) + ")",
            "  (:init\n"
            + ("    (= (total-cost) 0)\n" if costs else "")
            + "".join(_cost_lines(self.facts))
            + _fact_lines(self.facts.start)
            + ")",
            "  (:goal (and\n" + _fact_lines(self.facts.goal) + "))",
            *(["  (:metric minimize (total-cost))"] if costs else []),
        ]
        return "\n".join(lines) + ")\n"

    def write(self, directory: Path) -> tuple[Path, Path]:
        """Write `domain.pddl` and `problem.pddl` into an existing directory and return their paths."""
        domain, problem = directory / "domain.pddl", directory / "problem.pddl"
        write_text(domain, self.domain_text)
        write_text(problem, self.problem_text)
        return domain, problem


def compile_instance(
    instance: Instance, options: PlanOptions, wanted: str, picked: Collection[str] | None = None
) -> PddlTask:
    """Compile an instance; topples are told in the way `wanted` (`conditional`, `chain`, …).

    Args:
        instance: the problem.
        options: what a plan may use.
        wanted: the encoding's name.
        picked: the blocks that may be picked from the table region, in the family's domains; all, where None.

    Raises:
        UnknownEncoding: where no encoding is called so.
        Unsupported: where that encoding cannot say the problem.
    """
    problem = Problem(instance, options)
    encoding = encoding_for(problem, wanted)
    instance, names = told(problem), Names.of(instance)
    return PddlTask(instance, options, encoding, names, facts_of(instance, options, encoding, names, picked))


def _fact_lines(facts: Iterable[Fact]) -> str:
    return "\n".join(f"    ({' '.join(fact)})" for fact in facts)


def _cost_lines(facts: Facts) -> Iterator[str]:
    return (f"    (= ({' '.join(function)}) {value})\n" for function, value in facts.costs)


def _header(task: PddlTask) -> dict[str, object]:
    instance, names = task.instance, task.names
    header: dict[str, object] = {
        "instance": instance.name,
        "goal": GOAL_KINDS[type(instance.goal)],
        "blocks": dict(names.block_of),
        "locations": dict(names.location_of),
        "buffers": list(instance.buffers),
        "on_buffers": {names.blocks[pile[0]]: at for at in instance.buffers if (pile := instance.start.get(at))},
    }
    if task.encoding.parts:
        layout = Layout(instance, names)
        header["carriers"] = {short: name for name, short in layout.carriers.items()}
        header["stations"] = {short: name for name, short in layout.stations.items()}
    return header
