"""`python -m smash_analysis.forecasts RESULTS`: what plans for seconds were expected to take, and what they took."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import product
from pathlib import Path

import numpy as np
import pandas as pd

from smash.problem.errors import MalformedFile
from smash.problem.words import counted
from smash.records.files import EPISODES
from smash.records.runs import RunRecord
from smash_analysis import command
from smash_analysis.charts.panels import Chart, Panel, curves
from smash_analysis.execution_tables import WITHOUT, read_episodes
from smash_analysis.statistics.intervals import bootstrap, bootstrap_ratio
from smash_analysis.tables.believed import runs_of, say
from smash_analysis.tables.writing import SPREADS, markdown, with_spread

LEGEND = (
    "Times are simulated, of successful episodes in the built-in scene as it is, which the forecasts are about. An "
    "error is an episode's expected seconds against what it took; means and medians are over episodes."
)
SAVED = (
    "Of one planner, on the instances and seeds that it carried out both ways; each instance counts once (the mean "
    f"over its seeds). {SPREADS}"
)
SECONDS, ACTIONS = "seconds", "actions"
TOLERATED = 1.05
"""A plan that takes more than this share of the time of the one without topple has lost by it."""


def read_default(results: Path) -> pd.DataFrame:
    """Return `told_episodes` of the built-in scene as it is: forecasts know no other scene, noise or pace.

    Raises:
        MalformedFile: where there are none, or they are damaged.
        MixedEngines: where they are of several engines.
    """
    episodes = read_episodes(results)
    default = episodes[episodes["scene"].isna()]
    if len(default) < len(episodes):
        say([f"{counted(len(episodes) - len(default), 'episode')} in another scene, noise or pace left out"])
    return default


def forecast_table(runs: Sequence[RunRecord], episodes: pd.DataFrame) -> pd.DataFrame:
    """Return a row per successful episode of a plan that says what it is expected to take [s].

    Columns: suite, instance, label, variant, policy, seed, replans, expected, taken, error (a share of what it took).
    """
    said = {run.key: run.expected_seconds for run in runs if run.expected_seconds is not None}
    part = episodes[episodes["run"].isin(list(said)) & episodes["success"]]
    table = part[["suite", "instance", "label", "variant", "policy", "seed", "replans"]].assign(
        expected=part["run"].map(said).astype("float64"), taken=part["execution_seconds"]
    )
    return table.assign(error=table["expected"] / table["taken"] - 1).reset_index(drop=True)


def error_table(forecasts: pd.DataFrame) -> pd.DataFrame:
    """Return the errors of the forecasts by set, planner, variant and policy [%]."""
    rows = []
    for key, part in forecasts.groupby(["suite", "label", "variant", "policy"]):
        off = 100 * part["error"]
        rows.append(
            {
                **dict(zip(("suite", "planner", "variant", "policy"), key, strict=True)),
                "episodes": len(part),
                "planned anew": int((part["replans"] > 0).sum()),
                "expected [s]": f"{part['expected'].mean():.1f}",
                "taken [s]": f"{part['taken'].mean():.1f}",
                "median error [%]": f"{off.median():+.1f}",
                "median absolute error [%]": f"{off.abs().median():.1f}",
                "greatest [%]": f"{off.abs().max():.1f}",
            }
        )
    return pd.DataFrame(rows)


def objective_table(runs: Sequence[RunRecord], episodes: pd.DataFrame) -> pd.DataFrame:
    """Return what topple saves against the plan without it that has the fewest actions, by planner and objective.

    Of planners that plan for seconds, too. One row per set, planner (by its label), policy and objective; for seconds
    another one against the plan without topple that is fastest. Labels are set against others only across objectives.
    """
    by_key = {run.key: run for run in runs}
    timed = {run.planner for run in runs if run.objective == SECONDS}
    done = episodes[episodes["success"] & episodes["run"].isin(list(by_key))]
    done = done.assign(
        planner=[by_key[key].planner for key in done["run"]], objective=[by_key[key].objective for key in done["run"]]
    )
    rows = []
    for (suite, _, policy), part in done[done["planner"].isin(list(timed))].groupby(["suite", "planner", "policy"]):
        sides = dict(list(part.groupby(["variant", "objective", "label"])))
        for chosen, against in ((ACTIONS, ACTIONS), (SECONDS, ACTIONS), (SECONDS, SECONDS)):
            for label, base in product(sorted(set(part["label"])), repeat=2):
                with_, without = sides.get(("topple", chosen, label)), sides.get((WITHOUT, against, base))
                if with_ is None or without is None or (chosen == against and label != base):
                    continue
                pair = with_.merge(without, on=["instance", "seed"], suffixes=("", "_without"))
                if len(pair):
                    each = pair.groupby("instance")[["execution_seconds", "execution_seconds_without"]].mean()
                    who = {"suite": suite, "planner": label, "planner without": base, "policy": policy}
                    rows.append({**who, **_saved(each, chosen, against)})
    return pd.DataFrame(rows)


def _saved(each: pd.DataFrame, chosen: str, against: str) -> dict[str, object]:
    """Return the columns of what is saved, of one row per instance: with topple and without [s]."""
    with_, without = (each[name].to_numpy() for name in ("execution_seconds", "execution_seconds_without"))
    saved, ends = without - with_, bootstrap_ratio(with_, without)
    share = tuple(100 * (1 - end) for end in reversed(ends))
    worst = each.index[int(np.argmax(with_ / without))]
    return {
        "with topple, fewest": chosen,
        "without, fewest": against,
        "instances": len(each),
        "without [s]": f"{without.mean():.1f}",
        "with [s]": f"{with_.mean():.1f}",
        "saved [s], mean [95 %] (range)": with_spread(float(saved.mean()), bootstrap(saved), len(each)),
        "saved [%]": with_spread(100 * (1 - with_.mean() / without.mean()), (share[0], share[1]), len(each)),
        "slower by more than 5 %": int((with_ > TOLERATED * without).sum()),
        "worst": f"{worst}: {100 * (1 - float((with_ / without).max())):+.0f} %",
    }


def chart(forecasts: pd.DataFrame) -> Chart:
    """Return expected against taken seconds, a panel per set."""
    looks = curves(sorted(set(forecasts["variant"])))

    def panel(suite: str) -> Panel:
        part = forecasts[forecasts["suite"] == suite]
        most = 1.08 * float(max(part["expected"].max(), part["taken"].max()))
        least = 0.9 * float(min(part["expected"].min(), part["taken"].min()))

        def draw(axis: object) -> None:
            axis.plot([least, most], [least, most], color="#888888", linewidth=0.8)  # type: ignore[attr-defined]
            for look in looks:
                points = part[part["variant"] == look.name]
                axis.plot(  # type: ignore[attr-defined]
                    points["taken"], points["expected"], "o", markersize=3.5, color=look.colour, label=look.name
                )

        off = 100 * part["error"].abs().median()
        return Panel(f"{suite}: {counted(len(part), 'episode')}, median error {off:.1f} %", draw)

    suites = sorted(set(forecasts["suite"]))
    return Chart([[panel(suite) for suite in suites]], "taken [s]", "expected [s]", looks)


def make(results: Path, out: Path) -> list[Path]:
    """Write forecasts.md and forecasts.png; return the files.

    Raises:
        MalformedFile: where there are no episodes of plans for seconds, or records are damaged.
    """
    runs, episodes = runs_of(results), read_default(results)
    forecasts = forecast_table(runs, episodes)
    if forecasts.empty:
        words = (
            "no successful episode, in the built-in scene, of a plan for seconds; a planner with "
            '`objective = "seconds"` makes such plans'
        )
        raise MalformedFile(str(EPISODES.path(results)), words)
    out.mkdir(parents=True, exist_ok=True)
    files = [out / "forecasts.md", out / "forecasts.png"]
    saved = objective_table(runs, episodes)
    parts = ["# Forecasts\n", f"{LEGEND}\n", markdown(error_table(forecasts))]
    parts += ["## What topple saves\n", f"{SAVED}\n", markdown(saved)] if len(saved) else []
    files[0].write_text("\n".join(parts), encoding="utf-8")
    chart(forecasts).figure().savefig(files[1], dpi=150)
    return files


def main() -> None:
    """Make the files and say where they are."""
    command.run("forecasts", __doc__, make, shown="forecasts.md")


if __name__ == "__main__":
    main()
