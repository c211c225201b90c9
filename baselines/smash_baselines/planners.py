"""The PDDL baselines behind the planner protocol, as the entry points name them."""

from __future__ import annotations

from smash_baselines.engines.aries import AriesPlanner
from smash_baselines.engines.command import CommandPlanner
from smash_baselines.engines.configurations import IPDB, LAMA, LAMA_FIRST, LMCUT, SYMBOLIC
from smash_baselines.engines.downward import DownwardPlanner
from smash_baselines.engines.enhsp import EnhspPlanner

__all__ = [
    "Aries",
    "CommandPlanner",
    "Enhsp",
    "FdLama",
    "FdLamaChain",
    "FdLamaConditional",
    "FdLamaFirst",
    "FdOpt",
    "FdOptIpdb",
    "SymkOpt",
]


class FdLama(DownwardPlanner):
    """Fast Downward's LAMA, anytime, on the conditional encoding."""

    summary = "Fast Downward LAMA, anytime; topple as one action with conditional effects"
    name = "fd-lama"
    encoding = "conditional"
    falls_back = True
    configuration = LAMA


class FdLamaConditional(FdLama):
    """The same under its full name."""

    name = "fd-lama:conditional"
    falls_back = False


class FdLamaChain(FdLama):
    """LAMA on the STRIPS chain encoding."""

    summary = "Fast Downward LAMA, anytime; topple as a chain of STRIPS actions"
    name = "fd-lama:chain"
    encoding = "chain"
    falls_back = False


class FdLamaFirst(DownwardPlanner):
    """LAMA's first iteration alone."""

    summary = "Fast Downward LAMA, first plan only; topple as one action with conditional effects"
    name = "fd-lama-first"
    encoding = "conditional"
    falls_back = True
    configuration = LAMA_FIRST
    anytime = False


class FdOpt(DownwardPlanner):
    """A* with the landmark-cut heuristic."""

    summary = "Fast Downward A* with LM-cut, optimal; topple as a chain of STRIPS actions"
    name = "fd-opt"
    encoding = "chain"
    configuration = LMCUT
    anytime = False
    proves = True


class FdOptIpdb(DownwardPlanner):
    """A* with pattern databases found by hill climbing."""

    summary = "Fast Downward A* with iPDB, optimal; topple as a chain of STRIPS actions"
    name = "fd-opt-ipdb"
    encoding = "chain"
    configuration = IPDB
    anytime = False
    budget_dependent = True  # the search for patterns gets a share of it
    proves = True


class SymkOpt(DownwardPlanner):
    """Symbolic bidirectional search."""

    summary = "SymK symbolic bidirectional search, optimal; topple as a chain of STRIPS actions"
    name = "symk-opt"
    encoding = "chain"
    configuration = SYMBOLIC
    anytime = False
    proves = True


class Enhsp(EnhspPlanner):
    """ENHSP on the STRIPS chain encoding."""

    summary = "ENHSP, greedy, anytime (needs Java); topple as a chain of STRIPS actions"
    name = "enhsp"
    encoding = "chain"


class Aries(AriesPlanner):
    """Aries on the STRIPS chain encoding."""

    summary = "Aries through unified-planning, anytime; topple as a chain of STRIPS actions"
    name = "aries"
    encoding = "chain"
