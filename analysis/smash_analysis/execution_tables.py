"""`python -m smash_analysis.execution_tables RESULTS`: the paper's Tables I and II, our figures beside them."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import pandas as pd

from smash.problem.words import counted
from smash.records.engines import require_alike
from smash.records.episodes import EpisodeRecord
from smash.records.files import EPISODES
from smash_analysis import command
from smash_analysis.statistics.intervals import paired, success_rate
from smash_analysis.tables.believed import records_of
from smash_analysis.tables.episodes import episodes_table
from smash_analysis.tables.latex import write_latex
from smash_analysis.tables.paper_tables import METRICS, PAPER, SIZES, Metric
from smash_analysis.tables.scenes import SEVERAL, by_scene
from smash_analysis.tables.writing import (
    RATES,
    SPREADS,
    markdown,
    mean_std,
    of_seconds,
    rate_cell,
    with_spread,
    write_csv,
)

LEGEND = (
    f"Cells: mean ± std (median) over instances; the paper: mean ± std. {RATES} "
    "Number of actions, initial TP time and depth are of all plans, whether or not they were carried out to the end; "
    "the other times are over successful episodes alone. Times of motion planning (MP) are by the planning thread's "
    "clock, so that other work on the machine does not count; those of task planning (TP) are by the wall's clock, and "
    "so is replanning: the planner's time during an episode, which execution (simulated) does not hold."
)
NAMED = ["disturbed", "touched", "aside"]
"""Blocks that an action names which are no part of it."""
DISTURBED = (
    "Blocks that an action moved by more than 2 cm, or that the arm touched, although the action is not about them; "
    "each counts once for each such action. Records older than these fields hold none."
)
BENCHMARKS = {"single": "Table I: single-goal rearrangement", "multi": "Table II: multi-goal rearrangement"}
WITHOUT = "no-topple"
VARIANTS = {"topple": "w/ topple", "max-topple-4": "w/ topple ≤ 4", WITHOUT: "w/o topple"}
"""Plan variants in the order of the columns, and what they are called there."""


def read_episodes(results: Path) -> pd.DataFrame:
    """Return `told_episodes` of `RESULTS/episodes.jsonl`.

    Raises:
        MalformedFile: where there are none, or they are damaged.
    """
    return told_episodes(records_of(results, EPISODES), str(results))


def told_episodes(records: Sequence[EpisodeRecord], where: str = "the records") -> pd.DataFrame:
    """Return `episodes_table` with `benchmark` (single or multi), and a failure for every loss.

    An episode whose process ended without one has failure `crashed`, and the process's problem for a reason.

    Args:
        records: Of one engine and robot.
        where: They are from, for messages.

    Raises:
        MixedEngines: Where they are of several engines.
        MixedRobots: Where they are of several robots.
    """
    require_alike(where, "episodes", records)
    episodes = episodes_table(records)
    lost = episodes["failure"].isna() & ~episodes["success"]
    return episodes.assign(
        benchmark=episodes["suite"].str.split("-").str[0],
        failure=episodes["failure"].mask(lost, "crashed"),
        failure_reason=episodes["failure_reason"].mask(lost, episodes["problem"]),
    )


def metric_table(episodes: pd.DataFrame, benchmark: str) -> pd.DataFrame:
    """Return the table of one benchmark: a row per metric and source (ours by planner and policy, the paper).

    A column per number of blocks and variant. What tells of plans is over all of them, times are over successful
    episodes; each instance counts once (the mean over its seeds).
    """
    part = episodes[episodes["benchmark"] == benchmark]
    variants = [variant for variant in VARIANTS if variant in set(part["variant"])]
    rows: list[dict[str, str]] = []
    for metric in METRICS:
        if benchmark not in metric.benchmarks:
            continue
        figures = PAPER[benchmark].get(metric.name, {})
        row = {"metric": metric.title, "source": "paper"}
        for index, size in enumerate(SIZES):
            row |= {_column(size, variant): figures.get(variant, ("–",) * 3)[index] for variant in variants}
        rows.append(row)
        for (label, policy), group in part.groupby(["label", "policy"], sort=True):
            row = {"metric": metric.title, "source": f"{label}, {policy}"}
            for size in SIZES:
                for variant in variants:
                    chosen = group[(group["blocks"] == size) & (group["variant"] == variant)]
                    row[_column(size, variant)] = _cell(chosen, metric)
            rows.append(row)
    return pd.DataFrame(rows)


def _column(size: int, variant: str) -> str:
    return f"{size} blocks {VARIANTS[variant]}"


def _cell(group: pd.DataFrame, metric: Metric) -> str:
    if group.empty:
        return "–"
    if metric.name == "success":
        return rate_cell(success_rate(group, "success"), "episode")
    values = group if metric.of_plan else group[group["success"]]
    each = values.groupby("instance")[metric.column].mean().dropna()
    if each.empty:
        return "–"

    def show(values: pd.Series[float]) -> str:
        return f"{mean_std(values, metric.digits)} ({values.median():.{metric.digits}f})"

    return of_seconds(show, each, metric.digits) if metric.column.endswith("_seconds") else show(each)


def paired_table(episodes: pd.DataFrame) -> pd.DataFrame:
    """Return execution time saved by topple: paired by instance, seed, planner and policy, both successful.

    The mean times of replanning on the same pairs stand beside it: execution is simulated and does not hold them.
    """
    setting, problem = ["benchmark", "blocks", "label", "policy"], ["instance", "seed"]
    columns = ["execution_seconds", "task_seconds"]
    done = episodes.assign(solved=episodes["success"])[[*setting, *problem, "variant", "solved", *columns]]
    without = dict(list(done[done["variant"] == WITHOUT].groupby(setting)))
    rows = []
    for (variant, *key), part in done[done["variant"] != WITHOUT].groupby(["variant", *setting]):
        if tuple(key) not in without:
            continue
        pair = paired(without[tuple(key)], part, problem, ["instance"], "execution_seconds")
        replanning = paired(without[tuple(key)], part, problem, ["instance"], "task_seconds")
        benchmark, blocks, label, policy = key
        rows.append(
            {
                "benchmark": benchmark,
                "saved [%]": f"{100 * (1 - 1 / pair.ratio):.0f}" if pair.ratio > 0 else "–",
                "saved [s], mean [95 %] (range)": with_spread(pair.mean, pair.interval, pair.units),
                "blocks": blocks,
                "planner": label,
                "variant": variant,
                "policy": policy,
                "the paper [%]": _paper_saved(str(benchmark), int(str(blocks))),
                "without [s]": f"{pair.left_mean:.1f}" if pair.units else "–",
                "instances": pair.units,
                "success without": rate_cell(pair.left_rate, "episode"),
                "success with": rate_cell(pair.right_rate, "episode"),
                "replanning without, with [s]": f"{replanning.left_mean:.2f}, {replanning.right_mean:.2f}"
                if replanning.units
                else "–",
                "faster, equal, slower": ", ".join(map(str, pair.tally)),
            }
        )
    return pd.DataFrame(rows)


def _paper_saved(benchmark: str, blocks: int) -> str:
    """The share of the paper's mean execution time that topple saved there [%]."""
    if benchmark not in PAPER or blocks not in SIZES:
        return "–"
    figures, column = PAPER[benchmark]["execution"], SIZES.index(blocks)
    with_, without = (float(figures[variant][column].split()[0]) for variant in ("topple", WITHOUT))
    return f"{100 * (1 - with_ / without):.0f}"


