"""`smash costs`: durations at several paces make no costs."""

from pathlib import Path

import pytest
from click.testing import CliRunner

from smash.cli.costs import command
from smash.records.scenes import MixedScenes

ROOT = Path(__file__).parents[2]


def test_episodes_at_several_paces_are_refused():
    for name in ("pinocchio", "coal", "toppra"):
        pytest.importorskip(name)
    done = CliRunner().invoke(command, [str(ROOT / "results" / "paces"), str(ROOT / "examples" / "figure1.json")])
    assert isinstance(done.exception, MixedScenes)
    assert "(96 in default, 96 in default pace=0.1, 96 in default pace=0.25)" in str(done.exception)
