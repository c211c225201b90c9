"""Within which costs each MILP solver's proofs were tested, behind `smash-flow` and `smash-layered` both."""

from __future__ import annotations

TESTED = {"highs": 1_257_223_104, "cpsat": 19_288, "scip": 19_288, "gurobi": 1_257_223_104}
"""Solver -> the highest sum of costs (`most_sum`) up to which its proofs agreed with this package's own search.

`python -m smash.experiments.studies.engine_ranges` measures it; docs/pddl.md has the table."""
