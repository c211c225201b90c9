"""`python -m smash_analysis.arms RESULTS`: the same plans carried out by several robots.

RESULTS holds episodes by two robots or more (`smash episodes RESULTS --robot NAME`), perhaps in several engines.
"""

from __future__ import annotations

from collections import Counter
from itertools import product
from pathlib import Path

import pandas as pd

from smash.problem.errors import MalformedFile
from smash.problem.words import counted
from smash.records.files import EPISODES
from smash_analysis import command
from smash_analysis.execution_sweeps import good_everywhere
from smash_analysis.execution_tables import failure_table, paired_table, told_episodes
from smash_analysis.statistics.intervals import paired, success_rate
from smash_analysis.tables.believed import records_of
from smash_analysis.tables.writing import RATES, SPREADS, markdown, rate_cell, with_spread

SETTING = ["suite", "label", "variant", "policy", "engine"]
PROBLEM = ["run", "instance", "scene", "seed"]
"""What every robot was given."""
SHARE = "time"
LEGEND = (
    f"{RATES} `time` is execution (simulated) as a share of that of the first robot, on the plans that both carry out. "
    f"{SPREADS}"
)


def read_arms(results: Path) -> tuple[list[str], pd.DataFrame]:
    """Return the robots, the one that tried most first, and `told_episodes` of all.

    Raises:
        MalformedFile: where there are no episodes, or those of one robot alone, or they are damaged.
    """
    records = records_of(results, EPISODES)
    counts = Counter(record.robot for record in records)
    if len(counts) < 2:
        words = f"episodes by {', '.join(counts) or 'no robot'} alone; `smash episodes` with --robot makes others"
        raise MalformedFile(str(EPISODES.path(results)), words)
    robots = [name for name, _ in sorted(counts.items(), key=lambda entry: (-entry[1], entry[0]))]
    tables = []
    for robot, engine in product(robots, sorted({record.engine for record in records})):
        mine = [record for record in records if (record.robot, record.engine) == (robot, engine)]
        if mine:
            tables.append(told_episodes(mine, str(results)))
    episodes = pd.concat(tables, ignore_index=True)
    return robots, episodes.assign(scene=episodes["scene"].fillna("default"))


def arm_table(episodes: pd.DataFrame, robots: list[str]) -> pd.DataFrame:
    """Return a row per setting and robot: success, failures by name, execution times beside those of the first."""
    rows = []
    done = episodes.assign(solved=episodes["success"])
    columns = [*PROBLEM, "solved", "execution_seconds"]
    for setting, group in done.groupby(SETTING, sort=True):
        first = group.loc[group["robot"] == robots[0], columns]
        for robot in robots:
            mine = group[group["robot"] == robot]
            if mine.empty:
                continue
            pair = paired(mine[columns], first, PROBLEM, ["instance"], "execution_seconds")
            rows.append(
                {
                    **dict(zip(SETTING, setting, strict=True)),
                    "robot": robot,
                    "success": rate_cell(success_rate(mine, "success"), "episode"),
                    "execution [s]": f"{pair.left_mean:.1f}" if pair.units else "–",
                    SHARE: "1" if robot == robots[0] else with_spread(pair.ratio, pair.ratio_interval, pair.units, 2),
                    "failures": _failures(mine["failure"]),
                }
            )
    return pd.DataFrame(rows).rename(columns={"label": "planner"})


def _failures(names: pd.Series[str]) -> str:
    return ", ".join(f"{name} {count}" for name, count in Counter(names.dropna()).most_common()) or "–"


def saved_table(episodes: pd.DataFrame, robots: list[str]) -> pd.DataFrame:
    """Return what topple saves with each robot, on the plans that succeed with all of them (`paired_table`)."""
    tables = []
    for engine, part in episodes.groupby("engine", sort=True):
        shared = part[good_everywhere(part.assign(scene=part["robot"]))]
        for robot in robots:
            table = paired_table(shared[shared["robot"] == robot])
            if len(table):
                tables.append(table.assign(engine=engine, robot=robot))
    if not tables:
        return pd.DataFrame()
    table = pd.concat(tables).sort_values(["engine", "benchmark", "blocks", "planner", "variant"], kind="stable")
    first = ["engine", "benchmark", "blocks", "robot"]
    return table[[*first, *(c for c in table.columns if c not in first and "success" not in c)]]


def make(results: Path, out: Path) -> list[Path]:
    """Write `arms.md`; return the file in a list.

    Raises:
        MalformedFile: where there is nothing to compare.
    """
    robots, episodes = read_arms(results)
    out.mkdir(parents=True, exist_ok=True)
    saved = saved_table(episodes, robots)
    failed = pd.concat(
        [failure_table(part).assign(robot=robot, engine=engine) for (robot, engine), part in _by_robot(episodes)]
    )
    parts = [
        "# Several robots\n",
        f"{counted(len(episodes), 'episode')} by {', '.join(robots)}. {LEGEND}\n",
        markdown(arm_table(episodes, robots)),
        "## What topple saves with each\n",
        "On the plans that all of them carry out.\n",
        markdown(saved) if len(saved) else "No pairs.\n",
        "## Failures\n",
        markdown(failed) if len(failed) else "None.\n",
    ]
    file = out / "arms.md"
    file.write_text("\n".join(parts), encoding="utf-8")
    return [file]


def _by_robot(episodes: pd.DataFrame) -> list[tuple[tuple[str, str], pd.DataFrame]]:
    groups = episodes.groupby(["robot", "engine"], sort=False)
    return [((str(robot), str(engine)), part) for (robot, engine), part in groups]


def main() -> None:
    """Make the table and say where it is."""
    command.run("arms", __doc__, make, shown="arms.md")


if __name__ == "__main__":
    main()
