"""What the executor does where the paper's open pipeline would fail."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class Policy:
    """What is done about failures.

    Attributes:
        repair: Plan a motion again that the observed scene blocks.
        retries: How often a failed pick is tried again.
        replans: How often the task is planned anew; 0 for never.
    """

    repair: bool = True
    retries: int = 2
    replans: int = 8


OPEN = Policy(repair=False, retries=0, replans=0)
"""The paper's pipeline: only gap tasks are planned online, and the first failure ends the episode."""
