"""Blocks-world problems in PDDL as instances of the testbed, and classical plans as plans of it."""

from smash.problem.blocksworld.problem_file import blocksworld_instance, read_blocksworld

__all__ = ["blocksworld_instance", "read_blocksworld"]
