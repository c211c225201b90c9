"""The door: every name is there, documented, loaded only when asked for, and no submodule hides it."""

import inspect
import subprocess
import sys
from pathlib import Path

import pytest

import smash

ROOT = Path(__file__).parents[2]
NAMES = [
    "Instance",
    "Plan",
    "PlanOptions",
    "State",
    "Pick",
    "Place",
    "Topple",
    "Carry",
    "Lift",
    "Verdict",
    "Episode",
    "SmashError",
    "make_instance",
    "read_instance",
    "write_instance",
    "read_plan",
    "write_plan",
    "generate",
    "suite",
    "suite_names",
    "planner_names",
    "plan",
    "check",
    "execute",
    "draw",
    "compare",
    "__version__",
]
FUNCTIONS = [name for name in NAMES if name.islower() and name != "__version__"]


def python(program, folder=ROOT):
    ended = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, cwd=folder, timeout=60)
    assert ended.returncode == 0, ended.stderr
    return ended.stdout


def test_the_door_has_these_names_and_no_others():
    assert sorted(smash.__all__) == sorted(NAMES)
    assert set(NAMES) <= set(dir(smash))


@pytest.mark.parametrize("name", NAMES)
def test_a_name_is_importable_and_documented(name):
    found = getattr(smash, name)
    assert found.__doc__
    assert name == "__version__" or found.__module__.startswith("smash.")


@pytest.mark.parametrize("name", FUNCTIONS)
def test_a_function_says_what_it_takes_and_gives(name):
    function = getattr(smash, name)
    signature = inspect.signature(function)
    assert signature.return_annotation is not signature.empty
    for parameter in signature.parameters.values():
        assert parameter.annotation is not parameter.empty
    if len(signature.parameters) >= 3:
        assert "Args:" in function.__doc__


def test_no_name_is_a_submodule():
    package = Path(smash.__file__).parent
    submodules = {path.stem for path in package.glob("*.py")} | {
        path.name for path in package.iterdir() if path.is_dir()
    }
    assert not submodules & set(NAMES)


def test_importing_the_door_loads_nothing_of_the_house():
    loaded = python("import sys, smash; print(*sys.modules)").split()
    assert [name for name in loaded if name.startswith("smash")] == ["smash"]
    for package in ("numpy", "scipy", "click", "msgspec", "rich", "numba", "highspy", "pandas", "matplotlib"):
        assert package not in loaded


def test_a_name_loads_what_it_needs_and_no_more():
    loaded = python("import sys, smash; smash.make_instance; print(*sys.modules)").split()
    assert "smash.problem.making" in loaded
    assert not [name for name in loaded if name.startswith(("smash.planners", "smash.experiments", "numpy", "pandas"))]


def test_a_star_imports_every_name():
    assert python("from smash import *; print(make_instance.__name__, Topple('s', 1), compare.__name__)").startswith(
        "make"
    )


def test_the_help_shows_the_example_and_every_name():
    shown = python("import smash; help(smash)")
    assert "smash.make_instance(start=" in shown[:1500]
    assert all(name in shown for name in NAMES if name != "__version__")


def test_the_example_of_the_help_runs():
    example = [line[4:] for line in smash.__doc__.split("\n") if line.startswith("    ")]
    assert len([line for line in example if line]) == 5
    said = python("\n".join(example)).splitlines()
    assert said[0].startswith("optimal, 5, topple")
    assert said[-1] == "accepted"


def test_a_name_that_is_none_is_an_attribute_error():
    with pytest.raises(AttributeError, match="no attribute 'nothing'"):
        smash.nothing  # noqa: B018
