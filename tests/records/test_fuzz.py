"""Damaged and odd records: whatever stands in a line, every reader names it or shows it, and none breaks."""

import json
import random

import pytest
from click.testing import CliRunner

from smash.cli import smash
from smash.problem.errors import SmashError
from tests.analysis.made_up import small_sweep, write
from tests.fuzz.damage import changed, spoiled


def fuzzed(directory, seed, count):
    draw = random.Random(seed)
    runs = [run.document for run in small_sweep()]
    lines = [json.dumps(run).encode() for run in runs]
    for number in range(count):
        odd = changed(draw.choice(runs), draw)
        line = json.dumps(odd | {"key": f"odd-{number}"} if isinstance(odd, dict) else odd).encode()
        lines.append(spoiled(line, draw) if draw.random() < 0.1 else line)
    write(directory, [])
    (directory / "runs.jsonl").write_bytes(b"\n".join(line.replace(b"\n", b"") for line in lines) + b"\n")


def no_defect(*words):
    ended = CliRunner().invoke(smash, list(map(str, words)))
    known = ended.exception is None or isinstance(ended.exception, SystemExit | SmashError)
    assert known, repr(ended.exception)
    assert "\x1b[31m" not in ended.output
    return ended


@pytest.mark.parametrize("seed", range(2))
def test_odd_records_are_checked_and_exported(tmp_path, seed):
    fuzzed(tmp_path, seed, 60)
    assert no_defect("records", "check", tmp_path).exit_code == 3
    pytest.importorskip("pyarrow")
    assert no_defect("records", "export", tmp_path, "--out", tmp_path / "tables").exit_code == 0
    assert not any(line.startswith("=") for line in (tmp_path / "tables" / "runs.csv").read_text().splitlines())


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(40))
def test_many_odd_records_are_checked_exported_and_shown(tmp_path, seed):
    fuzzed(tmp_path, 1000 + seed, 60)
    no_defect("records", "check", tmp_path)
    no_defect("records", "export", tmp_path, "--out", tmp_path / "tables")
    no_defect("report", tmp_path)
