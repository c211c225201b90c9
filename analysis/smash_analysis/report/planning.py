"""The section on a sweep's runs: who answers what, heatmaps, curves, effects, failures, instances."""

from __future__ import annotations

import pandas as pd

from smash.problem.words import counted
from smash_analysis.charts.curves import anytime_chart, coverage_chart, gap_chart
from smash_analysis.comparison import comparable, compared, comparison_table, failure_table, optima, outcome_table
from smash_analysis.report.blocks import Block, CardsBlock, ChartBlock, TableBlock, Words
from smash_analysis.report.grids import ablation_grids, coverage_grids, variant_words
from smash_analysis.report.growth import SIZES_FOR_CURVES, growth_blocks, growth_headlines
from smash_analysis.report.instances import cards
from smash_analysis.report.sources import Source
from smash_analysis.report.strips import strips
from smash_analysis.scaling import scaling_cells
from smash_analysis.statistics.effects import (
    ANY,
    Effect,
    planner_effects,
    proven_optima,
    reference_planner,
    topple_effects,
)
from smash_analysis.statistics.findings import THRESHOLD, cutoff_findings, smallest_buffers
from smash_analysis.tables.cells import variant_cells
from smash_analysis.tables.effects import planner_table, topple_table
from smash_analysis.tables.readings import cutoff_check, readings
from smash_analysis.tables.writing import SPREADS, with_spread

MOST_EFFECTS, MOST_HEADLINES = 60, 4
"""Effects are told in as much detail as fits into so many rows, and into so many sentences of the overview."""
FAILURE_COLUMNS = (("label", "planner"), ("variant", "variant"), ("outcome", "outcome"))
"""Field of a record, and the column of `failure_table` that says the same."""
SHOWN_SUITES = 8
"""Curves have a panel per suite: with more suites than this they say less than the curves over blocks."""


