"""What the functions of the door answer, and what they refuse."""

import subprocess
import sys
from pathlib import Path

import pytest

import smash
from smash.planners.registry import UnknownPlanner
from smash.problem import MalformedFile, PlannerCrashed, PlannerOutOfMemory, Unsupported
from smash.problem.errors import RefusedPlan
from smash.problem.extras import ENGINES, EXTRAS, MissingExtra
from tests.door.missing import HIDDEN

ROOT = Path(__file__).parents[2]
FIGURE_1 = ROOT / "examples" / "figure1.json"
INSTANCE = smash.make_instance({"s1": ["a", "b"], "s2": ["c"]}, {"s2": ["c", "a", "b"]})
SOLUTION = [
    smash.Topple("s1", 2),
    smash.Pick("a", "s1"),
    smash.Place("a", "s2"),
    smash.Pick("b", "table"),
    smash.Place("b", "s2"),
]


def test_instances_are_generated_with_as_many_stacks_as_asked():
    made = smash.generate("multi", 6, stacks=4, buffers=1, count=3, seed=2)
    assert [instance.name for instance in made] == ["multi-6x4-000", "multi-6x4-001", "multi-6x4-002"]
    assert {instance.stacks for instance in made} == {("s1", "s2", "s3", "s4")}
    assert all(instance.start[stack] for instance in made for stack in instance.stacks)
    assert made[:2] == smash.generate("multi", 6, stacks=4, buffers=1, count=2, seed=2)
    assert smash.generate("single", 4, stacks=2)[0].stacks == ("s1", "s2", "g")


def test_the_committed_sets_are_the_generated_ones():
    assert smash.generate("single", 6, count=20, seed=2026) == smash.suite("single-6")


@pytest.mark.parametrize(
    ("arguments", "more", "words"),
    [
        (("circle", 4), {}, "no benchmark is called 'circle'; known: single, multi"),
        (("multi", 2), {}, "2 are too few for 3 stacks"),
        (("multi", 4), {"stacks": 0}, "stacks: 0 is not allowed; whole numbers, 1 to 100000"),
        (("multi", 10**9), {}, "blocks: 1000000000 is not allowed; whole numbers, 1 to 100000"),
        (("multi", 4), {"count": 10**9}, "count: 1000000000 is not allowed; whole numbers, 0 to 100000"),
        (("multi", 4), {"buffers": -1}, "buffers: -1 is not allowed; whole numbers, 0 to 100000"),
    ],
)
def test_what_cannot_be_generated_is_said(arguments, more, words):
    with pytest.raises(smash.SmashError, match=words):
        smash.generate(*arguments, **more)


def test_a_suite_is_a_name_a_directory_or_a_file(tmp_path):
    assert "multi-9" in smash.suite_names()
    smash.write_instance(INSTANCE, tmp_path / "mine.json")
    assert smash.suite(tmp_path) == smash.suite(str(tmp_path)) == smash.suite(tmp_path / "mine.json") == [INSTANCE]
    with pytest.raises(MalformedFile, match="neither a directory of instance files nor a committed set"):
        smash.suite("nothing")


@pytest.mark.parametrize("isolated", [False, True])
def test_a_plan_is_found_proven_and_accepted(isolated):
    plan = smash.plan(INSTANCE, budget=20, isolated=isolated)
    assert (plan.status, plan.cost, plan.lower_bound, len(plan.actions)) == ("optimal", 5, 5, 5)
    assert plan.incumbents[-1].cost == 5
    assert smash.check(INSTANCE, plan).accepted


def test_a_plan_keeps_to_what_is_allowed():
    wider = smash.make_instance(INSTANCE.start, INSTANCE.goal, stacks=1)
    assert smash.plan(wider, topple=False).cost == 6
    assert smash.plan(INSTANCE, "precedence", max_topple=1).options == smash.PlanOptions(True, 1)


