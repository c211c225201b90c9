"""Planners of three further paradigms, each with a model of its own: constraint programming, answer sets, DIDP."""