class Planning:
    """All that is computed once from a sweep's runs."""

    def __init__(self, source: Source) -> None:
        self.source = source
        self.records = source.runs
        self.final = comparable(self.records)
        at = {id(record): number for number, record in enumerate(self.records)}
        self.kept = [at[id(record)] for record in self.final]
        self.runs = compared(self.final)
        self.proven = optima(self.final)
        self.effects = topple_effects(pd.concat([proven_optima(self.runs), self.runs]), MOST_EFFECTS)
        self.sizes = len({record.blocks for record in self.records})

    def figures(self) -> list[tuple[str, str]]:
        """Return the numbers at the top of the section."""
        problems = self.runs.drop_duplicates(["instance_hash", "variant"])
        solved = self.runs[self.runs["solved"]].drop_duplicates(["instance_hash", "variant"])
        return [
            (f"{len(self.records)}", "runs"),
            (f"{self.runs['label'].nunique()}", "planners, by their settings"),
            (f"{len(problems)}", "problems: instance, buffers, variant"),
            (f"{len(solved)}", "problems with a plan"),
            (f"{len(self.proven)}", "proven optima"),
        ]

    def headlines(self) -> list[str]:
        """Return the findings that matter most, a sentence each."""
        lines = list(filter(None, map(_effect_words, topple_effects(proven_optima(self.runs), MOST_HEADLINES))))
        lines += self._thresholds() + self._provers()
        if self.sizes >= SIZES_FOR_CURVES:
            lines += growth_headlines(self.cells())
        failures = failure_table(self.runs)
        ended = failures[failures["outcome"].isin(["crashed", "memory", "refused"])]["runs"].sum()
        if ended:
            lines.append(f"{ended} of {len(self.final)} runs crashed, hit the memory limit or were refused by the law.")
        count = len(self.source.contradictions)
        if not count:
            return [*lines, "No two planners contradict each other."]
        return [f"{count} contradictions: a planner with a false claim proves nothing on this page; see below.", *lines]

    def cells(self) -> pd.DataFrame:
        """Return the cells of the curves over blocks."""
        return scaling_cells([record for record in self.records if record.kind != "cutoff"])

    def _thresholds(self) -> list[str]:
        """Say the fewest buffers that reach the paper's success rate, where several were tried on few sets."""
        needs: dict[tuple[str, ...], list[str]] = {}
        for (label, suite), part in variant_cells(readings(self.records)).groupby(["label", "suite"], sort=False):
            if part["buffers"].nunique() < 3 or part["variant"].nunique() < 2 or self.sizes >= SIZES_FOR_CURVES:
                continue
            said = []
            for variant, mine in part.groupby("variant"):
                fewest = smallest_buffers(mine, every_budget=False)
                said.append(f"{'more than tried' if fewest is None else fewest} {variant_words(str(variant))}")
            needs.setdefault(tuple(said), []).append(f"{label} on {suite}")
        if not needs:
            return []
        budget = max(record.budget for record in self.records)
        lines = [f"{' and '.join(said)}: {', '.join(who)}" for said, who in needs.items()]
        return [
            f"Fewest buffers with at least {THRESHOLD:.0%} success at the largest budget (up to {budget:g} s; the "
            f"paper: 8 without topple, 0 with topple): {'; '.join(lines)}."
        ]

    def _provers(self) -> list[str]:
        totals = self.runs.groupby("label", sort=False).agg(
            runs=("solved", "size"), solved=("solved", "sum"), proven=("proven", "sum")
        )
        whole = totals["runs"].max()
        best = totals[totals["proven"] > 0].sort_values(["proven", "solved"], ascending=False, kind="stable").head(3)
        said = ", ".join(f"{label} {row['proven']} of {row['runs']}" for label, row in best.iterrows())
        lines = [f"Most proofs of optimality: {said}."] if said else []
        everything = [str(label) for label, row in totals.iterrows() if row["solved"] == row["runs"] == whole]
        if everything:
            lines.append(f"A plan for every one of {whole} problems: {', '.join(everything)}.")
        return lines

    def blocks(self) -> list[Block]:
        """Return the section's parts, in order."""
        blocks: list[Block] = [coverage_grids(self.records, self.kept, self.runs)]
        heatmaps = ablation_grids(self.records)
        blocks += heatmaps
        check = cutoff_check(self.records)
        if len(check):
            blocks.append(
                Words(
                    "cutoffs",
                    "One anytime run read at smaller budgets, against real cut-offs",
                    list(cutoff_findings(check)),
                )
            )
        if self.sizes >= SIZES_FOR_CURVES:
            blocks += growth_blocks(self.cells())
        if self.runs["suite"].nunique() <= SHOWN_SUITES and self.sizes < SIZES_FOR_CURVES:
            blocks += self._curves()
        blocks += self._effects()
        blocks.append(
            TableBlock(
                "comparison",
                "Planners, setting by setting",
                comparison_table(self.runs),
                "At the largest budget of each planner and set. Times are medians with quartiles over the runs with a "
                "plan; “cost, solved” is over what this planner solved, another subset for each; “cost, common” over "
                "the problems that every planner with a plan in that setting solved; gaps are to proven optima alone.",
                folded=len(self.runs) > 40,
            )
        )
        blocks += self._ends()
        blocks.append(self._instances())
        return [block for block in blocks if not (isinstance(block, CardsBlock) and not block.cards)]

    def _curves(self) -> list[Block]:
        blocks: list[Block] = [
            ChartBlock(
                "coverage",
                "Coverage over time",
                coverage_chart(self.final),
                "The share of a planner's problems with a plan by each time. Every problem counts at every time.",
            ),
            ChartBlock(
                "anytime",
                "Quality over time",
                anytime_chart(self.final),
                "Best known cost over the cost of the best plan so far, 0 without one: the mean over all problems of a "
                "planner, so that its subset never changes.",
            ),
        ]
        if any(cost > 0 for cost in self.proven.values()):
            blocks.append(
                ChartBlock(
                    "gap",
                    "Gap to the optimum",
                    gap_chart(self.final, self.proven),
                    "The share of problems with a plan at most so much above the optimum, over those whose optimum "
                    "some planner proved. A curve that ends below 100 % has problems without a plan, or with one that "
                    "costs more than twice the optimum.",
                )
            )
        return blocks

    def _effects(self) -> list[Block]:
        blocks: list[Block] = []
        if self.effects:
            table = topple_table(self.effects)
            pictures = strips([effect.pair for effect in self.effects])
            blocks.append(
                TableBlock(
                    "topple-effect",
                    "What topple saves, instance by instance",
                    table,
                    "Actions without topple minus actions with it, on the instances that the same planner solved both "
                    "ways (same buffers, same seed); an instance counts once. Dots: instances; bar: interval or "
                    f"range. {SPREADS} Solved: over all tried both ways, the mean of the instances' own rates with "
                    "its 95 % Wilson interval over instances. "
                    f"“{ANY}”: no planner's figures, but the problem's own.",
                    emphasis=frozenset(i for i, e in enumerate(self.effects) if e.about["label"] == ANY),
                    pictures={"saved, mean [95 %] (range)": pictures},
                )
            )
        if self.runs["label"].nunique() > 1:
            reference = reference_planner(self.runs)
            effects = planner_effects(self.runs)
            blocks.append(
                TableBlock(
                    "planner-pairs",
                    f"Planners against {reference}, pair by pair",
                    planner_table(effects, reference),
                    f"{reference} has the most plans, then the most proofs. Each planner is compared with it on the "
                    "problems that both solved, so rows stand on different problems: read the shares beside the ratio. "
                    f"{SPREADS}",
                )
            )
        return blocks

    def _ends(self) -> list[Block]:
        failures = failure_table(self.runs)
        clean = [str(label) for label in dict.fromkeys(self.runs["label"]) if label not in set(failures["planner"])]
        note = f"No failure: {', '.join(clean)}." if clean else "Every planner has some."
        numbers, columns = self._by_failure(), [*(column for _, column in FAILURE_COLUMNS), "reason"]
        behind = [numbers[tuple(row[column] for column in columns)] for row in failures.to_dict("records")]
        blocks: list[Block] = [
            TableBlock("failures", "Failures and their reasons", failures, note, entries=behind, store="runs"),
            TableBlock("outcomes", "How the runs ended", outcome_table(self.runs), folded=True),
        ]
        return blocks

    def _by_failure(self) -> dict[tuple[str, ...], list[int]]:
        """Return the numbers of the runs that each row of `failure_table` may stand for, by what the row says."""
        found: dict[tuple[str, ...], list[int]] = {}
        for number, record in zip(self.kept, self.final, strict=True):
            said = *(getattr(record, name) for name, _ in FAILURE_COLUMNS), record.reason or "no plan by the budget"
            found.setdefault(said, []).append(number)
        return found

    def _instances(self) -> CardsBlock:
        return cards(self.source, self.runs)


def _effect_words(effect: Effect) -> str:
    pair, about = effect.pair, effect.about
    if not pair.units or pd.isna(pair.ratio):
        return ""
    where = f" on {about['suite']}" if "suite" in about else ""
    where += f" with {counted(int(about['buffers']), 'buffer')}" if "buffers" in about else ""
    return (
        f"Proven optima{where}: {pair.left_mean:.1f} actions without topple, {pair.right_mean:.1f} "
        f"{variant_words(about['variant'])} on the {counted(pair.units, 'instance')} where both are proven; "
        f"{with_spread(pair.mean, pair.interval, pair.units)} saved, ratio {pair.ratio:.2f}."
    )
