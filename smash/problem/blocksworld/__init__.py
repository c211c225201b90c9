"""Blocks-world problems in PDDL as instances of the testbed."""
