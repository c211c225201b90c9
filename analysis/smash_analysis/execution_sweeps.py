"""`python -m smash_analysis.execution_sweeps RESULTS MAPS...`: what friction and the size of a topple do to execution.

RESULTS holds the episodes of the same plans in scenes of different friction, MAPS are directories of
`smash topple-map`, one a scene.
"""

from __future__ import annotations

import argparse
from collections.abc import Sequence
from pathlib import Path

import numpy as np
import pandas as pd
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure

from smash.problem.errors import SmashError
from smash.problem.words import counted
from smash.records.engines import require_alike
from smash.records.files import TRIALS
from smash.records.scenes import DEFAULT
from smash_analysis.command import fail
from smash_analysis.execution_tables import WITHOUT, paired_table, read_episodes
from smash_analysis.statistics.intervals import success_rate, wilson
from smash_analysis.tables.believed import records_of
from smash_analysis.tables.writing import RATES, SPREADS, markdown, rate_cell

SETTING = ["benchmark", "blocks", "label", "variant", "policy"]
"""What episodes have in common that are compared between scenes."""
LEGEND = (
    f"Scenes differ in the friction of blocks on blocks (in their names; `default` is 0.20). {RATES} "
    "Scenes are compared on the same problems: actions carried out and execution (simulated seconds) are means over "
    "instances, on the instances and seeds that are successful in all scenes; `compared on` says how many. Planned "
    "actions are of all plans."
)


def scene_table(episodes: pd.DataFrame) -> pd.DataFrame:
    """Return a row per scene and setting: success and replans of all episodes, means on what all scenes share."""
    rows = []
    keys = ["scene", *SETTING]
    everywhere = good_everywhere(episodes)
    for key, group in episodes.groupby(keys, sort=True):
        shared = group[everywhere[group.index]]
        rows.append(
            {
                **dict(zip(keys, key, strict=True)),
                "success": rate_cell(success_rate(group, "success"), "episode"),
                "planned actions": _mean(group, "cost"),
                "replans": int(group["replans"].sum()),
                "compared on, instances (episodes)": f"{shared['instance'].nunique()} ({len(shared)})",
                "carried out": _mean(shared, "actions_executed"),
                "execution [s]": _mean(shared, "execution_seconds"),
            }
        )
    return pd.DataFrame(rows).rename(columns={"label": "planner"})


def good_everywhere(episodes: pd.DataFrame) -> pd.Series[bool]:
    """Return for each episode whether its instance and seed succeed in every scene in which its setting was tried."""
    tried = episodes.groupby(SETTING)["scene"].transform("nunique")
    won = episodes.assign(won=episodes["scene"].where(episodes["success"]))
    return won.groupby([*SETTING, "instance", "seed"])["won"].transform("nunique") == tried


def _mean(episodes: pd.DataFrame, column: str) -> str:
    """Return the mean over instances of each one's mean over its seeds."""
    return f"{episodes.groupby('instance')[column].mean().mean():.1f}" if len(episodes) else "–"


def saved_table(episodes: pd.DataFrame) -> pd.DataFrame:
    """Return the time that topple saves in each scene, paired by instance (see `execution_tables.paired_table`)."""
    tables = []
    for scene, part in episodes.groupby("scene", sort=True):
        if WITHOUT in set(part["variant"]):
            tables.append(paired_table(part).assign(scene=scene))
    table = pd.concat(tables) if tables else pd.DataFrame()
    return table[["scene", *(column for column in table.columns if column != "scene")]] if len(table) else table


def read_trials(directories: Sequence[Path]) -> pd.DataFrame:
    """Return one row a topple of some `smash topple-map` directories.

    Columns: scene, height (of the cut), falling, seed, success, stands, moved (of the rest below the cut) [m],
    farthest (landing along the push) [m].

    Raises:
        MalformedFile: where a directory has none, or they are damaged.
        MixedEngines: where they were simulated by several engines.
        MixedRobots: where they were done by several robots.
    """
    trials = [trial for directory in directories for trial in records_of(directory, TRIALS)]
    require_alike(", ".join(map(str, directories)), "topples", trials)
    kept = ("scene", "height", "falling", "seed", "stands", "moved")
    return pd.DataFrame(
        {
            **{name: getattr(trial, name) for name in kept},
            "success": trial.success,
            "farthest": max((landing.along for landing in trial.landings), default=float("nan")),
        }
        for trial in trials
    )


