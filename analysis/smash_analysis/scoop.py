"""`python -m smash_analysis.scoop RESULTS`: the paper's demonstration of the scoop, plans and episodes in one table."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd

from smash.problem.errors import MalformedFile
from smash.records.files import RUNS
from smash.records.runs import RunRecord
from smash_analysis import command
from smash_analysis.execution_tables import read_episodes
from smash_analysis.statistics.intervals import bootstrap, bootstrap_ratio
from smash_analysis.tables.believed import runs_of
from smash_analysis.tables.latex import write_latex
from smash_analysis.tables.scenes import by_scene
from smash_analysis.tables.writing import SPREADS, markdown, with_spread, write_csv

BASELINE = "no-topple-no-carry-no-lift"
NAMES = {
    BASELINE: "pick and place only",
    "topple-no-carry-no-lift": "+ topple",
    "no-topple-no-lift": "+ scoop",
    "topple-no-lift": "+ topple, scoop",
    "no-topple-no-carry": "+ lift",
    "topple": "+ topple, scoop, lift",
}
"""Variants in the order of the rows."""
LEGEND = (
    "Saved is against pick and place only with the same policy, on the same seeds; the paper saves 14 % with topple "
    f"and scoop. {SPREADS} Here all are over seeds. `predicted` is the plan's cost, which holds durations fitted to "
    "earlier episodes."
)


def scoop_table(runs: list[RunRecord], episodes: pd.DataFrame) -> pd.DataFrame:
    """Return a row per instance, variant and policy of `smash`, with what other planners say of the same problem.

    It is empty where `smash` has made none of the plans in `NAMES`.
    """
    rows = []
    for run in runs:
        if run.label != "smash" or run.variant not in NAMES or run.actions is None or run.cost is None:
            continue
        here = episodes[(episodes["instance"] == run.instance) & (episodes["label"] == "smash")]
        policies = sorted(here.loc[here["variant"] == run.variant, "policy"].unique())
        for policy in policies or ["–"]:
            carried_out = _carried_out(here[here["policy"] == policy], run.variant)
            rows.append({**_planned(run, runs), "policy": policy, **carried_out})
    if not rows:
        return pd.DataFrame()
    order = {name: index for index, name in enumerate(NAMES.values())}
    table = pd.DataFrame(rows)
    return table.sort_values(["instance", "plan"], key=lambda c: c.map(order) if c.name == "plan" else c, kind="stable")


def _planned(run: RunRecord, runs: list[RunRecord]) -> dict[str, Any]:
    """Return the columns of a plan."""
    assert run.actions is not None
    assert run.cost is not None
    problem, unit = (run.instance, run.variant), run.instance_document.get("costs", {}).get("unit", "actions")
    others = [other for other in runs if other.label != "smash" and (other.instance, other.variant) == problem]
    return {
        "instance": run.instance,
        "plan": NAMES[run.variant],
        "actions": len(run.actions),
        "kinds": _kinds(run.actions),
        "cost": f"{run.cost} {unit}" + (" (optimal)" if run.status == "optimal" else ""),
        "others": "; ".join(f"{other.label}: {_answer(other)}" for other in others) or "–",
        "planning [s]": f"{run.wall_seconds:.2f}",
        "predicted [s]": f"{run.cost / 1000:.1f}" if unit == "ms" else "–",
    }


def _answer(run: RunRecord) -> str:
    return str(run.status) if run.cost is None else f"{run.cost} {run.status}"


def _carried_out(episodes: pd.DataFrame, variant: str) -> dict[str, str]:
    """Return the columns of a variant's episodes, of `episodes` of one instance and policy."""
    tried, good = episodes[episodes["variant"] == variant], episodes[episodes["success"]]
    part, base = (good[good["variant"] == name].set_index("seed")["execution_seconds"] for name in (variant, BASELINE))
    return {
        "execution [s]": _mean(part),
        "saved [%]": _saved(part, base) if variant != BASELINE else "–",
        "success": f"{int(tried['success'].sum())}/{len(tried)}",
        "replans": f"{int(tried['replans'].fillna(0).sum())}",
    }


def _kinds(actions: list[list[Any]]) -> str:
    """Return how often the aggregating actions stand in a plan."""
    counted = pd.Series(
        [action[0] for action in actions if action[0] not in ("pick", "place")], dtype=object
    ).value_counts()
    return ", ".join(f"{count} {name}" for name, count in sorted(counted.items())) or "–"


def _mean(values: pd.Series[float]) -> str:
    return with_spread(values.mean(), bootstrap(np.asarray(values, dtype=np.float64)), len(values))


def _saved(values: pd.Series[float], base: pd.Series[float]) -> str:
    """Return the share of time saved on the seeds on which both succeeded [%]."""
    both = pd.concat({"here": values, "base": base}, axis=1).dropna()
    if both.empty:
        return "–"
    here, there = both["here"].to_numpy(dtype=float), both["base"].to_numpy(dtype=float)
    low, high = bootstrap_ratio(here, there)
    share = 100 * (1 - here.sum() / there.sum())
    return f"{with_spread(share, (100 * (1 - high), 100 * (1 - low)), len(both), 0)} on {len(both)}"


def make(results: Path, out: Path) -> list[Path]:
    """Write the table as Markdown, LaTeX and CSV; return the files.

    Raises:
        MalformedFile: where there are no plans of it or no episodes, or they are damaged.
    """
    table = scoop_table(runs_of(results), by_scene(read_episodes(results)))
    if table.empty:
        raise MalformedFile(str(RUNS.path(results)), "no plan by `smash` of the demonstration of the scoop")
    out.mkdir(parents=True, exist_ok=True)
    files = [out / "scoop.md", out / "scoop.csv"]
    files[0].write_text(f"# The scoop\n\n{LEGEND}\n\n{markdown(table)}", encoding="utf-8")
    write_csv(table, files[1])
    return files + write_latex(table, "The demonstration of the scoop", "tab:scoop", out / "scoop")


def main() -> None:
    """Make the table and say where it is."""
    command.run("scoop", __doc__, make)


if __name__ == "__main__":
    main()
