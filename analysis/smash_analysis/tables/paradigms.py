"""Who wins where: planners by paradigm, each paradigm by its best planner, a row a setting."""

from __future__ import annotations

from collections.abc import Mapping
from types import MappingProxyType

import pandas as pd

TOGETHER = "all of ours together"
"""The paradigm of `smash`, which holds several of the others and so is never the one that wins."""
PARADIGMS: Mapping[str, tuple[str, ...]] = MappingProxyType(
    {
        TOGETHER: ("smash",),
        "precedence graph": ("precedence",),
        "MILP": ("smash-layered", "smash-flow"),
        "A*": ("astar",),
        "PDDL, optimal": ("fd-opt", "fd-opt-ipdb", "symk-opt"),
        "PDDL, satisficing": ("fd-lama", "fd-lama-first", "enhsp", "aries"),
        "constraints": ("cp-sat",),
        "answer sets": ("clingo",),
        "dynamic programming": ("didp",),
        "greedy": ("greedy",),
    }
)
"""Paradigm -> planners; any other planner is a paradigm of its own, called as it is."""
SETTING = ["suite", "buffers", "variant"]
WORDS = (
    "Each paradigm by its best planner in that setting: problems proven of all, and the proofs' median seconds since "
    "the call; where it proves none, its mean cost above the proven optimum. "
    f"The one that proves most wins, then the faster one; {TOGETHER} (`smash`) holds several of the others and is left "
    "aside."
)
"""What the table shows, for the page that it stands on."""


def paradigm(planner: str) -> str:
    """Return the paradigm of a planner, whatever its encoding."""
    name = planner.partition(":")[0]
    return next((paradigm for paradigm, planners in PARADIGMS.items() if name in planners), planner)


def paradigm_table(runs: pd.DataFrame) -> pd.DataFrame:
    """Return a row a setting and a column a paradigm: what its best planner proves there, in which median time.

    The best planner proves most, then solves most, then has the least mean `gap`, then the least time. `wins` is
    the paradigm that does, `TOGETHER` left aside. Where a planner proves nothing its cell has the mean gap; shares are
    of the runs, and planners with fewer of them than another in the same setting are not compared.

    Args:
        runs: one row a run, as `comparison.compared` returns them.
    """
    named = runs.assign(paradigm=runs["planner"].map(paradigm))
    order = list(dict.fromkeys([*(name for name in PARADIGMS if name in set(named["paradigm"])), *named["paradigm"]]))
    rows = []
    for setting, part in named.groupby(SETTING, sort=True):
        most = part.groupby("label").size().max()
        ranked: dict[str, tuple[tuple[float, ...], str]] = {}
        for _, mine in part.groupby("label", sort=False):
            name, found = str(mine["paradigm"].iloc[0]), (_rank(mine), _cell(mine))
            if len(mine) == most:
                ranked[name] = min(ranked.get(name, found), found)
        first = min((name for name in order if name in ranked and name != TOGETHER), key=lambda name: ranked[name][0])
        cells = {name: ranked[name][1] if name in ranked else "" for name in order}
        rows.append({**dict(zip(SETTING, setting, strict=True)), **cells, "wins": first})
    return pd.DataFrame(rows)


def _rank(mine: pd.DataFrame) -> tuple[float, ...]:
    """Return what is compared of one planner in one setting, the least is the best."""
    gap = mine["gap"].mean() if mine["gap"].notna().any() else float("inf")
    proven = mine["proven"]
    return (-float(proven.sum()), -float(mine["solved"].sum()), gap, _seconds(mine[proven] if proven.any() else mine))


def _cell(mine: pd.DataFrame) -> str:
    if mine["proven"].any():
        return f"{mine['proven'].sum()}/{len(mine)} in {_shown(_seconds(mine[mine['proven']]))}"
    if not mine["solved"].any():
        return "no plan"
    return f"+{100 * mine['gap'].mean():.0f} %" if mine["gap"].notna().any() else "plans"


def _seconds(mine: pd.DataFrame) -> float:
    """Return the median time of runs: the last plan's where a run ended before its supervisor saw it."""
    return float(mine[["wall_seconds", "best_seconds"]].max(axis=1).median())


def _shown(seconds: float) -> str:
    return f"{seconds:.2f} s" if seconds >= 0.1 else f"{1000 * seconds:.0f} ms"
