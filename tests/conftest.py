"""Fixtures shared by the rooms."""

import json
from pathlib import Path

import pytest

from tests.experiments import troubled

ROOT = Path(__file__).parent.parent


@pytest.fixture
def third_party(tmp_path, monkeypatch):
    """Install the planners of `troubled` for one test, as a distribution of somebody else's would."""
    site = tmp_path / "site"
    info = site / "troubled-1.0.dist-info"
    info.mkdir(parents=True)
    (info / "METADATA").write_text("Metadata-Version: 2.1\nName: troubled\nVersion: 1.0\n")
    lines = [f"{name} = tests.experiments.troubled:{planner.__name__}" for name, planner in troubled.PLANNERS.items()]
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
