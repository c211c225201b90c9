"""Sequences of numbers: lists where a function is interpreted, numpy arrays where it is compiled."""

from __future__ import annotations

from typing import Any

Ints = Any
"""A mutable sequence of whole numbers; no type says list and array at once."""
Floats = Any
"""A mutable sequence of numbers, likewise."""
