"""Fixtures shared by the rooms, and what becomes of tests whose packages are not installed."""

import json
import re
from pathlib import Path

import pytest
from hypothesis import HealthCheck, settings

from smash.problem.extras import EXTRAS, MissingExtra, is_there
from tests.experiments.misbehaving import PLANNERS

ROOT = Path(__file__).parent.parent
# No test of the default run says how long something takes: a busy machine is no fault of what is drawn.
settings.register_profile("unhurried", deadline=None, suppress_health_check=[HealthCheck.too_slow])
settings.load_profile("unhurried")
LACKING = {module: extra for extra, modules in EXTRAS.items() for module in modules if not is_there(module)}
"""Modules that an extra brings and that are not installed here: tests that import them are skipped, and say so."""


class ModuleOfTests(pytest.Module):
    """A file of tests; it is skipped whole where its imports lack a module of an extra."""

    def collect(self):
        """Collect its tests."""
        try:
            return super().collect()
        except self.CollectError as error:
            _skip_without(re.findall(r"No module named '(\w+)", str(error)))
            raise


def _skip_without(modules):
    for module in modules:
        if module in LACKING:
            pytest.skip(f"{module} is not installed (the extra {LACKING[module]})", allow_module_level=True)


def pytest_pycollect_makemodule(module_path, parent):
    """Make every file of tests one that knows of extras."""
    return ModuleOfTests.from_parent(parent, path=module_path)


@pytest.hookimpl(wrapper=True)
def pytest_runtest_call():
    """Skip a test that asks, on its way, for a module of an extra that is not installed."""
    try:
        return (yield)
    except ModuleNotFoundError as error:
        _skip_without([(error.name or "").partition(".")[0]])
        raise
    except MissingExtra as error:
        _skip_without([error.module])
        raise


@pytest.fixture
def third_party(tmp_path, monkeypatch):
    """Install the planners of `troubled` for one test, as a distribution of somebody else's would."""
    site = tmp_path / "site"
    info = site / "troubled-1.0.dist-info"
    info.mkdir(parents=True)
    (info / "METADATA").write_text("Metadata-Version: 2.1\nName: troubled\nVersion: 1.0\n")
    lines = [f"{name} = {planner.__module__}:{planner.__name__}" for name, planner in PLANNERS.items()]
    (info / "entry_points.txt").write_text("\n".join(["[smash.planners]", *lines, ""]))
    monkeypatch.syspath_prepend(str(site))
    monkeypatch.setenv("PYTHONPATH", f"{site}:{ROOT}")


@pytest.fixture
def tower_file(tmp_path):
    """The file of an instance with two blocks on one stack; the lower one must move (optimum 3 with topple)."""
    file = tmp_path / "tower.json"
    document = {
        "format": "smash-instance/1",
        "name": "tower",
        "blocks": ["b1", "b2"],
        "stacks": ["s1", "s2"],
        "buffers": ["u1"],
        "start": {"s1": ["b1", "b2"]},
        "goal": {"kind": "positions", "positions": {"b1": ["s2", 1]}},
    }
    file.write_text(json.dumps(document))
    return file
