"""The house: no import runs back up the floors, none goes round in a circle, and packages hold what they should."""

import ast
from functools import cache
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[1]
PACKAGES = {
    "smash": ROOT / "smash",
    "smash_baselines": ROOT / "baselines" / "smash_baselines",
    "smash_analysis": ROOT / "analysis" / "smash_analysis",
}
GROUND = {"smash.problem", "smash.records"}
WORKS = {"smash.gadget", "smash.planners", "smash_baselines", "smash.motion", "smash.forecast", "smash.execution"}
FLOORS = {
    "smash.problem": set(),
    "smash.records": {"smash.problem"},
    "smash.gadget": {"smash.problem"},
    "smash.planners": {"smash.problem", "smash.gadget"},
    "smash_baselines": {"smash.problem", "smash.gadget", "smash.planners"},
    "smash.motion": {"smash.problem"},
    "smash.forecast": {"smash.problem"},
    "smash.execution": GROUND | {"smash.motion", "smash.forecast"},
    "smash_analysis": GROUND,
    "smash.experiments": GROUND | WORKS | {"smash_analysis"},
    "smash.cli": GROUND | WORKS | {"smash", "smash.experiments", "smash_analysis"},
    "smash": GROUND | WORKS | {"smash.cli", "smash.experiments", "smash_analysis"},
}
"""Room -> the rooms that it may import from, wherever in a module it does; `smash` is the door itself."""
ORDERS = {
    "smash.planners": (
        *("protocol", "registry", "compiling", "milp", "greedy", "precedence", "astar", "neighbourhood", "warm"),
        *("layered", "flow", "former", "portfolio"),
    ),
    "smash.records": (
        *("outcomes", "locking", "variants", "claims", "record", "engines", "scenes", "runs", "episodes", "trials"),
        *("files", "sharing", "reading", "writing", "believing"),
    ),
    "smash.experiments": (
        *("environment", "isolation", "weighing", "sweeps", "episodes", "best_known", "studies"),
        *("reproduction", "planning", "executing", "comparison", "dataset"),
    ),
    "smash_analysis": (
        *("statistics", "metrics", "tables", "charts", "command"),
        *("ablation", "comparison", "scaling", "execution_tables", "execution_sweeps", "robustness", "paces", "scoop"),
        *("engine_landings", "engines", "arms"),
        *("forecasts", "readme", "export"),
        "report",
    ),
}
"""The rooms of a room, and its modules beside them, from the ground: each may import from those before it."""


@cache
def modules():
    """Every module by its dotted name, and the file."""
    found = {}
    for package, directory in PACKAGES.items():
        for file in sorted(directory.rglob("*.py")):
            parts = (package, *file.relative_to(directory).with_suffix("").parts)
            found[".".join(parts[:-1] if parts[-1] == "__init__" else parts)] = file
    return found


def modules_of(name):
    """The module that an import names: itself, or the one that holds the name."""
    while name and name not in modules():
        name = name.rpartition(".")[0]
    return name


@cache
def imports():
    """Module -> (module that it imports, line, whether at its top), those of functions and for types alone included."""
    found = {}
    for module, file in modules().items():
        tree = ast.parse(file.read_text(encoding="utf-8"))
        at_top = {id(node) for node in tree.body}
        named = []
        for node in ast.walk(tree):
            match node:
                case ast.Import(names=names):
                    targets = [name.name for name in names]
                case ast.ImportFrom(module=str(base), names=names, level=0):
                    targets = [f"{base}.{name.name}" for name in names]
                case _:
                    continue
            for target in map(modules_of, targets):
                if target and target != module:
                    named.append((target, node.lineno, id(node) in at_top))
        found[module] = named
    return found


def room(module):
    """The room of a module: a package of `smash`, or another package; the door and `__main__` are `smash`'s own."""
    first, _, rest = module.partition(".")
    within = rest.partition(".")[0]
    return f"{first}.{within}" if first == "smash" and f"{first}.{within}" in FLOORS else first


def test_every_room_has_its_floor():
    assert {room(module) for module in modules()} == set(FLOORS)
    folders = {f"smash.{folder.parent.name}" for folder in PACKAGES["smash"].glob("*/__init__.py")}
    assert folders == {name for name in FLOORS if name.startswith("smash.")}


@pytest.mark.parametrize("name", FLOORS)
def test_no_import_runs_up_the_floors(name):
    up = [
        f"{module}:{line} imports {target}"
        for module, named in imports().items()
        if room(module) == name
        for target, line, _ in named
        if room(target) not in FLOORS[name] | {name}
    ]
    assert up == []


@pytest.mark.parametrize("name", ORDERS)
def test_the_rooms_of_a_room_stand_in_one_order(name):
    def place(module):
        return ORDERS[name].index(module.removeprefix(f"{name}.").partition(".")[0])

    inside = {module: named for module, named in imports().items() if module.startswith(f"{name}.")}
    assert {module.removeprefix(f"{name}.").partition(".")[0] for module in inside} <= set(ORDERS[name])
    up = [
        f"{module}:{line} imports {target}"
        for module, named in inside.items()
        for target, line, _ in named
        if target in inside and place(target) > place(module)
    ]
    assert up == []


def test_no_import_goes_round_in_a_circle():
    """Of what is imported as modules are loaded: at their top."""
    graph = {module: {target for target, _, top in named if top} for module, named in imports().items()}
    done, path = set(), []

    def walk(module):
        if module in path:
            pytest.fail(" -> ".join([*path[path.index(module) :], module]))
        if module in done:
            return
        path.append(module)
        for target in sorted(graph[module]):
            walk(target)
        path.pop()
        done.add(module)

    for module in graph:
        walk(module)


def test_a_package_s_data_lies_in_it():
    for package, directory in PACKAGES.items():
        assert all(
            (folder / "__init__.py").is_file() for folder in {file.parent for file in directory.rglob("*.py")}
        ), package
    from smash_baselines.domains import DOMAINS

    from smash.execution.scene.scene_file import default_scene
    from smash.problem.sets.suites import suite_files, suite_names

    assert (DOMAINS / "pick-and-place.pddl").is_file()
    assert default_scene().name == "default"
    assert all(Path(file).is_relative_to(PACKAGES["smash"]) for name in suite_names() for file in suite_files(name))
