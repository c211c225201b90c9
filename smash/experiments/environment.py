"""Where a run happened: versions of what took part, the commit of the code, the machine and its load."""

from __future__ import annotations

import os
import platform
import subprocess
import sys
from functools import cache
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path

from smash_baselines.encodings import GROUP as ENCODINGS

from smash.planners.registry import GROUP
from smash.problem.entry_points import entry_points_of
from smash.records.record import Commit, Machine

PACKAGES = (
    "smash-testbed",
    "clingo",
    "didppy",
    "gurobipy",
    "highspy",
    "msgspec",
    "numba",
    "numpy",
    "ortools",
    "psutil",
    "pyscipopt",
    "python-sat",
    "scipy",
    "unified-planning",
    "up-aries",
    "up-enhsp",
    "up-fast-downward",
    "up-symk",
)
"""Distributions that may decide what a planner answers; those installed are recorded with each run."""


@cache
def versions(planner: str) -> dict[str, str]:
    """Return the versions of Python, of `PACKAGES`, and of the distributions that bring `planner`."""
    found = {"python": platform.python_version()}
    for package in PACKAGES:
        try:
            found[package] = version(package)
        except PackageNotFoundError:
            continue
    plain, _, encoding = planner.partition(":")
    for group, name in ((GROUP, planner), (GROUP, plain), (ENCODINGS, encoding)):
        for entry in entry_points_of(group).select(name=name):
            if entry.dist is not None:
                found[entry.dist.name] = entry.dist.version
    return found


@cache
def commit() -> Commit:
    """Return the commit of this code and whether files were changed since (both None outside a repository).

    Asked once in a process: three calls of git would cost a tiny run more than its planner does. Whoever changes the
    code during a sweep mixes two commits under the name of the first.
    """
    here = Path(__file__).parent

    def git(*arguments: str) -> str | None:
        try:
            ended = subprocess.run(["git", *arguments], cwd=here, capture_output=True, text=True, timeout=20)
        except (OSError, subprocess.TimeoutExpired):
            return None
        return ended.stdout.strip() if ended.returncode == 0 else None

    head = git("rev-parse", "HEAD") if git("ls-files", "--error-unmatch", __file__) else None
    changed = git("status", "--porcelain", "--untracked-files=no") if head else None
    return Commit(head, None if changed is None else bool(changed))


@cache
def machine() -> Machine:
    """Return processor, cores, memory [MiB] and system."""
    import psutil

    return Machine(
        processor=_processor(),
        cores=os.cpu_count(),
        usable_cores=len(os.sched_getaffinity(0)) if sys.platform == "linux" else os.cpu_count(),
        memory_mib=psutil.virtual_memory().total // 2**20,
        system=f"{platform.system()} {platform.release()} {platform.machine()}",
    )


def load() -> float:
    """Return the machine's load average over the last minute."""
    return round(os.getloadavg()[0], 2)


def _processor() -> str:
    try:
        for line in Path("/proc/cpuinfo").read_text().splitlines():
            if line.startswith("model name"):
                return line.split(":", 1)[1].strip()
    except OSError:
        pass
    return platform.processor() or "unknown"
