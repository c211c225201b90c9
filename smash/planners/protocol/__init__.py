"""What a planner is: the protocol, the settings of a solve, the log of incumbents, the methods table.

A planner from outside needs `BasePlanner`, `IncumbentLog`, `PlanResult`, `SolveOptions` and `OnIncumbent`.
"""

from smash.planners.protocol.answer import OnIncumbent, PlanResult
from smash.planners.protocol.clock import SPARE_SECONDS, deadline_of, left
from smash.planners.protocol.log import IncumbentLog, Relay, SolveLog
from smash.planners.protocol.methods import Method, MethodPlanner, anything, not_plain, plain, walk
from smash.planners.protocol.planner import (
    BasePlanner,
    Planner,
    ProblemPlanner,
    ask,
    why_not_settings,
    why_refused,
    why_unsupported,
)
from smash.planners.protocol.settings import (
    ACTIONS,
    HIGHS,
    MOST_THREADS,
    OBJECTIVES,
    SECONDS,
    SOLVERS,
    Settings,
    SolveOptions,
    plan_options,
    settings_of,
)

__all__ = [
    "ACTIONS",
    "HIGHS",
    "MOST_THREADS",
    "OBJECTIVES",
    "SECONDS",
    "SOLVERS",
    "SPARE_SECONDS",
    "BasePlanner",
    "IncumbentLog",
    "Method",
    "MethodPlanner",
    "OnIncumbent",
    "PlanResult",
    "Planner",
    "ProblemPlanner",
    "Relay",
    "Settings",
    "SolveLog",
    "SolveOptions",
    "anything",
    "ask",
    "deadline_of",
    "left",
    "not_plain",
    "plain",
    "plan_options",
    "settings_of",
    "walk",
    "why_not_settings",
    "why_refused",
    "why_unsupported",
]
