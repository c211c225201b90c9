"""The outcome model of a scene, `smash-outcome-model/1`: what became of topples, and how long motions take.

Lengths are in metres, angles in radians, times in seconds. The trials themselves are in the file, so that a
distribution is what was seen and no curve through it; whoever wants a mean takes it.
"""

from __future__ import annotations

import os
from collections.abc import Mapping
from functools import cache
from importlib.resources import as_file, files
from itertools import combinations_with_replacement
from pathlib import Path
from typing import Annotated, Any, Final, Literal, cast

import msgspec

from smash.problem.errors import MalformedFile, Unsupported
from smash.problem.files.documents import check_format, convert, parse_json, read_bytes, write_text
from smash.problem.model import Instance, OnGoal, PositionsGoal, StacksGoal

MODEL_FORMAT: Final = "smash-outcome-model/1"
DEFAULT_MODEL = "default-model.json"
"""The model of the default scene, beside this module."""

_BASES = ("from_radius", "from_bearing", "from_height", "radius", "bearing", "height", "swing")
FEATURES = (
    *("pick", "place", "lying", "first"),
    *(f"{kind} {name}" for kind in ("pick", "place") for name in _BASES),
    *(f"{one} x {other}" for one, other in combinations_with_replacement(_BASES, 2)),
)
"""Names of what a move's time is a weighted sum of: whence, whither, the swing, for each kind, and their products."""

Length = Annotated[float, msgspec.Meta(ge=-100.0, le=100.0)]
Amount = Annotated[float, msgspec.Meta(ge=0.0, le=1e6)]
Whole = Annotated[int, msgspec.Meta(ge=1, le=1000)]


class Spot(msgspec.Struct, frozen=True, forbid_unknown_fields=True, omit_defaults=True):
    """The place of a location.

    Attributes:
        radius: distance from the robot's base.
        bearing: from there.
        headings: of its topple directions; none where it is not toppled.
        highest: the most blocks of a pile that the place was made for; None where the scene says nothing of it.
        falling: the most blocks that its strips were made for, the same.
    """

    radius: Annotated[float, msgspec.Meta(gt=0.0, le=100.0)]
    bearing: Annotated[float, msgspec.Meta(ge=-10.0, le=10.0)]
    headings: tuple[float, ...] = ()
    highest: Whole | None = None
    falling: Whole | None = None


class Landed(msgspec.Struct, frozen=True, array_like=True, forbid_unknown_fields=True):
    """One toppled block: how far along the push and to its left it lies, and whether it could be grasped at once."""

    along: Length
    aside: Length
    graspable: bool


