"""A metric: how often a block is picked up, on average over the blocks that are picked up at all."""

from typing import Any


def handling(record: dict[str, Any]) -> float | None:
    """Return the picks per picked block of the best plan (1: none twice); None without a plan."""
    picked = [action[1] for action in record["actions"] or [] if action[0] == "pick"]
    return len(picked) / len(set(picked)) if picked else None
