"""`python -m analysis.scoop RESULTS`: the paper's demonstration of the scoop, plans and episodes in one table."""

from __future__ import annotations

import argparse
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd

from analysis.execution_tables import read_episodes
from analysis.records import NoRecords, read_lines
from analysis.statistics import bootstrap, bootstrap_ratio
from analysis.tables import latex, markdown

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
    "Saved is against pick and place only on the same seeds, with 95 % bootstrap intervals over seeds; the paper saves "
    "14 % with topple and scoop. `predicted` is the plan's cost, which holds durations fitted to earlier episodes."
)


def scoop_table(runs: list[dict[str, Any]], episodes: pd.DataFrame) -> pd.DataFrame:
    """Return a row per instance and variant of `smash`, with what other planners say of the same problem."""
    rows = []
    for run in runs:
        if run["label"] != "smash" or run["variant"] not in NAMES or run["actions"] is None:
            continue
        here = episodes[(episodes["instance"] == run["instance"]) & (episodes["label"] == "smash")]
        part = here[(here["variant"] == run["variant"]) & here["success"]].set_index("seed")["execution"]
        base = here[(here["variant"] == BASELINE) & here["success"]].set_index("seed")["execution"]
        tried = here[here["variant"] == run["variant"]]
        unit = run["instance_document"]["costs"]["unit"]
        others = [
            r
            for r in runs
            if r["label"] != "smash" and (r["instance"], r["variant"]) == (run["instance"], run["variant"])
        ]
        rows.append(
            {
                "instance": run["instance"],
                "plan": NAMES[run["variant"]],
                "actions": len(run["actions"]),
                "kinds": _kinds(run["actions"]),
                "cost": f"{run['cost']} {unit}" + (" (optimal)" if run["status"] == "optimal" else ""),
                "others": "; ".join(f"{r['label']}: {r['cost']} {r['status']}" for r in others) or "–",
                "planning [s]": f"{run['wall_seconds']:.2f}",
                "predicted [s]": f"{run['cost'] / 1000:.1f}" if unit == "ms" else "–",
                "execution [s]": _mean(part),
                "saved [%]": _saved(part, base) if run["variant"] != BASELINE else "–",
                "success": f"{int(tried['success'].sum())}/{len(tried)}",
                "replans": f"{int(tried['replans'].fillna(0).sum())}",
            }
        )
    order = {name: index for index, name in enumerate(NAMES.values())}
    table = pd.DataFrame(rows)
    return table.sort_values(["instance", "plan"], key=lambda c: c.map(order) if c.name == "plan" else c, kind="stable")


def _kinds(actions: list[list[Any]]) -> str:
    """Return how often the aggregating actions stand in a plan."""
    counted = pd.Series(
        [action[0] for action in actions if action[0] not in ("pick", "place")], dtype=object
    ).value_counts()
    return ", ".join(f"{count} {name}" for name, count in sorted(counted.items())) or "–"


def _mean(values: pd.Series[float]) -> str:
    if values.empty:
        return "–"
    low, high = bootstrap(np.asarray(values, dtype=np.float64))
    return f"{values.mean():.1f} [{low:.1f}, {high:.1f}]"


def _saved(values: pd.Series[float], base: pd.Series[float]) -> str:
    """Return the share of time saved on the seeds on which both succeeded."""
    both = pd.concat({"here": values, "base": base}, axis=1).dropna()
    if both.empty:
        return "–"
    here, there = both["here"].to_numpy(dtype=float), both["base"].to_numpy(dtype=float)
    low, high = bootstrap_ratio(here, there)
    share = 100 * (1 - here.sum() / there.sum())
    return f"{share:.0f} [{100 * (1 - high):.0f}, {100 * (1 - low):.0f}] on {len(both)}"


def make(results: Path, out: Path) -> list[Path]:
    """Write the table as Markdown, LaTeX and CSV; return the files.

    Raises:
        NoRecords: where there are no runs or no episodes.
    """
    runs = read_lines(results / "runs.jsonl", "smash-run/1")
    if not runs:
        raise NoRecords(f"{results / 'runs.jsonl'}: no finished run")
    table = scoop_table(runs, read_episodes(results))
    out.mkdir(parents=True, exist_ok=True)
    files = [out / "scoop.md", out / "scoop.tex", out / "scoop.csv"]
    files[0].write_text(f"# The scoop\n\n{LEGEND}\n\n{markdown(table)}", encoding="utf-8")
    files[1].write_text(latex(table, "The demonstration of the scoop", "tab:scoop"), encoding="utf-8")
    table.to_csv(files[2], index=False)
    return files


def main() -> None:
    """Make the table and say where it is."""
    parser = argparse.ArgumentParser(prog="python -m analysis.scoop", description=__doc__)
    parser.add_argument("results", type=Path, help="directory with runs.jsonl and episodes.jsonl")
    parser.add_argument("--out", type=Path, help="default: RESULTS")
    arguments = parser.parse_args()
    try:
        files = make(arguments.results, arguments.out or arguments.results)
    except NoRecords as error:
        sys.exit(f"analysis: {error}")
    print("\n".join(str(file) for file in files))


if __name__ == "__main__":
    main()
