"""Engines of others: Fast Downward, SymK, ENHSP, Aries, each a process with limits."""
