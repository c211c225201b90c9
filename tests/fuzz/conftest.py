"""Whole files of every kind, made once."""

import pytest

from tests.fuzz.kinds import kinds


@pytest.fixture(scope="session")
def every_kind(tmp_path_factory):
    return {kind.name: kind for kind in kinds(tmp_path_factory.mktemp("whole"))}
