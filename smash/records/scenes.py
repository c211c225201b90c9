"""What was carried out in one scene and what in another, or under another noise or pace, do not make one table."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable

from smash.problem.errors import SmashError

DEFAULT = "default"
"""What the built-in scene is called."""


class MixedScenes(SmashError):
    """Episodes in several scenes or at several paces where those of one make sense."""


def require_one_scene(where: str, scenes: Iterable[str]) -> None:
    """Refuse episodes in several scenes.

    Args:
        where: they are from, for the message.
        scenes: that of each, in words.

    Raises:
        MixedScenes: where there are several.
    """
    counts = Counter(scenes)
    if len(counts) > 1:
        told = ", ".join(f"{count} in {scene}" for scene, count in sorted(counts.items()))
        raise MixedScenes(f"{where}: episodes in several scenes ({told}) make no table; keep each in a directory")
