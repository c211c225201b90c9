"""`python -m smash_analysis.paces RESULTS`: what topple saves at other paces of the arm, beside the paper.

RESULTS holds episodes of the same plans at several paces (`smash episodes RESULTS --pace SHARE`). The paper does not
say its pace: seconds an action tell which of ours is like it, and percentages are to be compared at that one.
"""

from __future__ import annotations

from pathlib import Path

import pandas as pd

from smash.problem.errors import MalformedFile
from smash.problem.words import counted
from smash.records.files import EPISODES
from smash.records.scenes import require_one_scene
from smash_analysis import command
from smash_analysis.execution_sweeps import good_everywhere
from smash_analysis.execution_tables import failure_table, paired_table, told_episodes
from smash_analysis.tables.believed import records_of, say
from smash_analysis.tables.paper_tables import PAPER
from smash_analysis.tables.scenes import by_scene, conditions
from smash_analysis.tables.writing import SPREADS, markdown

PACE = "pace"
SECONDS = "seconds an action"
LEGEND = (
    "Execution time saved by topple, paired by instance, at several paces: shares of the arm's velocity and "
    "acceleration limits that motions use. Pushes have speeds of their own at every pace. MoveIt's default is "
    f"0.1, 0.1. {SPREADS}"
)


def read_paces(results: Path) -> pd.DataFrame:
    """Return `told_episodes` without noise, with their pace in words; older records, which do not say it, by the scene.

    A plan that was carried out twice at one pace, under two names of it, counts once.

    Raises:
        MalformedFile: where there are no episodes without noise, or they are damaged.
        MixedEngines: where they are of several engines.
        MixedScenes: where they are in several scenes.
    """
    records = records_of(results, EPISODES)
    found = [pair for pair in zip(records, conditions(records), strict=True) if pair[1].noise == {}]
    if not found:
        raise MalformedFile(str(EPISODES.path(results)), "no episode without noise")
    if len(found) < len(records):
        say([f"{counted(len(records) - len(found), 'episode')} with noise, or not known to be without, left out"])
    require_one_scene(str(results), (under.base for _, under in found))
    episodes = told_episodes([record for record, _ in found], str(results))
    episodes = episodes.assign(**{PACE: [under.pace or under.base for _, under in found]})
    return episodes.drop_duplicates(["run", "policy", "seed", PACE])


def pace_table(episodes: pd.DataFrame) -> pd.DataFrame:
    """Return what topple saves, a row per problem size, setting and pace, and the seconds an action takes."""
    tables = []
    for pace, part in episodes.groupby(PACE, sort=True):
        table = paired_table(part)
        if len(table):
            tables.append(table.assign(**{PACE: pace}))
    if not tables:
        return pd.DataFrame()
    table = pd.concat(tables).sort_values(["benchmark", "blocks", "planner", "variant", "policy", PACE])
    return table[["benchmark", "blocks", PACE, *(c for c in table.columns if c not in ("benchmark", "blocks", PACE))]]


def action_table(episodes: pd.DataFrame) -> pd.DataFrame:
    """Return the simulated seconds that an action takes at each pace, of successful episodes, and the paper's.

    Both are sums of times over sums of actions; the paper's of its means, since it prints no others.
    """
    done = episodes[episodes["success"]]
    rows = [
        {PACE: pace, "variant": variant, SECONDS: _ratio(part), "episodes": str(len(part))}
        for (pace, variant), part in done.groupby([PACE, "variant"], sort=True)
    ]
    variants = sorted(set(done["variant"]) & set(PAPER["multi"]["execution"]))
    rows += [{PACE: "the paper", "variant": v, SECONDS: f"{_paper_seconds(v):.2f}", "episodes": "–"} for v in variants]
    return pd.DataFrame(rows)


def _ratio(part: pd.DataFrame) -> str:
    actions = part["actions_executed"].sum()
    return f"{part['execution_seconds'].sum() / actions:.2f}" if actions else "–"


def _paper_seconds(variant: str) -> float:
    seconds, actions = (
        sum(float(cell.split()[0]) for table in PAPER.values() for cell in table[metric][variant])
        for metric in ("execution", "actions")
    )
    return seconds / actions


def make(results: Path, out: Path) -> list[Path]:
    """Write `paces.md`; return the file in a list.

    Raises:
        MalformedFile: where there is nothing to report.
    """
    episodes = read_paces(results)
    out.mkdir(parents=True, exist_ok=True)
    shared = episodes[good_everywhere(episodes.assign(scene=episodes[PACE]))]
    saved, failed = pace_table(shared), failure_table(by_scene(episodes))
    parts = [
        "# Equal paces\n",
        f"{len(episodes)} episodes, {len(shared)} of them of plans that succeed at every pace: these are compared. "
        f"{LEGEND}\n",
        markdown(saved) if len(saved) else "No pairs.\n",
        "## Seconds an action\n",
        markdown(action_table(shared)),
        "## Failures\n",
        markdown(failed) if len(failed) else "None.\n",
    ]
    file = out / "paces.md"
    file.write_text("\n".join(parts), encoding="utf-8")
    return [file]


def main() -> None:
    """Make the tables and say where they are."""
    command.run("paces", __doc__, make, "tables", "paces.md")


if __name__ == "__main__":
    main()