def slower_table(episodes: pd.DataFrame) -> pd.DataFrame:
    """Return the pairs in which topple took longer, worst first, with what each side planned and carried out."""
    keys = ["label", "policy", "instance", "seed"]
    columns = ["variant", *keys, "cost", "actions_executed", "replans", "execution_seconds"]
    done = episodes[episodes["success"]][columns]
    sides = done[done["variant"] != WITHOUT].merge(
        done[done["variant"] == WITHOUT].drop(columns="variant"), on=keys, suffixes=("", "_without")
    )
    sides["lost"] = sides["execution_seconds"] - sides["execution_seconds_without"]
    worst = sides[sides["lost"] > 0].sort_values("lost", ascending=False)
    return pd.DataFrame(
        {
            **{column: worst[column] for column in ("instance", "seed", "label", "variant", "policy")},
            "lost [s]": worst["lost"].map("{:.1f}".format),
            "with [s]": worst["execution_seconds"].map("{:.1f}".format),
            "without [s]": worst["execution_seconds_without"].map("{:.1f}".format),
            "planned with, without": _both(worst, "cost"),
            "carried out": _both(worst, "actions_executed"),
            "replans": _both(worst, "replans"),
        }
    )


def _both(sides: pd.DataFrame, column: str) -> list[str]:
    return [f"{a}, {b}" for a, b in zip(sides[column], sides[f"{column}_without"], strict=True)]


