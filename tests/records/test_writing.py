"""The one writer: on disk at once, none twice, one at a time; what is damaged is set aside."""

import json

import pytest

from smash.records.files import RUNS, TRIALS
from smash.records.locking import InUse
from smash.records.reading import read
from smash.records.trials import Trial
from smash.records.writing import Writer
from tests.analysis.made_up import record, write


def test_a_record_is_on_disk_when_append_returns_and_none_is_there_twice(tmp_path):
    with Writer(tmp_path / "out", RUNS) as records:
        for number in (0, 1, 0):
            records.append(record(number))
            assert record(number) in read(tmp_path / "out", RUNS).records
        assert records.finished == {record(0).key, record(1).key}
    with Writer(tmp_path / "out", RUNS) as records:
        records.append(record(1))
        assert records.earlier == [record(0), record(1)]
    assert len(read(tmp_path / "out", RUNS).records) == 2


@pytest.mark.parametrize("cut", [1, 40], ids=["no-end", "half"])
def test_a_last_line_that_was_cut_off_is_set_aside(tmp_path, cut):
    write(tmp_path, [record(0), record(1)])
    whole = RUNS.path(tmp_path).read_bytes()
    RUNS.path(tmp_path).write_bytes(whole[:-cut])
    with Writer(tmp_path, RUNS) as records:
        assert records.set_aside
        assert records.earlier == [record(0)]
        records.append(record(1))
    assert RUNS.path(tmp_path).read_bytes() == whole
    assert RUNS.aside(tmp_path).read_bytes().strip() in whole
    with Writer(tmp_path, RUNS) as records:
        assert not records.set_aside


def test_a_last_line_that_lacks_a_field_is_no_record(tmp_path):
    write(tmp_path, [record(0)])
    short = record(1).document
    del short["budget"]
    with open(RUNS.path(tmp_path), "a") as file:
        file.write(json.dumps(short) + "\n")
    with Writer(tmp_path, RUNS) as records:
        assert records.finished == {record(0).key}
    assert json.loads(RUNS.aside(tmp_path).read_text()) == short


def test_damage_anywhere_is_set_aside_and_named_and_the_rest_stays(tmp_path):
    write(tmp_path, [record(0)])
    whole = RUNS.path(tmp_path).read_bytes()
    RUNS.path(tmp_path).write_bytes(b"half\n" + whole + b"[]\n" + b"half")
    with Writer(tmp_path, RUNS) as records:
        assert [line.split(": ")[1] for line in records.set_aside] == ["line 1", "line 3", "line 4"]
        assert records.earlier == [record(0)]
    assert RUNS.path(tmp_path).read_bytes() == whole
    assert RUNS.aside(tmp_path).read_bytes() == b"half\n[]\nhalf\n"


def test_one_writer_at_a_time(tmp_path):
    with Writer(tmp_path, RUNS), pytest.raises(InUse):
        Writer(tmp_path, TRIALS)
    with Writer(tmp_path, TRIALS) as records:
        records.append(Trial(scene="s", stack=0, height=1, falling=1, seed=0))
        assert records.finished == {("", 0, 1, 1, 0)}


def test_what_is_read_and_written_again_keeps_what_this_version_does_not_know(tmp_path):
    later = record(0).document | {"disturbed": False}
    RUNS.path(tmp_path).write_text(json.dumps(later) + "\n")
    (one,) = read(tmp_path, RUNS).records
    with Writer(tmp_path / "merged", RUNS) as records:
        records.append(one)
    assert json.loads(RUNS.path(tmp_path / "merged").read_text()) == later
