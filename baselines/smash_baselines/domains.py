"""Where the hand-written PDDL lies: `domains/` in the tree, package data of `smash_baselines` where it is installed."""

from __future__ import annotations

from pathlib import Path

_HERE = Path(__file__).resolve()
_SHIPPED = _HERE.with_name("domains")
DOMAINS = _SHIPPED if _SHIPPED.is_dir() else _HERE.parents[2] / "domains"
"""The directory of the domains; its `parts` are put together into the domain of an instance."""
