"""`python -m smash_analysis.engines RESULTS`: the same plans carried out in two physics engines.

RESULTS holds episodes of both (`smash episodes RESULTS --engine NAME`), and RESULTS/landings the directories of
`smash topple-map`, one an engine, where there are any.
"""

from __future__ import annotations

from collections import Counter
from pathlib import Path

import pandas as pd
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure

from smash.problem.errors import MalformedFile
from smash.problem.extras import ENGINES
from smash.problem.words import counted
from smash.records.files import EPISODES
from smash_analysis import command
from smash_analysis.charts.panels import COLOURS
from smash_analysis.engine_landings import LEGEND as LANDINGS_LEGEND
from smash_analysis.engine_landings import (
    outcome_table,
    paired_landings,
    rank_table,
    read_landings,
    unlike_topples,
)
from smash_analysis.execution_sweeps import good_everywhere
from smash_analysis.execution_tables import failure_table, paired_table, told_episodes
from smash_analysis.statistics.intervals import paired
from smash_analysis.tables.believed import records_of
from smash_analysis.tables.writing import RATES, SPREADS, markdown, rate_cell, with_spread

LANDINGS = "landings"
"""Directory of RESULTS with those of the topple maps."""
SETTING = ["suite", "label", "variant", "policy"]
PROBLEM = ["run", "instance", "scene", "seed"]
"""What both engines were given."""
APART = 0.05
"""Share of the time by which two successful episodes of a plan differ, to be listed."""
LEGEND = (
    f"The same plans, seeds and scenes, compared where both engines tried them. {RATES} `time` is execution "
    f"(simulated) in the second engine as a share of that in the first, where both succeed. {SPREADS}"
)


def read_engines(results: Path) -> tuple[tuple[str, str], pd.DataFrame]:
    """Return the two engines, and `told_episodes` of both.

    Raises:
        MalformedFile: where there are no episodes, or those of one engine alone, or they are damaged.
    """
    records = records_of(results, EPISODES)
    by_engine = {name: [record for record in records if record.engine == name] for name in ENGINES}
    there = [name for name, found in by_engine.items() if found]
    if len(there) != 2:
        words = f"episodes by {', '.join(there) or 'none of them'} alone; `smash episodes` with --engine makes others"
        raise MalformedFile(str(EPISODES.path(results)), words)
    episodes = pd.concat([told_episodes(by_engine[name]) for name in there], ignore_index=True)
    return (there[0], there[1]), episodes.assign(scene=episodes["scene"].fillna("default"))


def paired_episodes(episodes: pd.DataFrame, engines: tuple[str, str]) -> pd.DataFrame:
    """Return a row per plan, seed and scene that both engines tried, the engines' columns with `_left`, `_right`."""
    left, right = (episodes[episodes["engine"] == engine] for engine in engines)
    return left.merge(right, on=[*SETTING, *PROBLEM], suffixes=("_left", "_right"))


def engine_table(episodes: pd.DataFrame, engines: tuple[str, str]) -> pd.DataFrame:
    """Return a row per setting: success and failures by name in each engine, execution times on what both carry out."""
    rows = []
    columns = [*PROBLEM, "solved", "execution_seconds"]
    done = episodes.assign(solved=episodes["success"])
    for setting, group in paired_episodes(episodes, engines).groupby(SETTING, sort=True):
        mine = done[(done[SETTING] == list(setting)).all(axis=1)]
        left, right = (mine.loc[mine["engine"] == engine, columns] for engine in engines)
        pair = paired(right, left, PROBLEM, ["instance"], "execution_seconds")
        rows.append(
            {
                **dict(zip(SETTING, setting, strict=True)),
                f"success, {engines[0]}": rate_cell(pair.right_rate, "episode"),
                f"success, {engines[1]}": rate_cell(pair.left_rate, "episode"),
                "in one alone": int((group["success_left"] != group["success_right"]).sum()),
                f"{engines[0]} [s]": f"{pair.right_mean:.1f}" if pair.units else "–",
                f"{engines[1]} [s]": f"{pair.left_mean:.1f}" if pair.units else "–",
                "time": with_spread(pair.ratio, pair.ratio_interval, pair.units, 3),
                f"failures, {engines[0]}": _failures(group["failure_left"]),
                f"failures, {engines[1]}": _failures(group["failure_right"]),
            }
        )
    return pd.DataFrame(rows).rename(columns={"label": "planner"})


def _failures(names: pd.Series[str]) -> str:
    return ", ".join(f"{name} {count}" for name, count in Counter(names.dropna()).most_common()) or "–"


def saved_table(episodes: pd.DataFrame, engines: tuple[str, str]) -> pd.DataFrame:
    """Return what topple saves in each engine, on the plans that succeed in both (`paired_table`)."""
    shared = episodes[good_everywhere(episodes.assign(scene=episodes["engine"]))]
    tables = []
    for engine in engines:
        table = paired_table(shared[shared["engine"] == engine])
        if len(table):
            tables.append(table.assign(engine=engine))
    if not tables:
        return pd.DataFrame()
    table = pd.concat(tables).sort_values(["benchmark", "blocks", "planner", "variant", "policy"], kind="stable")
    first = ["benchmark", "blocks", "engine"]
    return table[[*first, *(c for c in table.columns if c not in first and "success" not in c)]]


