"""Reading records: what JSON allows and tables do not."""

import json

from smash_analysis.comparison import make

from smash.records.believing import believed_runs
from tests.analysis.made_up import record


def test_names_that_are_no_unicode_text_are_escaped(tmp_path):
    odd = record(trace=[(0.1, 3)], suite="\ud800 set", instance="\U0001f600\n\udfff")
    (tmp_path / "runs.jsonl").write_text(json.dumps(odd.document) + "\n")
    (read,) = believed_runs(tmp_path).records
    assert (read.suite, read.instance) == ("\\ud800 set", "\U0001f600\\n\\udfff")
    assert "\\ud800 set" in make(tmp_path, tmp_path / "out")[0].read_text()


def test_only_the_runs_that_are_meant_are_read(tmp_path):
    rows = [record(number, [(0.1, 3)]) for number in range(3)]
    (tmp_path / "runs.jsonl").write_text("".join(json.dumps(row.document) + "\n" for row in rows))
    assert [row.key for row in believed_runs(tmp_path, {rows[1].key}).records] == [rows[1].key]
