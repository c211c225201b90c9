"""What a planner is, for those who write one: the protocol, the settings, the log of incumbents."""

from smash.planners.protocol.planner import (
    MOST_THREADS,
    BasePlanner,
    IncumbentLog,
    OnIncumbent,
    Planner,
    PlanResult,
    Relay,
    SolveOptions,
    Support,
    why_unsupported,
)

__all__ = [
    "MOST_THREADS",
    "BasePlanner",
    "IncumbentLog",
    "OnIncumbent",
    "PlanResult",
    "Planner",
    "Relay",
    "SolveOptions",
    "Support",
    "why_unsupported",
]