def size_table(trials: pd.DataFrame) -> pd.DataFrame:
    """Return a row per scene, a column per number of falling blocks: successes of trials, with the Wilson interval."""
    rows = []
    for scene, part in trials.groupby("scene", sort=True):
        row: dict[str, str] = {"scene": str(scene)}
        for falling, group in part.groupby("falling", sort=True):
            low, high = wilson(int(group["success"].sum()), len(group))
            row[f"{falling} falling"] = f"{int(group['success'].sum())}/{len(group)} [{low:.2f}, {high:.2f}]"
        rows.append(row)
    return pd.DataFrame(rows).fillna("–")


def draw_sizes(trials: pd.DataFrame, path: Path) -> None:
    """Plot success, farthest landing and displacement of the rest over the number of falling blocks, a line a scene."""
    figure = Figure(figsize=(10.5, 3.2), layout="constrained")
    FigureCanvasAgg(figure)
    axes = figure.subplots(1, 3)
    scenes = sorted(trials["scene"].unique())
    for number, scene in enumerate(scenes):
        part = trials[trials["scene"] == scene]
        offset = 0.06 * (number - (len(scenes) - 1) / 2)
        by_size = part.groupby("falling")
        success = by_size["success"].agg(["sum", "size"])
        bounds = np.array([wilson(int(s), int(n)) for s, n in success.to_numpy()])
        share = (success["sum"] / success["size"]).to_numpy(dtype=float)
        spread = np.abs(bounds.T - share)
        axes[0].errorbar(success.index + offset, share, yerr=spread, marker="o", markersize=3, capsize=2, label=scene)
        axes[1].plot(by_size["farthest"].mean().index, 100 * by_size["farthest"].mean(), marker="o", markersize=3)
        lower = part[part["height"] > 1].groupby("falling")["moved"].max()
        axes[2].plot(lower.index, 1000 * lower, marker="o", markersize=3)
    axes[0].set(ylabel="topples that went well", ylim=(-0.03, 1.03))
    axes[1].set(ylabel="farthest landing, mean [cm]", ylim=(0, None))
    axes[2].set(ylabel="most that the rest moved [mm]", ylim=(0, None))
    for axis in axes:
        axis.set_xlabel("falling blocks")
        axis.set_xticks(sorted(trials["falling"].unique()))
        axis.grid(alpha=0.3)
    axes[0].legend(fontsize=7, title="scene", title_fontsize=7)
    figure.savefig(path, dpi=150)


def make(results: Path, maps: Sequence[Path], out: Path) -> list[Path]:
    """Write `sweeps.md`, and `sizes.png` where there are maps; return the files.

    Raises:
        MalformedFile: where there is nothing to report.
    """
    episodes = read_episodes(results)
    episodes["scene"] = episodes["scene"].fillna(DEFAULT)
    out.mkdir(parents=True, exist_ok=True)
    parts = ["# Friction\n", f"{counted(len(episodes), 'episode')}. {LEGEND}\n", markdown(scene_table(episodes))]
    saved = saved_table(episodes)
    if len(saved):
        parts += ["## Execution time saved by topple, paired by instance\n", f"{SPREADS}\n", markdown(saved)]
    files = [out / "sweeps.md"]
    if maps:
        trials = read_trials(maps)
        parts += ["# Size of the topple\n", _size_legend(trials), markdown(size_table(trials))]
        parts += ["![Success, reach and displacement by size](sizes.png)\n"]
        files.append(out / "sizes.png")
        draw_sizes(trials, files[-1])
    files[0].write_text("\n".join(parts), encoding="utf-8")
    return files


def _size_legend(trials: pd.DataFrame) -> str:
    heights = ", ".join(str(height) for height in sorted(trials["height"].unique()))
    return (
        f"{len(trials)} topples, cuts at heights {heights}. One went well where the rest still stands and every "
        "toppled block can be grasped where it lies, before anything is cleared.\n"
    )


def main() -> None:
    """Make the tables and say where they are."""
    parser = argparse.ArgumentParser(prog="python -m smash_analysis.execution_sweeps", description=__doc__)
    parser.add_argument("results", type=Path, help="directory with episodes.jsonl")
    parser.add_argument("maps", type=Path, nargs="*", help="directories with trials.jsonl")
    parser.add_argument("--out", type=Path, help="default: RESULTS/tables")
    arguments = parser.parse_args()
    try:
        files = make(arguments.results, arguments.maps, arguments.out or arguments.results / "tables")
    except SmashError as error:
        fail(error)
    print("\n".join(str(file) for file in files))


if __name__ == "__main__":
    main()