def test_an_instance_and_a_plan_are_read_where_a_path_is_given(tmp_path):
    smash.write_instance(INSTANCE, tmp_path / "i.json")
    smash.write_plan(smash.plan(str(tmp_path / "i.json")), tmp_path / "p.json")
    assert smash.check(tmp_path / "i.json", str(tmp_path / "p.json")).accepted


@pytest.mark.parametrize("isolated", [False, True])
def test_no_plan_is_a_status(isolated):
    turned = smash.make_instance({"s1": ["a", "b"]}, {"s1": ["b", "a"]}, name="turned")
    plan = smash.plan(turned, topple=False, isolated=isolated)
    assert (plan.status, plan.actions, plan.cost) == ("infeasible", None, None)


def test_a_spent_budget_is_a_status():
    plan = smash.plan(smash.generate("multi", 30, buffers=0, seed=1)[0], "smash-flow", budget=0.3)
    assert plan.status in ("unknown", "feasible")
    assert plan.status == "feasible" or plan.actions is None


@pytest.mark.parametrize(
    ("more", "words"),
    [
        ({"budget": 0}, "budget: 0 is not allowed"),
        ({"budget": float("nan")}, "budget: nan is not allowed"),
        ({"max_topple": 0}, "max_topple: 0 is not allowed"),
        ({"seed": -1}, "seed: -1 is not allowed"),
    ],
)
def test_settings_that_cannot_be_are_refused(more, words):
    with pytest.raises(smash.SmashError, match=words):
        smash.plan(INSTANCE, **more)


@pytest.mark.parametrize("isolated", [False, True])
def test_an_unknown_planner_is_an_error_that_lists_the_known_ones(isolated):
    with pytest.raises(smash.SmashError, match=r"no planner is called 'nobody'; known: .*greedy"):
        smash.plan(INSTANCE, "nobody", isolated=isolated)
    assert issubclass(UnknownPlanner, smash.SmashError)


@pytest.mark.parametrize("isolated", [False, True])
def test_what_a_planner_does_not_take_is_unsupported(isolated):
    with pytest.raises(Unsupported, match=r"^planner 'precedence': unsupported: it does not plan with carry"):
        smash.plan(ROOT / "examples" / "scoop.json", "precedence", isolated=isolated)


@pytest.mark.usefixtures("third_party")
def test_an_answer_that_the_law_refuses_is_an_error(tower_file):
    with pytest.raises(PlannerCrashed, match="planner 'cheats': refused"):
        smash.plan(tower_file, "cheats")
    with pytest.raises(PlannerCrashed, match="planner 'cheats': refused"):
        smash.plan(tower_file, "cheats", isolated=True)


@pytest.mark.usefixtures("third_party")
def test_an_isolated_planner_that_crashes_or_is_not_installed_is_an_error(tower_file):
    with pytest.raises(PlannerCrashed, match="no luck"):
        smash.plan(tower_file, "raises", isolated=True)
    with pytest.raises(Unsupported, match="pip install luck"):
        smash.plan(tower_file, "lacks", isolated=True)
    assert issubclass(PlannerOutOfMemory, smash.SmashError)


def test_a_list_of_actions_is_a_plan():
    assert smash.check(INSTANCE, SOLUTION).accepted
    verdict = smash.check(INSTANCE, SOLUTION[:2] + SOLUTION[3:])
    assert (verdict.accepted, verdict.step) == (False, 3)
    with pytest.raises(smash.SmashError, match="3 is no action; a plan is a Plan, the path of a plan file or a list"):
        smash.check(INSTANCE, [3])
    with pytest.raises(smash.SmashError, match="3 is neither an instance nor the path of an instance file"):
        smash.check(3, SOLUTION)


@pytest.mark.parametrize("kind", [str, Path])
def test_pictures_are_returned_and_written(tmp_path, kind):
    figures = pytest.importorskip("matplotlib.figure")
    target = kind(tmp_path / "plan.svg")
    figure = smash.draw(INSTANCE, SOLUTION, target)
    assert isinstance(figure, figures.Figure)
    assert Path(target).read_text(encoding="utf-8").startswith("<?xml")
    assert smash.draw(INSTANCE)._repr_png_().startswith(b"\x89PNG")


