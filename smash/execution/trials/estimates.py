"""How often topples go well, `smash-topple-estimates/1`: what execution tells the task layer (the paper's future work).

`smash topple-map` writes the file; `smash plan --estimates FILE` reads it and plans with no topple larger than what can
be trusted. Nothing here loads a simulator.
"""

from __future__ import annotations

import os
from collections.abc import Mapping
from pathlib import Path
from typing import Annotated, Literal, Self, cast

import msgspec

from smash.problem.files.documents import check_format, convert, parse_json, read_bytes, write_text

ESTIMATES_FORMAT = "smash-topple-estimates/1"
TRUSTED = 0.9
"""A topple size is trusted where it and every smaller one succeed this often, ..."""
ENOUGH = 8
"""... in so many trials or more, and at no height of the cut fail more often than not."""


Number = Annotated[str, msgspec.Meta(pattern="^[1-9][0-9]*$")]
"""A whole number from 1 as a JSON key."""


class Rate(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """Outcomes of the trials of one height of the cut and one number of falling blocks."""

    successes: Annotated[int, msgspec.Meta(ge=0)]
    trials: Annotated[int, msgspec.Meta(ge=1)]


class Estimates(msgspec.Struct, frozen=True, forbid_unknown_fields=True, kw_only=True):
    """Success rates of topples.

    Attributes:
        scene: Name of the scene.
        by_cut_and_size: Height of the cut (1 is the bottom) to number of falling blocks to what came of them.
        suggested_max_topple: `trusted_size()`, for readers of the file.
    """

    format: Literal["smash-topple-estimates/1"] = "smash-topple-estimates/1"
    scene: str
    by_cut_and_size: dict[Number, dict[Number, Rate]]
    suggested_max_topple: int = 0

    @classmethod
    def of(cls, scene: str, rates: Mapping[int, Mapping[int, Rate]]) -> Self:
        """Estimates of a scene, the suggestion made from them."""
        by_cut = {str(cut): {str(size): rate for size, rate in by_size.items()} for cut, by_size in rates.items()}
        bare = cls(scene=scene, by_cut_and_size=by_cut)
        return msgspec.structs.replace(bare, suggested_max_topple=bare.trusted_size())

    def trusted_size(self, trust: float = TRUSTED) -> int:
        """The largest number of blocks up to which topples succeed in `trust` of enough trials; or 0."""
        largest = 0
        for size in sorted({size for by_size in self.by_cut_and_size.values() for size in by_size}, key=int):
            rates = [by_size[size] for by_size in self.by_cut_and_size.values() if size in by_size]
            successes, trials = sum(rate.successes for rate in rates), sum(rate.trials for rate in rates)
            if trials < ENOUGH or successes < trust * trials or any(2 * r.successes < r.trials for r in rates):
                break
            largest = int(size)
        return largest


def read_estimates(path: str | os.PathLike[str]) -> Estimates:
    """Read and check an estimates file.

    Raises:
        MalformedFile: with one line that says where and what is allowed.
    """
    where = os.fspath(path)
    document = parse_json(read_bytes(path), where)
    check_format(document, where, ESTIMATES_FORMAT)
    return cast(Estimates, convert(document, Estimates, where))


def write_estimates(estimates: Estimates, path: Path) -> None:
    """Write an estimates file."""
    write_text(path, msgspec.json.format(msgspec.json.encode(estimates), indent=1).decode() + "\n")
