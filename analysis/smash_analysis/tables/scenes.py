"""What an episode was carried out under: scene, noise and pace, as its record tells."""

from __future__ import annotations

import re
import shlex
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from math import degrees

import pandas as pd

from smash.records.episodes import EpisodeRecord
from smash.records.scenes import DEFAULT

SCALES = {
    "pose": ("mm", 1e3),
    "yaw": ("°", degrees(1.0)),
    "camera": ("mm", 1e3),
    "placement": ("mm", 1e3),
    "friction": ("%", 1e2),
    "mass": ("%", 1e2),
    "size": ("mm", 1e3),
}
"""The unit in which a kind of noise is shown, as in the words of a scene, and how many of it one of the records' is."""
SEVERAL = "Scenes, noises and paces are not put together: each stands behind the policy."
"""Of a page whose episodes went through `by_scene`, where there are several."""
_NUMBER = r"\d+(?:\.\d+)?(?:e-?\d+)?"
_AMOUNT = rf"(?:{'|'.join(SCALES)})={_NUMBER}(?:mm|deg|%)"
EXACT = "exact"
"""What the words of a scene say where its own noise was taken away."""
_NOISE = rf"{EXACT}|{_AMOUNT}(?:,{_AMOUNT})*"
_WORDS = re.compile(rf"(?P<base>.+?)(?: (?P<noise>{_NOISE}))?(?: pace=(?P<pace>{_NUMBER}))?", re.DOTALL)


@dataclass(frozen=True, slots=True)
class Conditions:
    """What an episode was carried out under.

    Attributes:
        base: Name of the scene file; `DEFAULT` for the built-in scene.
        noise: Amounts by kind, in the unit of `SCALES` (of a kind that is not there, as recorded); None where nothing
            tells.
        speed: Shares of the arm's velocity and acceleration limits; None where nothing tells.
    """

    base: str
    noise: Mapping[str, float] | None
    speed: tuple[float, float] | None

    @property
    def pace(self) -> str:
        """The speed in words; empty where nothing tells."""
        return "" if self.speed is None else f"{self.speed[0]:g}, {self.speed[1]:g}"

    @property
    def place(self) -> str:
        """Scene and pace in words."""
        return f"{self.base} at {self.pace}" if self.pace else self.base


def scene_words(scene: str | None) -> Conditions:
    """Return what the `scene` of a record says by itself, as in `default pose=3mm,yaw=2deg pace=0.1`."""
    found = _WORDS.fullmatch(scene or DEFAULT)
    assert found is not None  # a base may be any text
    base, words, pace = found["base"], found["noise"], found["pace"]
    noise: dict[str, float] | None = {}
    if words is None:
        noise = {} if base == DEFAULT else None
    elif words != EXACT:
        amounts = (word.split("=") for word in words.split(","))
        noise = {kind: round(float(amount.rstrip("mdeg%")), 2) for kind, amount in amounts}
    return Conditions(base, noise, None if pace is None else (float(pace), float(pace)))


def scene_options(scene: str | None) -> str:
    """Return the options of `smash episodes` that make the `scene` of a record; a scene file by its name alone."""
    found = _WORDS.fullmatch(scene or DEFAULT)
    assert found is not None  # a base may be any text
    named = [] if found["base"] == DEFAULT else ["--scene", f"{found['base']}.toml"]
    named += ["--noise", "pose=0mm" if found["noise"] == EXACT else found["noise"]] if found["noise"] else []
    named += ["--pace", found["pace"]] if found["pace"] else []
    return shlex.join(named)


def conditions(records: Sequence[EpisodeRecord]) -> list[Conditions]:
    """Return what each episode was carried out under: by the words of its scene, else by what the episode says.

    Of one whose process ended without an episode, others in the same scene tell what the words leave open.
    """
    said = [scene_words(record.scene) for record in records]
    noises: dict[str, Mapping[str, float]] = {}
    speeds: dict[str, tuple[float, float]] = {}
    for record, words in zip(records, said, strict=True):
        if record.episode is not None and words.noise is None:
            noises.setdefault(words.base, _amounts(record.episode.noise))
        if record.episode is not None and record.episode.speed is not None and words.speed is None:
            speeds.setdefault(words.base, record.episode.speed)
    found = []
    for record, words in zip(records, said, strict=True):
        own = record.episode
        noise = noises.get(words.base) if own is None else _amounts(own.noise)
        speed = speeds.get(words.base) if own is None else own.speed
        if words.noise is not None and (own is None or words.noise):
            noise = words.noise
        found.append(Conditions(words.base, noise, words.speed or speed))
    return found


def _amounts(noise: Mapping[str, float]) -> dict[str, float]:
    return {kind: round(amount * SCALES.get(kind, ("", 1.0))[1], 2) for kind, amount in noise.items()}


def by_scene(episodes: pd.DataFrame) -> pd.DataFrame:
    """Return the episodes with their scene beside the policy where there are several: no figure is over two scenes."""
    scenes = episodes["scene"].fillna(DEFAULT)
    return episodes.assign(policy=episodes["policy"] + ", " + scenes) if scenes.nunique() > 1 else episodes
