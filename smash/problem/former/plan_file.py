"""`smash.problem.plan_file` of 0.1: `smash.problem.files.plans`."""

from smash.problem.files.plans import (
    PLAN_FORMAT,
    PLAN_FORMAT_2,
    action_from_list,
    action_list,
    plan_document,
    plan_from_document,
    plan_text,
    read_plan,
    write_plan,
)

__all__ = [
    "PLAN_FORMAT",
    "PLAN_FORMAT_2",
    "action_from_list",
    "action_list",
    "plan_document",
    "plan_from_document",
    "plan_text",
    "read_plan",
    "write_plan",
]
