"""Within which numbers each engine's proofs were tested, and so are believed."""

from __future__ import annotations

from smash.planners.protocol.tested import why_doubted
from smash.problem.model import Instance

TESTED = {"fd-opt": 1_257_223_104, "fd-opt-ipdb": 1_257_223_104, "symk-opt": 1_257_223_104}
"""Engine -> the highest sum of costs (`most_sum`) up to which its proofs agreed with this package's own search.

`python -m smash.experiments.studies.engine_ranges` measures it; docs/pddl.md has the table."""


def beyond_tests(engine: str, instance: Instance) -> str | None:
    """Return why what an engine proves of an instance is only its claim, or None where it is believed.

    Args:
        engine: its name, perhaps with an encoding behind a colon.
        instance: what it is asked; where every action costs 1 an engine is believed.
    """
    return why_doubted(engine, instance, TESTED.get(engine.partition(":")[0], 0))
