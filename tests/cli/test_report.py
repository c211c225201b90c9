"""`smash report` at its door: what it says where there is nothing to report."""

import pytest
from click.testing import CliRunner

from smash.cli.report import command
from smash.problem import SmashError


@pytest.mark.parametrize("name", ["", "nowhere"])
def test_without_records_it_ends_with_one_line(tmp_path, name):
    ended = CliRunner().invoke(command, [str(tmp_path / name)])
    assert isinstance(ended.exception, SmashError)
    assert ended.exception.exit_code == 2
    assert len(str(ended.exception).splitlines()) == 1
    assert list(tmp_path.iterdir()) == []
