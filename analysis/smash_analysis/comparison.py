"""A comparison of planners on the same problems: who wins where, coverage, times, costs, gaps, memory, every failure.

Costs of different planners are means over different subsets as soon as their coverage differs. So each is given
twice: over all that the planner solved, and over the problems that every planner with a plan of that variant solved.
"""

from __future__ import annotations

from pathlib import Path

import pandas as pd

from smash.problem.words import visible
from smash.records.believing import Believed
from smash.records.runs import RunRecord
from smash_analysis import command
from smash_analysis.charts.curves import anytime_chart, coverage_chart
from smash_analysis.metrics import PREFIX, metric_names
from smash_analysis.statistics.conditions import conditions
from smash_analysis.tables.believed import believed_of
from smash_analysis.tables.latex import write_latex
from smash_analysis.tables.paradigms import WORDS, paradigm_table
from smash_analysis.tables.runs import runs_table
from smash_analysis.tables.writing import markdown, mean_std, median_iqr, of_seconds, share, write_csv

PROBLEM = ["instance_hash", "variant"]
GROUP = ["suite", "blocks", "buffers", "variant"]


def comparable(records: list[RunRecord]) -> list[RunRecord]:
    """Return the runs at the largest budget of each planner and suite, real cut-offs left out."""
    kept = [record for record in records if record.kind != "cutoff"]
    largest: dict[tuple[str, str], float] = {}
    for record in kept:
        who = (record.label, record.suite)
        largest[who] = max(largest.get(who, 0.0), record.budget)
    return [record for record in kept if record.budget == largest[record.label, record.suite]]


def optima(records: list[RunRecord]) -> dict[tuple[str, str], int]:
    """Return the proven optimal cost of each problem (instance hash, variant), of believed runs."""
    proven = [record for record in records if record.outcome != "refused" and record.status == "optimal"]
    return {(record.instance_hash, record.variant): record.cost for record in proven if record.cost is not None}


def compared(records: list[RunRecord]) -> pd.DataFrame:
    """Return one row a believed run with `gap` and `common`.

    `gap` is the cost over the proven optimum, a share, and NaN where none is proven. `common` holds where every planner
    that solved anything of this suite and variant solved this problem.
    """
    runs = runs_table(records)
    proven = optima(records)
    best = [proven.get(problem) for problem in zip(runs["instance_hash"], runs["variant"], strict=True)]
    runs["optimum"] = pd.Series(best, index=runs.index, dtype=float)
    gap = runs["cost"] / runs["optimum"].where(runs["optimum"] > 0) - 1
    runs["gap"] = gap.mask((runs["optimum"] == 0) & (runs["cost"] == 0), 0.0)
    able = runs.groupby(["suite", "variant", "label"])["solved"].transform("any")
    settled = runs["solved"] | ~able
    runs["common"] = settled.groupby([runs[column] for column in [*PROBLEM, "suite"]]).transform("all") & runs["solved"]
    return runs


def comparison_table(runs: pd.DataFrame, group: list[str] = GROUP) -> pd.DataFrame:
    """Return the table: one row per group and planner, in the order in which the planners were given."""
    rows = []
    for setting, part in runs.groupby(group, sort=True):
        for label, mine in part.groupby("label", sort=False):
            rows.append({**dict(zip(group, setting, strict=True)), "planner": label, **_row(mine)})
    return pd.DataFrame(rows)


def _row(mine: pd.DataFrame) -> dict[str, object]:
    shared = mine[mine["common"]]
    known = mine["gap"].dropna()
    return {
        "coverage": f"{int(mine['solved'].sum())}/{len(mine)}",
        "coverage [95 %]": share(int(mine["solved"].sum()), len(mine)),
        "proven": f"{int(mine['proven'].sum())}/{len(mine)}",
        "first plan [s]": of_seconds(median_iqr, mine["first_seconds"]),
        "best plan [s]": of_seconds(median_iqr, mine["best_seconds"]),
        "CPU [s]": of_seconds(median_iqr, mine["cpu_seconds"].astype(float)),
        "cost, solved": mean_std(mine["cost"]),
        "cost, common": f"{mean_std(shared['cost'])} (n={len(shared)})",
        "median cost": median_iqr(mine["cost"], 1),
        "gap to optimum": f"{100 * known.mean():.1f} % (n={len(known)})" if len(known) else "–",
        **{name: median_iqr(mine[mine["solved"]][PREFIX + name]) for name in metric_names(mine)},
        "memory [MiB]": f"{mine['memory_mib'].median():.0f}" if mine["memory_mib"].notna().any() else "–",
    }


def outcome_table(runs: pd.DataFrame) -> pd.DataFrame:
    """Return how often each planner's runs ended how, one column an outcome."""
    counts = runs.groupby(["label", "variant", "outcome"], sort=False).size().unstack(fill_value=0)
    return counts.reset_index().rename(columns={"label": "planner"}).rename_axis(None, axis="columns")


def failure_table(runs: pd.DataFrame) -> pd.DataFrame:
    """Return the failures with their reasons, counted: whatever is no plan and no proof that there is none."""
    failed = runs[~runs["solved"] & (runs["status"] != "infeasible") | runs["outcome"].isin(["crashed", "memory"])]
    reasons = failed.assign(reason=failed["reason"].where(failed["reason"] != "", "no plan by the budget"))
    counts = reasons.groupby(["label", "variant", "outcome", "reason"], sort=False).size()
    return counts.rename("runs").reset_index().rename(columns={"label": "planner"})


def make(results: Path, out: Path) -> list[Path]:
    """Make the comparison's tables and curves from the records in `results`; return the files.

    Raises:
        MalformedFile: where there are none, or they cannot be read.
    """
    return write(believed_of(results), out)


def write(found: Believed, out: Path) -> list[Path]:
    """Write the tables and curves of believed runs, what contradicts first; return the files."""
    records = comparable(found.records)
    out.mkdir(parents=True, exist_ok=True)
    runs = compared(records)
    table, outcomes, failures = comparison_table(runs), outcome_table(runs), failure_table(runs)
    paradigms = paradigm_table(runs)
    parts = {"comparison": table, "paradigms": paradigms, "outcomes": outcomes, "failures": failures}
    files = []
    for name, part in parts.items():
        files.append(out / f"{name}.csv")
        write_csv(part, files[-1])
    left_out = [f"- {visible(line)}" for line in found.lines()]
    page = ["# Comparison", ""]
    page += ["## Contradictions, and what is left out", "", *left_out, ""] if left_out else []
    page += ["## Who wins where", "", WORDS, "", markdown(paradigms), "## Every planner", "", markdown(table)]
    page += ["## How the runs ended", "", markdown(outcomes)]
    page += ["## Failures and their reasons", "", markdown(failures) if len(failures) else "None.\n"]
    page += [] if left_out else ["## Contradictions between planners", "", "None."]
    files.append(out / "comparison.md")
    files[-1].write_text("\n".join([*page, conditions(records)]), encoding="utf-8")
    files += write_latex(table, "Planners on the same problems", "tab:comparison", out / "comparison")
    for name, draw in (("anytime", anytime_chart), ("coverage", coverage_chart)):
        figure = draw(records).figure()
        for ending in ("png", "pdf"):
            files.append(out / f"{name}.{ending}")
            figure.savefig(files[-1], dpi=200)
    return files


def main() -> None:
    """Make the comparison's tables and curves and say where they are."""
    command.run("comparison", __doc__, make, "comparison", shown="comparison.md")


if __name__ == "__main__":
    main()
