"""Search configurations of Fast Downward and SymK, and which of them prove what."""

from __future__ import annotations

from dataclasses import dataclass
from importlib.util import find_spec
from pathlib import Path

_LAMA_FIRST = (
    "let(hlm, eval_modify_costs(landmark_sum(lm_factory=lm_reasonable_orders_hps(lm_rhw()),pref=false),cost_type=one),"
    "let(hff, eval_modify_costs(ff(),cost_type=one),"
    "lazy_greedy([hff,hlm],preferred=[hff,hlm],cost_type=one,reopen_closed=false)))"
)
_LAMA_UNIT_COST = (
    "let(hlm, landmark_sum(lm_reasonable_orders_hps(lm_rhw()),pref=false),"
    "let(hff, ff(),"
    "iterated([lazy_greedy([hff,hlm],preferred=[hff,hlm]),"
    "lazy_wastar([hff,hlm],preferred=[hff,hlm],w=5),"
    "lazy_wastar([hff,hlm],preferred=[hff,hlm],w=3),"
    "lazy_wastar([hff,hlm],preferred=[hff,hlm],w=2),"
    "lazy_wastar([hff,hlm],preferred=[hff,hlm],w=1)],repeat_last=true)))"
)
_LAMA_COSTS = (
    "let(hlm1, eval_modify_costs(landmark_sum(lm_reasonable_orders_hps(lm_rhw()),pref=false),cost_type=one),"
    "let(hff1, eval_modify_costs(ff(),cost_type=one),"
    "let(hlm2, eval_modify_costs(landmark_sum(lm_reasonable_orders_hps(lm_rhw()),pref=false),cost_type=plusone),"
    "let(hff2, eval_modify_costs(ff(),cost_type=plusone),"
    "iterated([lazy_greedy([hff1,hlm1],preferred=[hff1,hlm1],cost_type=one,reopen_closed=false),"
    "lazy_greedy([hff2,hlm2],preferred=[hff2,hlm2],reopen_closed=false),"
    "lazy_wastar([hff2,hlm2],preferred=[hff2,hlm2],w=5),"
    "lazy_wastar([hff2,hlm2],preferred=[hff2,hlm2],w=3),"
    "lazy_wastar([hff2,hlm2],preferred=[hff2,hlm2],w=2),"
    "lazy_wastar([hff2,hlm2],preferred=[hff2,hlm2],w=1)],repeat_last=true)))))"
)

_PREPROCESSING = "PREPROCESSING"
_PREPROCESSING_SECONDS = 8


@dataclass(frozen=True, slots=True)
class Engine:
    """An engine of the Fast Downward family as its wheel bundles it: translator module and search binary."""

    package: str
    folder: str
    translator: str

    @property
    def root(self) -> Path | None:
        """The folder of the built binaries, or None where the package is not installed."""
        spec = find_spec(self.package)
        if spec is None or not spec.submodule_search_locations:
            return None
        root = Path(spec.submodule_search_locations[0]) / self.folder / "builds" / "release" / "bin"
        return root if (root / "downward").exists() else None


FAST_DOWNWARD = Engine("up_fast_downward", "downward", "fast_downward.translate")
SYMK = Engine("up_symk", "symk", "translate")


@dataclass(frozen=True, slots=True)
class Configuration:
    """How an engine searches.

    `admissible`: the search is complete and its costs are optimal, so that its plan is proven optimal, its
    bounds are lower bounds and an exhausted search space proves that there is no plan. Nothing else in the
    testbed may call an engine's answer optimal. `conditional_effects`: it takes the conditional encoding.
    """

    engine: Engine
    search: tuple[str, ...]
    admissible: bool = False
    conditional_effects: bool = False

    def arguments(self, seconds: float) -> list[str]:
        """Return the search arguments for `seconds` of search; preprocessing gets at most a third of them."""
        preprocessing = max(1, min(_PREPROCESSING_SECONDS, int(seconds / 3)))
        return [argument.replace(_PREPROCESSING, str(preprocessing)) for argument in self.search]


LAMA = Configuration(
    FAST_DOWNWARD,
    ("--search", "--if-unit-cost", _LAMA_UNIT_COST, "--if-non-unit-cost", _LAMA_COSTS, "--always"),
    conditional_effects=True,
)
"""The LAMA 2011 configuration in its anytime form, as the alias `lama`."""
LAMA_FIRST = Configuration(FAST_DOWNWARD, ("--search", _LAMA_FIRST), conditional_effects=True)
"""LAMA's first iteration, as the alias `lama-first`."""
LMCUT = Configuration(FAST_DOWNWARD, ("--search", "astar(lmcut())"), admissible=True)
IPDB = Configuration(FAST_DOWNWARD, ("--search", f"astar(ipdb(max_time={_PREPROCESSING}))"), admissible=True)
SYMBOLIC = Configuration(SYMK, ("--search", "sym_bd()"), admissible=True)
"""Symbolic bidirectional blind search."""
