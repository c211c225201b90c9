"""The rooms of motion and execution import downwards, and no two modules import each other."""

import ast
from graphlib import TopologicalSorter
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
FLOORS = (
    "problem",
    "records",
    "forecast",
    "motion",
    "execution.scene",
    "execution.actions",
    "execution.physics",
)
FLOORS += ("execution", "execution.layout", "execution.trials", "execution.viewing")


def imports_of(path):
    """What a module imports from the project."""
    found = set()
    for node in ast.walk(ast.parse(path.read_text())):
        if isinstance(node, ast.ImportFrom):
            found |= {node.module, *(f"{node.module}.{each.name}" for each in node.names)}
    return {name for name in found if name.startswith("smash.")}


IMPORTS = {
    ".".join(path.relative_to(ROOT).with_suffix("").parts): imports_of(path)
    for room in ("motion", "execution")
    for path in (ROOT / "smash" / room).rglob("*.py")
    if path.name != "__init__.py"
}


def floor(module):
    """Where a module stands; what has no floor of these is above all."""
    rooms = [room for room in FLOORS if f"{module}.".startswith(f"smash.{room}.")]
    return FLOORS.index(max(rooms, key=len)) if rooms else len(FLOORS)


@pytest.mark.parametrize("module", sorted(IMPORTS))
def test_a_module_imports_from_its_own_floor_and_those_below(module):
    assert not {name for name in IMPORTS[module] if floor(name) > floor(module)}


def test_no_modules_import_each_other():
    assert list(TopologicalSorter(IMPORTS).static_order())
