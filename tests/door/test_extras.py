"""The table of extras is that of the package."""

import tomllib
from pathlib import Path

import pytest

from smash.problem.extras import EXECUTION, EXTRAS, TABLES, MissingExtra, missing_extra, require

PROJECT = tomllib.loads((Path(__file__).parents[2] / "pyproject.toml").read_text(encoding="utf-8"))["project"]
CALLED = {"pysat": "python_sat"}
"""Modules that are not called as what brings them."""


def test_every_extra_is_one_of_the_package():
    assert set(EXTRAS) <= set(PROJECT["optional-dependencies"])


@pytest.mark.parametrize("extra", EXTRAS)
def test_the_first_module_of_an_extra_comes_with_it(extra):
    lines = PROJECT["optional-dependencies"][extra]
    names = {line.split(">")[0].split("[")[0].strip().replace("-", "_") for line in lines}
    assert CALLED.get(EXTRAS[extra][0], EXTRAS[extra][0]) in names


def test_what_is_asked_for_at_once_comes_with_one_extra():
    assert set(EXECUTION) <= set(EXTRAS["execution"])
    assert set(TABLES) <= set(EXTRAS["analysis"])


def test_what_is_there_is_not_missing():
    require("this", "numpy")
    with pytest.raises(MissingExtra, match=r"this needs gurobipy: pip install 'smash-testbed\[gurobi\]'"):
        raise missing_extra(ModuleNotFoundError("no", name="gurobipy.core"), "this")
    assert missing_extra(ModuleNotFoundError("no", name="nobody"), "this") is None
    assert missing_extra(ImportError("no"), "this") is None
