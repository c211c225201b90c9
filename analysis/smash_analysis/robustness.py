"""`python -m smash_analysis.robustness RESULTS`: success and time of the same plans over each kind of noise.

RESULTS holds episodes without noise and with one kind of it at a time (`smash episodes RESULTS --noise KIND=AMOUNT`).
"""

from __future__ import annotations

from math import degrees
from pathlib import Path

import numpy as np
import pandas as pd
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure

from smash.problem.errors import MalformedFile
from smash.records.files import EPISODES
from smash_analysis import command
from smash_analysis.execution_tables import failure_table, told_episodes
from smash_analysis.statistics.intervals import Paired, paired, success_rate
from smash_analysis.tables.believed import records_of
from smash_analysis.tables.writing import RATES, SPREADS, markdown, rate_cell, with_spread

SCALES = {
    "pose": ("mm", 1e3),
    "yaw": ("°", degrees(1.0)),
    "camera": ("mm", 1e3),
    "placement": ("mm", 1e3),
    "friction": ("%", 1e2),
    "mass": ("%", 1e2),
    "size": ("mm", 1e3),
}
"""The unit in which a kind is shown, and how many of it one of the records' is."""
SETTING = ["suite", "label", "variant", "policy"]
"""What episodes have in common that are compared."""
PROBLEM = ["instance", "seed"]
LEGEND = (
    "Each kind of noise is tried alone, on the same plans; amounts are standard deviations, of size a tolerance. "
    f"{RATES} "
    "`time` is execution (simulated) as a share of that without noise, on the instances and seeds that succeed both "
    f"ways; `actions` is of what was carried out, likewise. {SPREADS} Failures are counted over episodes."
)


def read_noisy(results: Path) -> pd.DataFrame:
    """Return `told_episodes` with `kind` of noise (none: "") and `amount` in the unit of `SCALES`.

    Episodes with several kinds at once are left out: they lie on no curve.

    Raises:
        MalformedFile: where there are no episodes, or they are damaged.
    """
    records = [record for record in records_of(results, EPISODES) if record.episode and len(record.episode.noise) < 2]
    if not records:
        raise MalformedFile(str(EPISODES.path(results)), "no episode without noise, or with one kind of it")
    noises = [next(iter(record.episode.noise.items()), ("", 0.0)) for record in records if record.episode]
    amounts = [round(amount * SCALES[kind][1], 2) if kind else 0.0 for kind, amount in noises]
    return told_episodes(records).assign(kind=[kind for kind, _ in noises], amount=amounts)


def against_exact(part: pd.DataFrame, exact: pd.DataFrame, value: str) -> Paired:
    """Return episodes at one amount of noise (left) against those without any (right) on the same problems."""
    left, right = (side.assign(solved=side["success"])[[*PROBLEM, "solved", value]] for side in (part, exact))
    return paired(left, right, PROBLEM, ["instance"], value)


def robustness_table(episodes: pd.DataFrame) -> pd.DataFrame:
    """Return a row per setting, kind and amount: success, time and actions against none, replans, failures."""
    rows = []
    for setting, group in episodes.groupby(SETTING, sort=True):
        exact = group[group["kind"] == ""]
        for (kind, amount), part in _levels(group):
            time, actions = (against_exact(part, exact, name) for name in ("execution_seconds", "actions_executed"))
            failures = part["failure"].dropna().value_counts()
            rows.append(
                {
                    **dict(zip(SETTING, setting, strict=True)),
                    "noise": f"{kind} {amount:g} {SCALES[kind][0]}" if kind else "none",
                    "success": rate_cell(success_rate(part, "success"), "episodes"),
                    "time": with_spread(time.ratio, time.ratio_interval, time.units, 2),
                    "actions": with_spread(actions.ratio, actions.ratio_interval, actions.units, 2),
                    "planned anew": int((part["replans"] > 0).sum()),
                    "retries": int(part["retries"].sum()),
                    "failures": ", ".join(f"{name} {count}" for name, count in failures.items()) or "–",
                }
            )
    return pd.DataFrame(rows).rename(columns={"label": "planner"})


def _levels(group: pd.DataFrame) -> list[tuple[tuple[str, float], pd.DataFrame]]:
    order = {kind: number for number, kind in enumerate(["", *SCALES])}
    parts = (part for _, part in group.groupby(["kind", "amount"]))
    levels = [((str(part["kind"].iloc[0]), float(part["amount"].iloc[0])), part) for part in parts]
    return sorted(levels, key=lambda level: (order[level[0][0]], level[0][1]))


def draw(episodes: pd.DataFrame, path: Path) -> None:
    """Plot success and time over the amount of each kind of noise, a line a setting; no noise is at 0 everywhere."""
    kinds = [kind for kind in SCALES if (episodes["kind"] == kind).any()]
    figure = Figure(figsize=(2.3 * max(len(kinds), 1) + 0.8, 4.6), layout="constrained")
    FigureCanvasAgg(figure)
    axes = figure.subplots(2, max(len(kinds), 1), squeeze=False, sharey="row", sharex="col")
    for column, kind in enumerate(kinds):
        for setting, group in episodes.groupby(SETTING, sort=True):
            exact = group[group["kind"] == ""]
            chosen = group[group["kind"].isin(["", kind])]
            amounts, parts = zip(*[(amount, part) for (_, amount), part in _levels(chosen)], strict=True)
            rates = [success_rate(part, "success") for part in parts]
            means = np.array([rate.mean for rate in rates])
            spread = np.abs(np.array([rate.interval for rate in rates]).T - means)
            words = ", ".join(map(str, setting))
            axes[0][column].errorbar(amounts, means, yerr=spread, marker="o", markersize=3, capsize=2, label=words)
            times = [against_exact(part, exact, "execution_seconds").ratio for part in parts]
            axes[1][column].plot(amounts, times, marker="o", markersize=3)
        axes[1][column].set_xlabel(f"{kind} [{SCALES[kind][0]}]")
        for axis in axes[:, column]:
            axis.grid(alpha=0.3)
    axes[0][0].set(ylabel="success", ylim=(-0.03, 1.03))
    axes[1][0].set(ylabel="time, share of that without")
    if kinds:
        axes[0][0].legend(fontsize=6, loc="lower left")
    figure.savefig(path, dpi=150)


def make(results: Path, out: Path) -> list[Path]:
    """Write `robustness.md` and `robustness.png`; return the files.

    Raises:
        MalformedFile: where there is nothing to report.
    """
    episodes = read_noisy(results)
    out.mkdir(parents=True, exist_ok=True)
    files = [out / "robustness.md", out / "robustness.png"]
    failed = failure_table(episodes)
    parts = [
        "# Robustness\n",
        f"{len(episodes)} episodes. {LEGEND}\n",
        markdown(robustness_table(episodes)),
        "![Success and time over each kind of noise](robustness.png)\n",
        "## Failures\n",
        markdown(failed) if len(failed) else "None.\n",
    ]
    files[0].write_text("\n".join(parts), encoding="utf-8")
    draw(episodes, files[1])
    return files


def main() -> None:
    """Make the table and the curves and say where they are."""
    command.run("robustness", __doc__, make, "tables")


if __name__ == "__main__":
    main()