def failure_table(episodes: pd.DataFrame) -> pd.DataFrame:
    """Return every failure: how often, by whom, and one example."""
    failed = episodes[~episodes["success"]]
    columns = ["suite", "label", "variant", "policy", "failure"]
    rows = []
    for key, group in failed.groupby(columns):
        first = group.iloc[0]
        example = f"{first['instance']} seed {first['seed']}: {first['failure_reason']}"
        rows.append({**dict(zip(columns, key, strict=True)), "episodes": len(group), "example": example})
    return pd.DataFrame(rows, columns=[*columns, "episodes", "example"])


def disturbed_table(episodes: pd.DataFrame) -> pd.DataFrame:
    """Return a row per setting with blocks that were moved or touched by an action they are no part of.

    `disturbed` and `touched` count such blocks, once for each action that did it; `aside` those that lay on a block
    that was picked, and were set aside first.
    """
    columns = ["suite", "label", "variant", "policy"]
    counts = episodes.assign(episodes=episodes[NAMED].sum(axis=1) > 0)
    table = counts.groupby(columns)[["episodes", *NAMED]].sum().reset_index()
    return table[table["episodes"] > 0]


def make(results: Path, out: Path) -> list[Path]:
    """Write the tables as Markdown and LaTeX, and the episodes as CSV; return the files.

    Raises:
        MalformedFile: where there are no episodes, or they are damaged.
    """
    episodes = read_episodes(results)
    out.mkdir(parents=True, exist_ok=True)
    count = f"{counted(len(episodes), 'episode')}, {int(episodes['success'].sum())} successful."
    parts = ["# Execution\n", f"{count} {LEGEND}\n"]
    files = [out / "episodes.csv", out / "tables.md"]
    write_csv(episodes, files[0])
    if (apart := by_scene(episodes)) is not episodes:
        episodes = apart
        parts.append(f"{SEVERAL}\n")
    for benchmark, title in BENCHMARKS.items():
        if not (episodes["benchmark"] == benchmark).any():
            continue
        table = metric_table(episodes, benchmark)
        parts += [f"## {title}\n", markdown(table)]
        files += write_latex(table, title, f"tab:{benchmark}", out / f"table-{benchmark}")
    paired, failed = paired_table(episodes), failure_table(episodes)
    if len(paired):
        parts += ["## Execution time saved by topple, paired by instance\n", f"{SPREADS}\n", markdown(paired)]
    slower = slower_table(episodes)
    parts += [f"## Where topple took longer: {len(slower)} pairs\n", markdown(slower)] if len(slower) else []
    parts += ["## Failures\n", markdown(failed) if len(failed) else "None.\n"]
    disturbed = disturbed_table(episodes)
    parts += [f"## Moved or touched unmeant\n\n{DISTURBED}\n", markdown(disturbed) if len(disturbed) else "None.\n"]
    files[1].write_text("\n".join(parts), encoding="utf-8")
    return files


def main() -> None:
    """Make the tables and say where they are."""
    command.run("execution_tables", __doc__, make, "tables")


if __name__ == "__main__":
    main()
