"""What was run stays beside its records: the experiment as a file, and the instance sets that are no committed ones.

`OUT/experiment.toml` is the experiment, `OUT/instances/sets.json` says in which folder of `OUT/instances` each set lies
that the experiment names by a path. So a results directory can be checked, and run again, wherever it is moved to.
"""

from __future__ import annotations

import json
import re
import shutil
from collections.abc import Iterable
from pathlib import Path
from typing import Any

import msgspec

from smash.experiments.sweeps.experiment import INSTANCES, SETS, Experiment, set_directory
from smash.problem.files.documents import read_bytes, replacing, write_text
from smash.problem.sets.suites import suite_files, suite_names

EXPERIMENT = "experiment.toml"


def keep(experiment: Experiment, base: Path, out: Path, file: Path | None = None) -> None:
    """Write the experiment and its instance sets into the results directory `out`.

    Args:
        experiment: what is run.
        base: where its sets that are directories lie.
        out: the results directory.
        file: the experiment's file, which is copied as it is; without one it is written anew.
    """
    target = out / EXPERIMENT
    if file is None:
        write_text(target, experiment_text(experiment))
    elif file.resolve() != target.resolve():
        _copy_file(file, target)
    folders = _keep_sets(suites(experiment), base, out / INSTANCES)
    if folders:
        write_text(out / INSTANCES / SETS, json.dumps(folders, indent=1) + "\n")


def suites(experiment: Experiment) -> list[str]:
    """Return every set that the experiment or one of its planners names."""
    named = [*experiment.suites, *(suite for entry in experiment.planners for suite in entry.suites or [])]
    return list(dict.fromkeys(named))


def _keep_sets(names: Iterable[str], base: Path, instances: Path) -> dict[str, str]:
    """Copy the sets that are no committed ones; return the folder of each."""
    folders: dict[str, str] = {}
    for suite in names:
        if suite in suite_names():
            continue
        source = set_directory(suite, base)
        folder = re.sub(r"[^A-Za-z0-9._-]+", "-", suite).strip("-.") or "set"
        while folder in folders.values():
            folder += "-2"
        folders[suite] = folder
        if source.resolve() != (instances / folder).resolve():
            _copy(source, instances / folder)
    return folders


def _copy(source: Path, target: Path) -> None:
    files = suite_files(str(source))
    shutil.rmtree(target, ignore_errors=True)
    target.mkdir(parents=True)
    for file in files:
        _copy_file(file, target / file.name)


def _copy_file(source: Path, target: Path) -> None:
    """Copy a file whole or not at all.

    Raises:
        MalformedFile: where it cannot be written (a full disk).
    """
    content = read_bytes(source)
    with replacing(target) as temporary:
        temporary.write_bytes(content)


def experiment_text(experiment: Experiment) -> str:
    """Return an experiment as the TOML file that means it."""
    document = msgspec.to_builtins(experiment)
    lines = [*_settings({name: value for name, value in document.items() if name != "planners"})]
    for entry in document["planners"]:
        lines += ["", "[[planners]]", *_settings(entry)]
    return "\n".join(lines) + "\n"


def _settings(values: dict[str, Any]) -> list[str]:
    """Return `name = value` lines; JSON's strings, numbers and lists of them are TOML's too, null is left out."""
    return [f"{name} = {json.dumps(value, ensure_ascii=False)}" for name, value in values.items() if value is not None]
