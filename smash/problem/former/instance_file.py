"""`smash.problem.instance_file` of 0.1: `smash.problem.files.instances`."""

from smash.problem.files.instances import (
    GOAL_KEYS,
    INSTANCE_FORMAT,
    INSTANCE_FORMAT_2,
    instance_document,
    instance_from_document,
    read_instance,
    write_instance,
)
from smash.problem.making import make_instance

__all__ = [
    "GOAL_KEYS",
    "INSTANCE_FORMAT",
    "INSTANCE_FORMAT_2",
    "instance_document",
    "instance_from_document",
    "make_instance",
    "read_instance",
    "write_instance",
]
