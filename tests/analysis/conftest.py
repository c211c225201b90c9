"""One small report, made once for all tests that look at it."""

import pytest
from smash_analysis.report.page import make

from tests.analysis.made_up import record, small_sweep, write


@pytest.fixture(scope="session")
def report(tmp_path_factory):
    directory = tmp_path_factory.mktemp("report")
    write(directory / "results" / "first", small_sweep())
    (directory / "results" / "first" / "replays").mkdir()
    (directory / "results" / "first" / "replays" / "i1--topple.html").write_text("a replay")
    write(directory / "results" / "second", [record(0, label="</script>", instance="", reason="<i>")])
    return make(directory / "results", directory / "out")
