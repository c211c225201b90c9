"""The law and its files: instances, states, actions, goals, the checker, generators, blocks-world import.

Modules by the names that they had in 0.1 (`smash.problem.topple`, …) are found in `former/`, one line each.
"""

import os

from smash.problem.actions.carry import Carry
from smash.problem.actions.lift import Lift
from smash.problem.actions.topple import Topple
from smash.problem.costs import Costs
from smash.problem.errors import (
    IllegalAction,
    MalformedFile,
    PlannerCrashed,
    PlannerOutOfMemory,
    SmashError,
    Unsupported,
)
from smash.problem.files.instances import read_instance, write_instance
from smash.problem.files.plans import read_plan, write_plan
from smash.problem.making import make_instance
from smash.problem.model import (
    TABLE,
    Action,
    Carrier,
    Goal,
    Instance,
    OnGoal,
    Pick,
    Place,
    PlanOptions,
    PositionsGoal,
    StacksGoal,
    State,
)
from smash.problem.plan import Incumbent, Plan, check_plan
from smash.problem.rules import Law, Verdict

__path__.append(os.path.join(os.path.dirname(__file__), "former"))

__all__ = [
    "TABLE",
    "Action",
    "Carrier",
    "Carry",
    "Costs",
    "Goal",
    "IllegalAction",
    "Incumbent",
    "Instance",
    "Law",
    "Lift",
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
