import pytest

pytest.importorskip("unified_planning")

from smash_baselines.read_up import read_up_problem
from smash_baselines.up_engine import SmashEngine
from smash_baselines.up_problem import up_problem
from unified_planning.engines import AnytimeGuarantee, OptimalityGuarantee, PlanGenerationResultStatus
from unified_planning.io import PDDLReader, PDDLWriter
from unified_planning.shortcuts import get_environment
from unified_planning.test.examples import get_example_problems

from smash.problem import OnGoal, PlanOptions, Unsupported, make_instance, read_instance
from smash.problem.files.instances import instance_document
from smash.problem.model import StacksGoal
from smash.problem.sets.suites import suite_files
from tests.baselines.test_planners import figure_1
from tests.oracle import optimal_cost

PLANNER = {"planner": "precedence"}


@pytest.fixture(scope="module")
def factory():
    environment = get_environment()
    environment.credits_stream = None
    environment.factory.add_engine("smash", "smash_baselines.up_engine", "SmashEngine")
    return environment.factory


@pytest.mark.parametrize(
    ("wanted", "options"),
    [
        ("conditional", PlanOptions()),
        ("chain", PlanOptions()),
        ("chain", PlanOptions(True, 2)),
        ("chain", PlanOptions(topple=False)),
    ],
)
def test_oneshot_solves_every_encoding_and_the_library_accepts_the_plan(factory, wanted, options):
    problem = up_problem(figure_1(), options, wanted)
    with factory.OneshotPlanner(name="smash", params=PLANNER) as planner:
        result = planner.solve(problem, timeout=60)
    assert result.status == PlanGenerationResultStatus.SOLVED_OPTIMALLY
    assert result.metrics["lower_bound"] == str(optimal_cost(figure_1(), options))
    with factory.PlanValidator(problem_kind=problem.kind) as validator:
        assert validator.validate(problem, result.plan)


def test_words_and_a_full_hand_are_read_and_the_library_accepts_the_plan(factory):
    goal = OnGoal({"a": "b"}, ontable=("c", "d"), clear=("c",))
    instance = make_instance({"s1": ["c", "b", "d"]}, goal, stacks=2, buffers=1, hand="a")
    problem = up_problem(instance, PlanOptions(), "chain")
    with factory.OneshotPlanner(name="smash", params={"planner": "fd-opt-ipdb"}) as planner:
        result = planner.solve(problem, timeout=60)
    assert result.status == PlanGenerationResultStatus.SOLVED_OPTIMALLY
    assert result.metrics["lower_bound"] == str(optimal_cost(instance))
    with factory.PlanValidator(problem_kind=problem.kind) as validator:
        assert validator.validate(problem, result.plan)


def test_anytime_plans_get_better_and_the_last_says_what_is_proven(factory):
    problem = up_problem(read_instance(suite_files("multi-6")[0]), PlanOptions(), "chain")
    with factory.AnytimePlanner(name="smash", params={"planner": "fd-opt-ipdb"}) as planner:
        results = list(planner.get_solutions(problem, timeout=100))
    assert results[-1].status == PlanGenerationResultStatus.SOLVED_OPTIMALLY
    assert all(result.status == PlanGenerationResultStatus.INTERMEDIATE for result in results[:-1])
    assert len(results) > 1


def test_what_has_no_plan_is_proven(factory):
    turned = make_instance(
        name="turned", blocks=["a", "b"], stacks=["s"], start={"s": ["a", "b"]}, goal=StacksGoal({"s": ("b", "a")})
    )
    problem = up_problem(turned, PlanOptions(topple=False), "chain")
    with factory.OneshotPlanner(name="smash", params=PLANNER) as planner:
        assert planner.solve(problem).status == PlanGenerationResultStatus.UNSOLVABLE_PROVEN


def test_the_librarys_example_problems_are_answered_as_unsupported(factory):
    """They are other domains; those that the engine's problem kind lets through must be refused, not crash."""
    kinds = SmashEngine.supported_kind()
    refused = 0
    for name, example in get_example_problems().items():
        if not example.problem.kind <= kinds:
            continue
        with factory.OneshotPlanner(name="smash", params=PLANNER) as planner:
            result = planner.solve(example.problem, timeout=30)
        assert result.status == PlanGenerationResultStatus.UNSUPPORTED_PROBLEM, name
        assert result.log_messages
        refused += 1
    assert refused > 0


def test_the_engine_promises_what_it_keeps():
    engine = SmashEngine()
    assert engine.is_oneshot_planner()
    assert engine.is_anytime_planner()
    assert engine.ensures(AnytimeGuarantee.INCREASING_QUALITY)
    assert not engine.satisfies(OptimalityGuarantee.SOLVED_OPTIMALLY)


def test_a_problem_written_by_the_library_reads_back():
    instance = read_instance(suite_files("multi-4")[0])
    problem = up_problem(instance, PlanOptions(), "chain")
    writer = PDDLWriter(problem)
    again = PDDLReader().parse_problem_string(writer.get_domain(), writer.get_problem())
    read = read_up_problem(again)
    document, original = instance_document(read.instance), instance_document(instance)
    assert len(document["buffers"]) == len(original["buffers"])
    assert {at: len(pile) for at, pile in document["start"].items()} == {
        f"s0{at[1:]}": len(pile) for at, pile in original["start"].items()
    }


def test_a_domain_with_another_law_is_refused():
    problem = up_problem(figure_1(), PlanOptions(), "chain")
    problem.action("topple-end").add_precondition(problem.fluent("hand-empty")())
    with pytest.raises(Unsupported, match="topple-end"):
        read_up_problem(problem)
