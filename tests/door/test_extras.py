"""The table of extras is that of the package."""

import ast
import tomllib
from collections.abc import Iterator
from pathlib import Path

import pytest

from smash.problem.extras import ENGINES, EXECUTION, EXTRAS, TABLES, MissingExtra, is_known, missing_extra, require

ROOT = Path(__file__).parents[2]
PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]


def test_every_extra_is_one_of_the_package():
    assert set(EXTRAS) <= set(PROJECT["optional-dependencies"])


@pytest.mark.parametrize("extra", EXTRAS)
def test_the_first_module_of_an_extra_comes_with_it(extra):
    lines = PROJECT["optional-dependencies"][extra]
    names = {line.split(">")[0].split("[")[0].strip().replace("-", "_") for line in lines}
    assert EXTRAS[extra][0] in names


def test_what_is_asked_for_at_once_comes_with_one_extra():
    assert set(EXECUTION) <= set(EXTRAS["execution"])
    assert set(TABLES) <= set(EXTRAS["analysis"])


def test_what_is_there_is_not_missing():
    require("this", "numpy")
    with pytest.raises(MissingExtra, match=r"this needs gurobipy: pip install 'smash-testbed\[gurobi\]'"):
        raise missing_extra(ModuleNotFoundError("no", name="gurobipy.core"), "this")
    assert missing_extra(ModuleNotFoundError("no", name="nobody"), "this") is None
    assert missing_extra(ImportError("no"), "this") is None


def asked_for() -> Iterator[tuple[str, str]]:
    """Yield every module that the tree asks for by its name, and where."""
    for folder in ("smash", "analysis", "baselines"):
        for path in sorted((ROOT / folder).rglob("*.py")):
            text = path.read_text(encoding="utf-8")
            for node in ast.walk(ast.parse(text)) if "problem.extras" in text else ():
                called = getattr(node.func, "id", "") if isinstance(node, ast.Call) else ""
                if called in ("require", "MissingExtra", "is_there", "install_line"):
                    given = node.args[1:] if called in ("require", "MissingExtra") else node.args
                    for word in given:
                        if isinstance(word, ast.Constant):
                            yield word.value, f"{path.relative_to(ROOT)}:{node.lineno}"


def test_every_module_that_is_asked_for_comes_with_an_extra():
    from smash.planners.milp.solvers import NEEDS

    asked = [*asked_for(), *((module, "solvers") for modules in NEEDS.values() for module in modules)]
    asked += [(module, "extras") for module in (*EXECUTION, *TABLES, *ENGINES.values())]
    assert len(asked) > 20
    always = {line.split(">")[0].split("[")[0].strip() for line in PROJECT["dependencies"]}
    assert [(module, where) for module, where in asked if not is_known(module) and module not in always] == []