class Toppled(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """One trial of a topple.

    Attributes:
        height: lowest level that fell, 1 is the bottom.
        falling: how many fell.
        seed: of the trial.
        stands: whether the rest of the pile stood as it should; not where no push was found.
        seconds: what the topple took, from the arm's ready pose until all lay still; 0 where no push was found.
        landed: one per block, from the cut upward; none where no push was found.
    """

    height: Whole
    falling: Whole
    seed: Annotated[int, msgspec.Meta(ge=0)]
    stands: bool
    seconds: Amount
    landed: tuple[Landed, ...]


class MoveTimes(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """How long picks and places take: a linear model (`smash.forecast.durations`).

    Attributes:
        weights: seconds per unit of each of `FEATURES`.
        spread: standard deviation of what the model leaves unexplained [s].
        explained: share of the variance that it explains.
        count: actions that it was fitted to.
    """

    weights: dict[str, float]
    spread: Amount
    explained: Annotated[float, msgspec.Meta(le=1.0)]
    count: Annotated[int, msgspec.Meta(ge=1)]


class OutcomeModel(msgspec.Struct, frozen=True, forbid_unknown_fields=True, kw_only=True):
    """What is known of one scene.

    Attributes:
        scene: its name.
        layout: its fingerprint.
        engine: what simulated the topples; a model that does not say so is from when there was PyBullet alone.
        side: side of a block.
        highest: the most blocks of a pile that the arm can work on.
        ready: where the hand is before the first action.
        ready_height: its height there.
        stacks: places of `stacks`, in order.
        buffers: places of buffers, in order.
        moves: how long picks and places take.
        trouble: seconds that a block costs which cannot be grasped when its turn comes (a new plan, more actions).
        stuck: how often a block was stuck, in rehearsals, where a neighbour of its topple or a pile beside it could be
            in the way: what is foreseen as danger is so much of a risk.
        topples: the trials.
    """

    format: Literal["smash-outcome-model/1"] = "smash-outcome-model/1"
    scene: str
    layout: str
    engine: str = "pybullet"
    side: Annotated[float, msgspec.Meta(gt=0.0, le=1.0)]
    highest: Whole
    ready: Spot
    ready_height: Length
    stacks: tuple[Spot, ...]
    buffers: tuple[Spot, ...]
    moves: MoveTimes
    trouble: Amount
    stuck: Annotated[float, msgspec.Meta(ge=0.0, le=1.0)]
    topples: tuple[Toppled, ...]

    def bind(self, instance: Instance) -> dict[str, Spot]:
        """Give every location of an instance its place, in order.

        Raises:
            Unsupported: where the scene has fewer places, or lower piles, than the instance needs.
        """
        for what, wanted, room in (
            ("stacks", len(instance.stacks), len(self.stacks)),
            ("buffers", len(instance.buffers), len(self.buffers)),
            ("blocks in a pile", _highest(instance), self.highest),
        ):
            if wanted > room:
                raise Unsupported(
                    f"expected times and risk: instance {instance.name!r} has {wanted} {what}; "
                    f"the outcome model of scene {self.scene!r} knows {room}"
                )
        return {
            **dict(zip(instance.stacks, self.stacks, strict=False)),
            **dict(zip(instance.buffers, self.buffers, strict=False)),
        }

    def trials(self, height: int, falling: int) -> tuple[Toppled, ...]:
        """Return the trials of this cut and size; those of the nearest size and cut where it was never tried.

        A push of a whole pile is another motion than one above a rest, so that a cut at the bottom stands for no other
        one where there is a choice.
        """
        cells = _cells(self)
        if not cells:
            return ()

        def far(cell: tuple[int, int]) -> tuple[int, int, int]:
            return abs(cell[1] - falling), (cell[0] == 1) != (height == 1), abs(cell[0] - height)

        return cells[min(cells, key=far)]


def _highest(instance: Instance) -> int:
    """Return how many blocks the highest pile of start and goal has."""
    piles = list(instance.start.values())
    match instance.goal:
        case StacksGoal(stacks):
            piles += stacks.values()
        case PositionsGoal() as goal:
            piles += goal.stacks().values()
        case OnGoal() as goal:
            piles += goal.towers()
    return max(map(len, piles), default=0)


@cache
def _cells_of(topples: tuple[Toppled, ...]) -> Mapping[tuple[int, int], tuple[Toppled, ...]]:
    cells: dict[tuple[int, int], list[Toppled]] = {}
    for trial in topples:
        cells.setdefault((trial.height, trial.falling), []).append(trial)
    return {cell: tuple(trials) for cell, trials in cells.items()}


def _cells(model: OutcomeModel) -> Mapping[tuple[int, int], tuple[Toppled, ...]]:
    return _cells_of(model.topples)


def read_model(path: str | os.PathLike[str]) -> OutcomeModel:
    """Read and check the file of an outcome model.

    Raises:
        MalformedFile: with one line that says where and what is allowed.
    """
    where = os.fspath(path)
    return model_from_document(parse_json(read_bytes(path), where), where)


def model_from_document(document: Any, where: str = "model") -> OutcomeModel:
    """Build a model from a parsed document.

    Raises:
        MalformedFile: with one line that says where and what is allowed.
    """
    check_format(document, where, MODEL_FORMAT)
    model = cast(OutcomeModel, convert(document, OutcomeModel, where))
    for names, problem in (
        (model.moves.weights.keys() - set(FEATURES), "there is no such feature"),
        (set(FEATURES) - model.moves.weights.keys(), "its weight is missing"),
    ):
        if names:
            raise MalformedFile(where, f"`moves.weights`: {min(names)!r}: {problem}")
    return model


@cache
def default_model() -> OutcomeModel:
    """Return the model of the default scene."""
    with as_file(files("smash.forecast").joinpath(DEFAULT_MODEL)) as path:
        return read_model(path)


def write_model(model: OutcomeModel, path: Path) -> None:
    """Write a model, a trial a line."""
    document = msgspec.to_builtins(model)
    trials = ",\n  ".join(msgspec.json.encode(trial).decode() for trial in document.pop("topples"))
    head = ",\n ".join(f'"{key}": {msgspec.json.encode(value).decode()}' for key, value in document.items())
    write_text(path, "{\n " + head + ',\n "topples": [\n  ' + trials + "\n ]\n}\n")
