"""Where the same topples land in two engines: pair by pair, and by rank of the blocks along the push."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import pandas as pd

from smash.records.files import TRIALS
from smash.records.trials import Trial
from smash_analysis.tables.believed import records_of

TOPPLE = ["layout", "stack", "height", "falling", "seed"]
"""What a topple is, whatever simulates it."""
LEGEND = (
    "The same piles, toppled in both. Rank 1 is the block that lies least far along the push (below zero: on the "
    "other side of the pile); `apart` is how far the two engines' blocks of a rank are from each other, along it. "
    "A topple goes well where the rest still stands and every toppled block can be grasped where it lies."
)


def read_landings(directory: Path) -> list[Trial]:
    """Return the topples of every directory of `smash topple-map` in a directory; none where it is not there.

    Raises:
        MalformedFile: where a file of theirs is damaged.
    """
    places = sorted(file.parent for file in directory.glob(f"*/{TRIALS.name}"))
    return [trial for place in places for trial in records_of(place, TRIALS)]


def paired_landings(trials: Sequence[Trial], engines: tuple[str, str]) -> pd.DataFrame:
    """Return a row per topple that both engines did: `TOPPLE`, and of each engine (`_left`, `_right`) how it went.

    Columns of each: good (whether it went well), stands, moved (of the rest) [m], along (of each block, the least
    first, [m]; empty where there was no push), why (it did not go well).
    """
    sides = []
    for engine in engines:
        rows = [
            {
                **{name: getattr(trial, name) for name in TOPPLE},
                "good": trial.success,
                "stands": trial.stands,
                "moved": trial.moved,
                "along": sorted(landing.along for landing in trial.landings),
                "why": _why(trial),
            }
            for trial in trials
            if trial.engine == engine
        ]
        sides.append(pd.DataFrame(rows, columns=[*TOPPLE, "good", "stands", "moved", "along", "why"]))
    return sides[0].merge(sides[1], on=TOPPLE, suffixes=("_left", "_right"))


def _why(trial: Trial) -> str:
    if trial.success:
        return "goes well"
    if not trial.landings:
        return trial.problem or "no push"
    if not trial.stands:
        return f"the rest does not stand (moved {100 * trial.moved:.1f} cm)"
    lost = [landing for landing in trial.landings if not landing.graspable]
    return "cannot be grasped: " + ", ".join(f"level {block.level} at {100 * block.along:.0f} cm" for block in lost)


def rank_table(pairs: pd.DataFrame, engines: tuple[str, str]) -> pd.DataFrame:
    """Return a row per number of falling blocks and rank: mean landing in each engine, and how far they are apart."""
    rows = []
    for falling, part in pairs.groupby("falling", sort=True):
        both = part[(part["along_left"].str.len() > 0) & (part["along_right"].str.len() > 0)]
        for rank in range(int(str(falling))):
            left, right = (100 * both[side].str[rank].astype(float) for side in ("along_left", "along_right"))
            apart = (left - right).abs()
            rows.append(
                {
                    "falling": falling,
                    "rank": rank + 1,
                    "topples": len(both),
                    f"{engines[0]}, mean ± std [cm]": _spread(left),
                    f"{engines[1]}, mean ± std [cm]": _spread(right),
                    "apart, mean [cm]": f"{apart.mean():.1f}" if len(both) else "–",
                    "greatest [cm]": f"{apart.max():.1f}" if len(both) else "–",
                }
            )
    return pd.DataFrame(rows)


def _spread(values: pd.Series[float]) -> str:
    return f"{values.mean():.1f} ± {values.std(ddof=0):.1f}" if len(values) else "–"


def outcome_table(pairs: pd.DataFrame, engines: tuple[str, str]) -> pd.DataFrame:
    """Return a row per number of falling blocks: how many go well in each engine, in both, in one of them."""
    rows = []
    for falling, part in pairs.groupby("falling", sort=True):
        left, right = part["good_left"].astype(bool), part["good_right"].astype(bool)
        cut = part[part["height"] > 1]
        rows.append(
            {
                "falling": falling,
                "topples": len(part),
                f"go well in {engines[0]}": int(left.sum()),
                f"in {engines[1]}": int(right.sum()),
                "in both": int((left & right).sum()),
                "in one": int((left != right).sum()),
                f"most that the rest moved, {engines[0]} [mm]": _most(cut["moved_left"]),
                f"{engines[1]} [mm]": _most(cut["moved_right"]),
            }
        )
    return pd.DataFrame(rows)


def _most(moved: pd.Series[float]) -> str:
    return f"{1000 * moved.max():.1f}" if len(moved) else "–"


def unlike_topples(pairs: pd.DataFrame, engines: tuple[str, str]) -> pd.DataFrame:
    """Return the topples that go well in one engine alone, and why not in the other."""
    unlike = pairs[pairs["good_left"].astype(bool) != pairs["good_right"].astype(bool)]
    return pd.DataFrame(
        {
            **{name: unlike[name] for name in ("stack", "height", "falling", "seed")},
            engines[0]: unlike["why_left"],
            engines[1]: unlike["why_right"],
        }
    ).sort_values(["falling", "height", "seed"])
