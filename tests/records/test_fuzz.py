"""Damaged and odd records: whatever stands in a line, every reader names it or shows it, and none breaks."""

import json
import random

import pytest
from click.testing import CliRunner

from smash.cli import smash
from smash.problem.errors import SmashError
from tests.analysis.made_up import small_sweep, write

ODD = [
    *(None, True, 0, -1, 0.5, 2**63, 10**30, -(10**18), 1e300, [], {}, [[]], {"": ""}, [None], ["pick"], ""),
    *(
        "=cmd|' /C calc'!A0",
        "\x1b[31mred",
        "\ud800",
        "a\nb|c",
        "</script><b>",
        "$x_{$",
        "%s\\input{x}",
        "\u202egnp",
        "-2+3",
    ),
]
SPOILED = [b"NaN", b"Infinity", b"1e999", b"[" * 9000 + b"]" * 9000, b"\xff", b"", b"\x00"]


def places(part, path=()):
    """Every place in a document, as a path of keys and indices."""
    yield path
    inner = part.items() if isinstance(part, dict) else enumerate(part) if isinstance(part, list) else ()
    for key, value in inner:
        yield from places(value, (*path, key))


def mutated(document, draw):
    """A document with one part replaced, left out or added."""
    document = json.loads(json.dumps(document))
    *way, last = draw.choice([path for path in places(document) if path])
    at = document
    for key in way:
        at = at[key]
    if draw.random() < 0.2 and isinstance(at, dict):
        del at[last]
    else:
        at[last] = draw.choice(ODD)
    if draw.random() < 0.1:
        document[draw.choice(ODD[-9:])] = draw.choice(ODD)
    return document


def spoiled(line, draw):
    """A line with a few bytes replaced."""
    at = draw.randrange(len(line))
    return line[:at] + draw.choice(SPOILED) + line[at + draw.randrange(4) :]


def fuzzed(directory, seed, count):
    draw = random.Random(seed)
    runs = [run.document for run in small_sweep()]
    lines = [json.dumps(run).encode() for run in runs]
    for number in range(count):
        line = json.dumps(mutated(draw.choice(runs), draw) | {"key": f"odd-{number}"}).encode()
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
