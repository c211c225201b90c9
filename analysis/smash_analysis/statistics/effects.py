"""Effects on the same problems: what topple saves, and how planners stand to one another, with coverage beside them."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import pandas as pd

from smash_analysis.statistics.intervals import Paired, paired

WITHOUT = "no-topple"
ANY = "proven optima, any planner"
PROBLEM = ["suite", "buffers", "instance", "seed"]
"""What both sides of a pair have in common, the variant or the planner aside."""
UNIT = ["suite", "instance"]
"""What is drawn by the bootstrap: buffer counts and seeds of one instance are no independent evidence."""
GROUPINGS: tuple[list[str], ...] = (["suite", "buffers"], ["suite"], [])


@dataclass(frozen=True, slots=True)
class Effect:
    """A paired comparison and what it is about: column -> value."""

    about: Mapping[str, str]
    pair: Paired


def proven_optima(runs: pd.DataFrame) -> pd.DataFrame:
    """Return the proven optimal costs as the runs of one more planner, `ANY`: a row per problem and variant.

    Args:
        runs: `smash_analysis.comparison.compared`.
    """
    known = runs.drop_duplicates([*PROBLEM, "variant"]).assign(label=ANY)
    return known.assign(cost=known["optimum"], solved=known["optimum"].notna())


def topple_effects(runs: pd.DataFrame, most: int) -> list[Effect]:
    """Return what topple saves in actions, per planner.

    The left side is without topple, so positive differences are actions saved. Told per suite and buffer count where
    that takes no more than `most` effects, else per suite, else over all.
    """
    for grouping in GROUPINGS:
        effects = _topple_effects(runs, ["label", *grouping])
        if len(effects) <= most:
            break
    return effects


def _topple_effects(runs: pd.DataFrame, group: list[str]) -> list[Effect]:
    columns = [*dict.fromkeys([*group, *PROBLEM]), "solved", "cost"]
    without = dict(list(runs[runs["variant"] == WITHOUT][columns].groupby(group, sort=False)))
    effects = []
    for (variant, *key), part in runs[runs["variant"] != WITHOUT].groupby(["variant", *group], sort=False):
        left = without.get(tuple(key))
        if left is None:
            continue
        pair = paired(left, part[columns], _but(PROBLEM, group), _but(UNIT, group), "cost")
        if pair.problems:
            about = dict(zip(group, map(_plain, key), strict=True)) | {"variant": str(variant)}
            effects.append(Effect(about, pair))
    return effects


def _but(names: list[str], left_out: list[str]) -> list[str]:
    return [name for name in names if name not in left_out]


def _plain(value: object) -> str:
    return f"{value:g}" if isinstance(value, float) else str(value)


def reference_planner(runs: pd.DataFrame) -> str:
    """Return the planner that the others are compared with: most problems solved, then most proven, then the first."""
    totals = runs.groupby("label", sort=False)[["solved", "proven"]].sum()
    return str(totals.sort_values(["solved", "proven"], ascending=False, kind="stable").index[0])


def planner_effects(runs: pd.DataFrame) -> list[Effect]:
    """Return every planner against the reference, per variant; left is the planner, so positive is more actions."""
    reference = reference_planner(runs)
    columns = [*PROBLEM, "solved", "cost"]
    effects = []
    for variant, part in runs.groupby("variant", sort=False):
        right = part[part["label"] == reference][columns]
        for label, mine in part[part["label"] != reference].groupby("label", sort=False):
            pair = paired(mine[columns], right, PROBLEM, UNIT, "cost")
            if pair.problems:
                effects.append(Effect({"planner": str(label), "variant": str(variant)}, pair))
    return effects
