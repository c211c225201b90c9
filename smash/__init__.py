"""Planning with topple actions: make an instance, plan it, check the plan, draw it, carry it out, compare planners.

    import smash

    instance = smash.make_instance(start={"s1": ["a", "b"], "s2": ["c"]}, goal={"s2": ["c", "a", "b"]})
    plan = smash.plan(instance)
    print(plan.status, plan.cost, *plan.actions, sep=", ")
    print(smash.check(instance, plan))

- instances: `make_instance`, `generate`, `suite` and `suite_names`; `read_instance`, `write_instance`
- plans: `plan` and `planner_names`, `check`; `read_plan`, `write_plan`
- from there: `draw`, `compare` (they need the extra `analysis`: `pip install 'smash-testbed[analysis]'`) and `execute`
  (the extra `execution`)
- what they give and take: `Instance`, `Plan` (its `status`, `cost`, `lower_bound`, `actions`, `incumbents`),
  `PlanOptions`, `Verdict`, `Episode`; `State` and the actions `Pick`, `Place`, `Topple`, `Carry`, `Lift`
- what is wrong is said by a `SmashError`, in one line

Goals other than a whole arrangement, and the law itself, are in `smash.problem`; `smash.planners` has what planners are
made of. Nothing is imported before it is asked for.
"""

TYPE_CHECKING = False  # type checkers take it for true; importing `typing` takes longer than all the rest

if TYPE_CHECKING:
    from typing import Any

    from smash.experiments.comparison import compare
    from smash.experiments.executing import execute
    from smash.experiments.planning import plan
    from smash.gadget.drawing.draw import draw
    from smash.planners.registry import planner_names
    from smash.problem.actions.carry import Carry
    from smash.problem.actions.lift import Lift
    from smash.problem.actions.topple import Topple
    from smash.problem.errors import SmashError
    from smash.problem.files.given import check
    from smash.problem.files.instances import read_instance, write_instance
    from smash.problem.files.plans import read_plan, write_plan
    from smash.problem.making import make_instance
    from smash.problem.model import Instance, Pick, Place, PlanOptions, State
    from smash.problem.plan import Plan
    from smash.problem.rules import Verdict
    from smash.problem.sets.generators import generate
    from smash.problem.sets.suites import read_suite as suite
    from smash.problem.sets.suites import suite_names
    from smash.records.episodes import Episode

    __version__: str

__all__ = [
    "Carry",
    "Episode",
    "Instance",
    "Lift",
    "Pick",
    "Place",
    "Plan",
    "PlanOptions",
    "SmashError",
    "State",
    "Topple",
    "Verdict",
    "__version__",
    "check",
    "compare",
    "draw",
    "execute",
    "generate",
    "make_instance",
    "plan",
    "planner_names",
    "read_instance",
    "read_plan",
    "suite",
    "suite_names",
    "write_instance",
    "write_plan",
]

_HOMES = {
    "Carry": "smash.problem.actions.carry",
    "Episode": "smash.records.episodes",
    "Instance": "smash.problem.model",
    "Lift": "smash.problem.actions.lift",
    "Pick": "smash.problem.model",
    "Place": "smash.problem.model",
    "Plan": "smash.problem.plan",
    "PlanOptions": "smash.problem.model",
    "SmashError": "smash.problem.errors",
    "State": "smash.problem.model",
    "Topple": "smash.problem.actions.topple",
    "Verdict": "smash.problem.rules",
    "check": "smash.problem.files.given",
    "compare": "smash.experiments.comparison",
    "draw": "smash.gadget.drawing.draw",
    "execute": "smash.experiments.executing",
    "generate": "smash.problem.sets.generators",
    "make_instance": "smash.problem.making",
    "plan": "smash.experiments.planning",
    "planner_names": "smash.planners.registry",
    "read_instance": "smash.problem.files.instances",
    "read_plan": "smash.problem.files.plans",
    "suite": "smash.problem.sets.suites:read_suite",
    "suite_names": "smash.problem.sets.suites",
    "write_instance": "smash.problem.files.instances",
    "write_plan": "smash.problem.files.plans",
}
"""Name -> the module where its work is done (`module:name`, where it has another name there)."""

if not TYPE_CHECKING:  # a name that is none stays an error for type checkers

    def __getattr__(name: str) -> "Any":
        from importlib import import_module

        if name == "__version__":
            from importlib.metadata import version

            found = version("smash-testbed")
        elif name in _HOMES:
            module, _, there = _HOMES[name].partition(":")
            found = getattr(import_module(module), there or name)
        else:
            raise AttributeError(f"module 'smash' has no attribute {name!r}")
        globals()[name] = found
        return found

    def __dir__() -> list[str]:
        return sorted({*globals(), *__all__})
