"""Where the hand-written PDDL lies: `domains/` in the tree, package data of `smash_baselines` where it is installed."""

from __future__ import annotations

from smash.problem.files.data import data_folder

DOMAINS = data_folder(__file__, "domains", in_tree="domains")
"""The directory of the domains; its `parts` are put together into the domain of an instance."""
