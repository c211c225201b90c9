"""`python -m smash_analysis.robustness RESULTS`: success and time of the same plans over each kind of noise.

RESULTS holds episodes without noise and with one kind of it at a time (`smash episodes RESULTS --noise KIND=AMOUNT`).
"""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pandas as pd
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure

from smash.problem.errors import MalformedFile
from smash.problem.words import counted
from smash.records.files import EPISODES
from smash.records.scenes import require_one_scene
from smash_analysis import command
from smash_analysis.execution_tables import failure_table, told_episodes
from smash_analysis.statistics.intervals import Paired, paired, success_rate
from smash_analysis.tables.believed import records_of, say
from smash_analysis.tables.scenes import SCALES, by_scene, conditions
from smash_analysis.tables.writing import RATES, SPREADS, markdown, rate_cell, with_spread

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

    Episodes with several kinds at once are left out, since they lie on no curve, and those without noise at another
    pace than those with it. A plan that was carried out twice under the same, by two names of it, counts once.

    Raises:
        MalformedFile: where there are no episodes, or they are damaged.
        MixedEngines: where they are of several engines.
        MixedScenes: where noise was tried in several scenes or at several paces.
    """
    records = records_of(results, EPISODES)
    known = [pair for pair in zip(records, conditions(records), strict=True) if pair[1].noise is not None]
    single = [
        (record, under) for record, under in known if len(noise := set(under.noise or ())) < 2 and noise <= set(SCALES)
    ]
    if not single:
        raise MalformedFile(str(EPISODES.path(results)), "no episode without noise, or with one kind of it")
    places = [under.place for _, under in single if under.noise] or [under.place for _, under in single]
    require_one_scene(str(results), places)
    here = [(record, under) for record, under in single if under.place == places[0]]
    if left := len(records) - len(here):
        say([f"{counted(left, 'episode')} of another pace, or not of one known kind of noise, left out"])
    noises = [next(iter((under.noise or {}).items()), ("", 0.0)) for _, under in here]
    episodes = told_episodes([record for record, _ in here], str(results))
    episodes = episodes.assign(kind=[kind for kind, _ in noises], amount=[amount for _, amount in noises])
    return episodes.drop_duplicates(["run", "policy", "seed", "kind", "amount"])


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
                    "success": rate_cell(success_rate(part, "success"), "episode"),
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
    lines = {}
    for column, kind in enumerate(kinds):
        for number, (setting, group) in enumerate(episodes.groupby(SETTING, sort=True)):
            if not (group["kind"] == kind).any():
                continue
            look = {"marker": "o", "markersize": 3, "color": f"C{number}"}
            exact = group[group["kind"] == ""]
            chosen = group[group["kind"].isin(["", kind])]
            amounts, parts = zip(*[(amount, part) for (_, amount), part in _levels(chosen)], strict=True)
            rates = [success_rate(part, "success") for part in parts]
            means = np.array([rate.mean for rate in rates])
            spread = np.abs(np.array([rate.interval for rate in rates]).T - means)
            words = ", ".join(map(str, setting))
            lines[words] = axes[0][column].errorbar(amounts, means, yerr=spread, capsize=2, label=words, **look)
            times = [against_exact(part, exact, "execution_seconds").ratio for part in parts]
            axes[1][column].plot(amounts, times, **look)
        axes[1][column].set_xlabel(f"{kind} [{SCALES[kind][0]}]")
        for axis in axes[:, column]:
            axis.grid(alpha=0.3)
    axes[0][0].set(ylabel="success", ylim=(-0.03, 1.03))
    axes[1][0].set(ylabel="time, share of that without")
    if kinds:
        axes[0][0].legend(handles=list(lines.values()), fontsize=6, loc="lower left")
    figure.savefig(path, dpi=150)


def make(results: Path, out: Path) -> list[Path]:
    """Write `robustness.md` and `robustness.png`; return the files.

    Raises:
        MalformedFile: where there is nothing to report.
    """
    episodes = read_noisy(results)
    out.mkdir(parents=True, exist_ok=True)
    files = [out / "robustness.md", out / "robustness.png"]
    failed = failure_table(by_scene(episodes))
    parts = [
        "# Robustness\n",
        f"{counted(len(episodes), 'episode')}. {LEGEND}\n",
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
