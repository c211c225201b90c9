"""The paper's Tables I and II as printed, and the metrics that they hold (replanning is ours alone)."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

SIZES = (4, 6, 9)


@dataclass(frozen=True, slots=True)
class Metric:
    """A row of the paper's tables.

    Attributes:
        name: its key here; `title` is its title there.
        column: the episodes' column.
        digits: shown behind the point.
        benchmarks: the tables in which it stands.
        of_plan: whether it tells of the plan, and so of every episode, successful or not.
    """

    name: str
    title: str
    column: str
    digits: int
    benchmarks: tuple[str, ...] = ("single", "multi")
    of_plan: bool = False


METRICS = (
    Metric("success", "Success rate", "success", 2),
    Metric("actions", "Number of actions", "cost", 2, of_plan=True),
    Metric("first", "Initial TP time [s]", "first_plan_seconds", 3, of_plan=True),
    Metric("offline", "Offline MP time [s]", "offline_cpu_seconds", 2),
    Metric("online", "Online MP time [s]", "online_cpu_seconds", 2, ("multi",)),
    Metric("replanning", "Replanning [s]", "task_seconds", 2),
    Metric("execution", "Execution [s]", "execution_seconds", 2),
    Metric("depth", "Goal object depth", "depth", 2, ("single",), of_plan=True),
)

PAPER: Mapping[str, Mapping[str, Mapping[str, tuple[str, str, str]]]] = {
    "single": {
        "success": {"topple": ("1.00", "1.00", "1.00"), "no-topple": ("1.00", "1.00", "1.00")},
        "actions": {
            "topple": ("2.20 ± 0.41", "2.45 ± 0.51", "2.95 ± 1.19"),
            "no-topple": ("2.40 ± 0.82", "3.70 ± 2.27", "5.05 ± 3.49"),
        },
        "first": {
            "topple": ("0.223 ± 0.005", "0.661 ± 0.036", "2.764 ± 0.122"),
            "no-topple": ("0.167 ± 0.007", "0.488 ± 0.043", "3.901 ± 4.060"),
        },
        "offline": {
            "topple": ("0.46 ± 0.03", "0.48 ± 0.05", "0.54 ± 0.06"),
            "no-topple": ("0.54 ± 0.19", "0.82 ± 0.51", "1.15 ± 0.78"),
        },
        "execution": {
            "topple": ("11.06 ± 2.20", "12.50 ± 2.88", "14.05 ± 4.24"),
            "no-topple": ("12.06 ± 4.26", "18.48 ± 11.14", "25.51 ± 17.60"),
        },
        "depth": {
            "topple": ("1.20 ± 0.41", "1.85 ± 1.14", "2.55 ± 1.50"),
            "no-topple": ("1.20 ± 0.41", "1.85 ± 1.14", "2.55 ± 1.50"),
        },
    },
    "multi": {
        "success": {"topple": ("1.00", "0.95", "1.00"), "no-topple": ("1.00", "1.00", "1.00")},
        "actions": {
            "topple": ("8.05 ± 2.01", "12.90 ± 1.45", "20.85 ± 4.21"),
            "no-topple": ("9.90 ± 3.08", "16.80 ± 2.55", "26.00 ± 6.74"),
        },
        "first": {
            "topple": ("0.172 ± 0.005", "0.530 ± 0.021", "3.139 ± 2.305"),
            "no-topple": ("0.132 ± 0.005", "0.528 ± 0.323", "3.389 ± 1.840"),
        },
        "offline": {
            "topple": ("1.12 ± 0.26", "1.60 ± 0.32", "2.97 ± 0.58"),
            "no-topple": ("2.23 ± 0.70", "3.79 ± 0.59", "5.97 ± 1.61"),
        },
        "online": {
            "topple": ("0.77 ± 0.33", "2.00 ± 3.32", "1.71 ± 0.74"),
            "no-topple": ("0.00 ± 0.00", "0.00 ± 0.00", "0.00 ± 0.00"),
        },
        "execution": {
            "topple": ("43.38 ± 12.38", "70.11 ± 10.12", "113.58 ± 25.72"),
            "no-topple": ("49.98 ± 16.03", "84.20 ± 12.97", "129.28 ± 34.81"),
        },
    },
}
"""Benchmark -> metric -> variant -> figures for 4, 6 and 9 blocks."""