def disagreements(episodes: pd.DataFrame, engines: tuple[str, str]) -> pd.DataFrame:
    """Return the episodes that end differently in the two engines, or take `APART` more or less in one of them."""
    pairs = paired_episodes(episodes, engines)
    ends = {engine: _ends(pairs, side) for engine, side in zip(engines, ("left", "right"), strict=True)}
    ratio = pairs["execution_seconds_right"] / pairs["execution_seconds_left"]
    both = pairs["success_left"].astype(bool) & pairs["success_right"].astype(bool)
    unlike = (
        (pairs["success_left"] != pairs["success_right"]).astype(bool)
        | (pairs["failure_left"].fillna("") != pairs["failure_right"].fillna("")).astype(bool)
        | (both & ((ratio - 1).abs() > APART))
    )
    return pd.DataFrame({**{name: pairs[name] for name in ("instance", "seed", "label", "variant", "policy")}, **ends})[
        unlike
    ].sort_values(["instance", "variant", "seed"])


def _ends(pairs: pd.DataFrame, side: str) -> list[str]:
    return [
        f"success in {seconds:.1f} s"
        if success
        else f"{failure}, step {step}: {reason}"
        if pd.notna(step)
        else f"{failure}: {reason}"
        for success, seconds, failure, step, reason in zip(
            *(
                pairs[f"{name}_{side}"]
                for name in ("success", "execution_seconds", "failure", "failure_step", "failure_reason")
            ),
            strict=True,
        )
    ]


def failures(episodes: pd.DataFrame, engines: tuple[str, str]) -> pd.DataFrame:
    """Return every failure in each engine (`failure_table`), those without a pair included."""
    tables = [failure_table(episodes[episodes["engine"] == engine]).assign(engine=engine) for engine in engines]
    return pd.concat([table for table in tables if len(table)] or tables[:1])


def draw(episodes: pd.DataFrame, landings: pd.DataFrame, engines: tuple[str, str], path: Path) -> None:
    """Plot one engine against the other: execution times [s], and where toppled blocks land [cm]."""
    figure = Figure(figsize=(7.0, 3.3), layout="constrained")
    FigureCanvasAgg(figure)
    times, lands = figure.subplots(1, 2)
    pairs = paired_episodes(episodes, engines)
    both = pairs[pairs["success_left"].astype(bool) & pairs["success_right"].astype(bool)]
    for number, (suite, part) in enumerate(both.groupby("suite", sort=True)):
        _points(times, part["execution_seconds_left"], part["execution_seconds_right"], number, str(suite))
    for number, (falling, part) in enumerate(landings.groupby("falling", sort=True)):
        found = part[(part["along_left"].str.len() > 0) & (part["along_right"].str.len() > 0)]
        left, right = (100 * found[side].explode().astype(float) for side in ("along_left", "along_right"))
        _points(lands, left, right, number, f"{falling} falling")
    times.set_title("execution [s]", fontsize=8)
    lands.set_title("landings along the push, by rank [cm]", fontsize=8)
    for axis in (times, lands):
        axis.axline((0, 0), slope=1, color="#888888", linewidth=0.8)
        axis.set(xlabel=engines[0], ylabel=engines[1])
        axis.grid(alpha=0.3)
        if axis.get_legend_handles_labels()[1]:
            axis.legend(fontsize=6)
    figure.savefig(path, dpi=150)


def _points(axis: Axes, across: pd.Series[float], upward: pd.Series[float], number: int, name: str) -> None:
    colour = COLOURS[number % len(COLOURS)]
    axis.plot(across.to_numpy(), upward.to_numpy(), "o", markersize=3, color=colour, label=name)


def make(results: Path, out: Path) -> list[Path]:
    """Write `engines.md` and `engines.png`; return the files.

    Raises:
        MalformedFile: where there is nothing to compare.
    """
    engines, episodes = read_engines(results)
    landings = paired_landings(read_landings(results / LANDINGS), engines)
    out.mkdir(parents=True, exist_ok=True)
    files = [out / "engines.md", out / "engines.png"]
    pairs, unlike = len(paired_episodes(episodes, engines)), disagreements(episodes, engines)
    saved, failed = saved_table(episodes, engines), failures(episodes, engines)
    parts = [
        "# Two engines\n",
        f"{counted(len(episodes), 'episode')}, {counted(pairs, 'pair')}: {engines[0]} first, {engines[1]} "
        f"second. {LEGEND}\n",
        markdown(engine_table(episodes, engines)) if pairs else "No pairs.\n",
        "![One engine against the other](engines.png)\n",
        "## What topple saves in each\n",
        markdown(saved) if len(saved) else "No pairs.\n",
        f"## Disagreements: {len(unlike)} of {pairs}\n",
        f"Other outcomes, or times that are more than {APART:.0%} apart.\n",
        markdown(unlike) if len(unlike) else "None.\n",
        "## Failures\n",
        markdown(failed) if len(failed) else "None.\n",
        *_landing_parts(landings, engines),
    ]
    files[0].write_text("\n".join(parts), encoding="utf-8")
    draw(episodes, landings, engines, files[1])
    return files


def _landing_parts(landings: pd.DataFrame, engines: tuple[str, str]) -> list[str]:
    if landings.empty:
        return []
    unlike = unlike_topples(landings, engines)
    return [
        f"## Landings: {counted(len(landings), 'topple')} in both\n",
        f"{LANDINGS_LEGEND}\n",
        markdown(outcome_table(landings, engines)),
        markdown(rank_table(landings, engines)),
        f"### Topples that go well in one alone: {len(unlike)}\n",
        markdown(unlike) if len(unlike) else "None.\n",
    ]


def main() -> None:
    """Make the table and the chart and say where they are."""
    command.run("engines", __doc__, make, "tables", "engines.md")


if __name__ == "__main__":
    main()