def test_a_plan_is_drawn_moving(tmp_path):
    pytest.importorskip("matplotlib")
    smash.draw(INSTANCE, SOLUTION, tmp_path / "plan.gif")
    assert (tmp_path / "plan.gif").read_bytes().startswith(b"GIF8")
    with pytest.raises(smash.SmashError, match=r"allowed: .png, .pdf, .svg$"):
        smash.draw(INSTANCE, path=tmp_path / "instance.gif")
    with pytest.raises(smash.SmashError, match="no location is called 's9'"):
        smash.draw(INSTANCE, [smash.Topple("s9", 1)])


def test_planners_are_compared_in_a_table():
    pandas = pytest.importorskip("pandas")
    table = smash.compare(smash.suite("multi-4")[:2], ["smash", "greedy"], budget=2)
    assert isinstance(table, pandas.DataFrame)
    assert table["planner"].tolist() == ["smash", "greedy", "smash", "greedy"]
    assert table["instance"].tolist() == ["multi-4-000", "multi-4-000", "multi-4-001", "multi-4-001"]
    assert table["solved"].all()
    assert table["gap"].tolist()[::2] == [0.0, 0.0]
    assert set(table["variant"]) == {"topple"}


def test_what_cannot_be_compared_is_said():
    pytest.importorskip("pandas")
    with pytest.raises(smash.SmashError, match="no instance is given"):
        smash.compare([], ["smash"])
    with pytest.raises(smash.SmashError, match="two instances are called 'instance'"):
        smash.compare([INSTANCE, INSTANCE], ["smash"])
    with pytest.raises(smash.SmashError, match="no planner is called 'nobody'"):
        smash.compare([INSTANCE], "nobody")
    with pytest.raises(smash.SmashError, match="`variants`"):
        smash.compare([INSTANCE], "greedy", variants=["sideways"])


def test_a_plan_is_carried_out():
    pytest.importorskip("pybullet")
    episode = smash.execute(FIGURE_1, smash.plan(FIGURE_1))
    assert (episode.success, episode.failure, episode.actions_executed) == (True, None, 3)


def test_what_cannot_be_carried_out_is_said():
    pytest.importorskip("pybullet")
    with pytest.raises(RefusedPlan, match="goal not reached"):
        smash.execute(FIGURE_1, [])
    for more, words in (
        ({"engine": "ode"}, "'pybullet' or 'mujoco' is allowed"),
        ({"robot": "nobody"}, "there is none called 'nobody'; panda"),
    ):
        with pytest.raises(smash.SmashError, match=words):
            smash.execute(FIGURE_1, [], **more)
    for more in ({"noise": "pose=3"}, {"noise": {"pose": 0.003}}, {"pace": 0.0}, {"pace": "fast"}):
        with pytest.raises(smash.SmashError, match="is not allowed") as refusal:
            smash.execute(FIGURE_1, smash.plan(FIGURE_1), **more)
        assert "\n" not in str(refusal.value)
    with pytest.raises(MalformedFile, match="cannot be read"):
        smash.execute(FIGURE_1, smash.plan(FIGURE_1), scene="nowhere.toml")
    held = smash.make_instance({"s1": ["a"]}, {"s1": ["a", "b"]}, hand="b")
    with pytest.raises(Unsupported, match="starts with block 'b' in the hand"):
        smash.execute(held, smash.plan(held))


def without(packages, program, *arguments):
    """Run a program, or the command, in an environment that has none of the packages."""
    code = HIDDEN.format(packages=tuple(packages)) + program
    return subprocess.run(
        [sys.executable, "-c", code, *map(str, arguments)], capture_output=True, text=True, cwd=ROOT, timeout=60
    )


