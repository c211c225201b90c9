"""Baselines: PDDL encodings and the planners of others behind our one protocol."""
