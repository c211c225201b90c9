"""The law and its files: instances, states, actions, goals, the checker, generators, blocks-world import."""

from smash.problem.errors import (
    IllegalAction,
    MalformedFile,
    PlannerCrashed,
    PlannerOutOfMemory,
    SmashError,
    Unsupported,
)
from smash.problem.files import make_instance, read_instance, read_plan, write_instance, write_plan
from smash.problem.model import (
    TABLE,
    Action,
    Goal,
    Instance,
    OnGoal,
    Pick,
    Place,
    PlanOptions,
    PositionsGoal,
    StacksGoal,
    State,
    Topple,
)
from smash.problem.plan import Incumbent, Plan, check_plan
from smash.problem.rules import Law, Verdict

__all__ = [
    "TABLE",
    "Action",
    "Goal",
    "IllegalAction",
    "Incumbent",
    "Instance",
    "Law",
    "MalformedFile",
    "OnGoal",
    "Pick",
    "Place",
    "Plan",
    "PlanOptions",
    "PlannerCrashed",
    "PlannerOutOfMemory",
    "PositionsGoal",
    "SmashError",
    "StacksGoal",
    "State",
    "Topple",
    "Unsupported",
    "Verdict",
    "check_plan",
    "make_instance",
    "read_instance",
    "read_plan",
    "write_instance",
    "write_plan",
]
