"""Equal parts of records are held once, and every record still says what its line says."""

import gc
import json

from smash.records.files import RUNS
from smash.records.reading import read
from smash.records.sharing import kept_objects
from tests.analysis.made_up import record, write


def test_equal_parts_are_one_object_and_lines_are_kept(tmp_path):
    runs = [record(0, [(0.1, cost)], label=label) for label, cost in (("a", 5), ("b", 5), ("c", 7))]
    first, second, third = read(write(tmp_path, runs), RUNS).records
    assert first.instance_document is second.instance_document is third.instance_document
    assert first.versions is third.versions
    assert first.actions[-1] is third.actions[-1]
    assert [run.document for run in (first, second, third)] == [json.loads(json.dumps(run.document)) for run in runs]


def test_the_collector_goes_on_after_reading_also_where_it_failed():
    try:
        with kept_objects():
            assert not gc.isenabled()
            raise KeyError
    except KeyError:
        assert gc.isenabled()