PLANNED = "import smash; i = smash.make_instance({'s1': ['a']}, {'s2': ['a']}); p = smash.plan(i); smash.check(i, p)\n"
COMMAND = "from smash.cli import main\nmain()\n"


@pytest.mark.parametrize(
    ("call", "words"),
    [
        ("smash.draw(i, p)", "draw needs matplotlib: pip install 'smash-testbed[analysis]'"),
        ("smash.compare([i], ['smash'])", "compare needs pandas: pip install 'smash-testbed[analysis]'"),
        ("smash.execute(i, p)", "execute needs ompl: pip install 'smash-testbed[execution]'"),
    ],
)
def test_without_an_extra_one_line_says_how_to_get_it(call, words):
    program = PLANNED + f"try: {call}\nexcept smash.SmashError as error: print(error.exit_code, error)\n"
    everything = [module for modules in EXTRAS.values() for module in modules]
    assert without(everything, program).stdout == f"6 {words}\n"


@pytest.mark.parametrize(
    ("arguments", "extra"),
    [
        (["execute", FIGURE_1, "plan.json"], "execution"),
        (["episodes", "examples"], "execution"),
        (["draw-scene"], "execution"),
        (["layout", FIGURE_1, "--out", "x.toml"], "execution"),
        (["topple-map"], "execution"),
        (["frontier", "multi-4", "--out", "frontier"], "analysis"),
        (["draw", "instance", FIGURE_1, "--out", "x.png"], "analysis"),
        (["draw", "gadget", "--out", "x.png"], "analysis"),
        (["compare", "multi-4", "--planner", "greedy"], "analysis"),
        (["robot"], "execution"),
        (["report", "results"], "analysis"),
        (["records", "export", "results", "--out", "x"], "analysis"),
    ],
    ids=lambda value: value[0] if isinstance(value, list) else value,
)
def test_a_command_without_its_extra_is_one_line_and_exit_code_6(arguments, extra):
    ended = without(EXTRAS[extra], COMMAND, *arguments)
    assert ended.returncode == 6, ended.stderr
    assert ended.stderr.count("\n") == 1
    assert ended.stderr.endswith(f": pip install 'smash-testbed[{extra}]'\n")


@pytest.mark.parametrize("engine", ENGINES)
def test_an_engine_that_is_not_there_is_one_line_and_exit_code_6(engine, tmp_path):
    pytest.importorskip("ompl")
    (tmp_path / "scene.toml").write_text(
        f'format = "smash-scene/1"\nbase = "default"\nname = "x"\nengine = "{engine}"\n'
    )
    smash.write_plan(smash.plan(FIGURE_1), tmp_path / "plan.json")
    for words in (["--engine", engine], ["--scene", tmp_path / "scene.toml"]):
        ended = without([ENGINES[engine]], COMMAND, "execute", FIGURE_1, tmp_path / "plan.json", *words)
        assert ended.returncode == 6, ended.stderr
        assert ended.stderr.count("\n") == 1
        assert f"the engine {engine} needs {ENGINES[engine]}" in ended.stderr
        assert "pip install 'smash-testbed[" in ended.stderr


def test_an_engine_of_an_extra_that_is_not_there_says_how_to_get_it(monkeypatch):
    for module in (*EXTRAS["pddl"], *EXTRAS["cluster"], *EXTRAS["gurobi"]):
        monkeypatch.setitem(sys.modules, module, None)
    from smash.experiments.sweeps.cluster import connected
    from smash.planners.milp.solvers import gurobi

    for planner in ("fd-opt", "symk-opt", "enhsp", "aries"):
        with pytest.raises(Unsupported, match=r"pip install 'smash-testbed\[pddl\]'"):
            smash.plan(INSTANCE, planner)
    with pytest.raises(MissingExtra, match=r"pip install 'smash-testbed\[cluster\]'"), connected("tcp://nowhere:1"):
        pass
    with pytest.raises(MissingExtra, match=r"pip install 'smash-testbed\[gurobi\]'"):
        gurobi.solve(None, time_limit=1)
