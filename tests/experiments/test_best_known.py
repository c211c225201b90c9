"""The list of best known costs: what gets on it, what it says of a submission, and that the committed one holds."""

import json
from datetime import UTC, datetime
from pathlib import Path
from time import perf_counter

import pytest
from click.testing import CliRunner

from smash.cli.best_known import command as best_known
from smash.cli.submit_check import command as submit_check
from smash.experiments.best_known.files import LIST, Contradiction, csv_text, read_best_known, write_best_known
from smash.experiments.best_known.open_table import BEGIN, open_table, put_between
from smash.experiments.best_known.standing import BestKnown, Found, open_instances, options_of
from smash.experiments.isolation.caller import run_isolated
from smash.experiments.sweeps.experiment import Experiment, PlannerEntry, experiment_runs
from smash.experiments.sweeps.sweep import record_of
from smash.planners.precedence.certify import certify
from smash.planners.protocol import SolveOptions
from smash.planners.registry import get_planner
from smash.problem import Law, MalformedFile, PlanOptions, SmashError, Topple
from smash.problem.certificate import certificate_text
from smash.problem.files.plans import plan_document, plan_text, read_plan
from smash.problem.model import Pick, Place
from smash.problem.problem import Problem
from smash.records.files import RUNS
from smash.records.writing import Writer

ROOT = Path(__file__).parents[2]
NAME = "open-few-buffers-01"
VARIANTS = ("topple", "max-topple-2", "no-topple")
SOMEBODY = Found("somebody", "greedy", seconds=0.5, date="2026-01-01")


def solved(variant, planner="greedy"):
    options = options_of(variant)
    return get_planner(planner).solve(open_instances()[NAME], SolveOptions(options.topple, options.max_topple), 5.0)


def longer(instance, actions):
    """The same plan, with a block put back where it was at first."""
    source = next(at for at in instance.stacks if instance.start[at])
    block = instance.start[source][-1]
    return (Pick(block, source), Place(block, source), *actions)


@pytest.fixture
def known(tmp_path):
    listed = BestKnown(tmp_path / "list")
    for variant in VARIANTS:
        listed.add_variant(NAME, variant)
    listed.offer_plan(NAME, longer(open_instances()[NAME], solved("topple").actions), SOMEBODY)
    listed.offer_bound(NAME, PlanOptions(), 20, SOMEBODY)
    write_best_known(listed)
    return listed


@pytest.fixture
def submit(known, tmp_path):
    def submission(plan, *more, **changes):
        document = plan_document(plan) | changes
        file = tmp_path / "mine.json"
        file.write_text(json.dumps(document))
        return invoke(submit_check, file, "--list", known.directory, *more)

    return submission


def invoke(command, *arguments):
    """Return the exit code and what is said: the line that is printed, or the error's."""
    ended = CliRunner().invoke(command, [str(argument) for argument in arguments])
    if isinstance(ended.exception, SmashError):
        return ended.exception.exit_code, str(ended.exception)
    assert ended.exception is None or isinstance(ended.exception, SystemExit), ended.exception
    return ended.exit_code, ended.output.strip()


def filed(variant, planner="greedy"):
    return solved(variant, planner).as_plan(open_instances()[NAME], planner, options_of(variant))


def test_a_better_plan_improves_and_then_equals(submit, known):
    plan = filed("topple")
    code, words = submit(plan)
    assert (code, words.split(":")[0]) == (0, "improves")
    assert f"{plan.cost} actions, best known {plan.cost + 2} by somebody, lower bound 20" in words
    known.offer_plan(NAME, plan.actions, SOMEBODY)
    write_best_known(known)
    code, words = submit(plan)
    assert (code, words.split(":")[0]) == (1, "equals")


def test_a_longer_plan_is_worse(submit):
    plan = filed("topple")
    actions = longer(open_instances()[NAME], longer(open_instances()[NAME], plan.actions))
    document = plan_document(plan) | {"cost": len(actions), "status": "feasible", "lower_bound": None}
    listed = [[type(a).__name__.lower(), *(getattr(a, f) for f in a.__slots__)] for a in actions]
    code, words = submit(plan, **(document | {"actions": listed}))
    assert (code, words.split(":")[0]) == (1, "is worse")


def test_what_the_law_refuses_is_refused(submit):
    plan = filed("topple")
    code, words = submit(plan, topple=False)
    assert code == 3
    assert "topple is not allowed" in words
    code, words = submit(plan, cost=plan.cost - 1)
    assert code == 3
    assert submit(plan, actions=None, cost=None, status="unknown", lower_bound=None)[0] == 3


def test_what_is_malformed_or_not_on_the_list_is_said(submit, known, tmp_path):
    plan = filed("topple")
    assert submit(plan, instance="multi-4-000") == (
        2,
        f"multi-4-000: no instance of the list ({NAME} … {NAME})",
    )
    assert submit(plan, colour="red")[0] == 2
    assert invoke(submit_check, tmp_path / "none.json")[0] == 2
    assert invoke(submit_check, tmp_path / "mine.json", "--list", tmp_path)[0] == 2


def test_a_plan_counts_in_every_variant_that_allows_it(submit, known):
    code, words = submit(filed("no-topple"))
    assert (code, words.split(":")[0]) == (0, "improves")
    assert "no-topple" in words
    known.offer_plan(NAME, filed("max-topple-2").actions, SOMEBODY)
    capped, free = (known.entries[NAME, variant] for variant in ("max-topple-2", "topple"))
    assert free.cost <= capped.cost


def test_a_plan_under_a_cap_that_is_not_listed_counts_where_it_is_allowed(submit):
    plan = filed("max-topple-2")
    assert submit(plan, max_topple=3)[0] == 0


def test_a_claimed_bound_is_not_believed_without_a_certificate(submit):
    plan = filed("topple", "precedence")
    assert plan.lower_bound > 20
    _, words = submit(plan)
    assert f"its lower bound {plan.lower_bound} is not believed" in words


def test_a_certificate_raises_the_bound_of_every_variant_that_allows_less(submit, known, tmp_path):
    proof = certify(Problem(open_instances()[NAME], PlanOptions()), perf_counter() + 10)
    file = tmp_path / "proof.json"
    file.write_text(certificate_text(proof))
    code, words = submit(filed("topple"), "--certificate", file)
    assert code == 0
    for variant in VARIANTS:
        assert f"raises the lower bound of {variant} from 20 to {proof.bound}" in words
    assert submit(filed("no-topple"), "--certificate", file)[0] == 3


def test_an_added_plan_is_filed_with_its_finder(known, tmp_path):
    file = tmp_path / "mine.json"
    plan = filed("topple")
    file.write_text(plan_text(plan))
    assert invoke(best_known, "add", file, "--by", "A, B | C", "--list", known.directory)[0] == 0
    again = read_best_known(known.directory)
    entry = again.entries[NAME, "topple"]
    assert (entry.cost, entry.found.by, entry.lower_bound) == (plan.cost, "A, B | C", 20)
    assert read_plan(known.directory / entry.plan_file).actions == plan.actions
    assert "A, B \\| C" in open_table(again)
    assert invoke(best_known, "add", file, "--by", "late", "--list", known.directory)[0] == 1


def test_a_plan_below_a_bound_stops_the_list_from_being_written(known):
    before = (known.directory / "best-known.csv").read_text()
    known.offer_bound(NAME, PlanOptions(), 10_000, SOMEBODY)
    with pytest.raises(Contradiction, match="one of both is wrong"):
        write_best_known(known)
    assert (known.directory / "best-known.csv").read_text() == before


def test_a_bound_holds_for_what_allows_less_and_not_for_more(known):
    known.offer_bound(NAME, options_of("max-topple-2"), 25, SOMEBODY)
    assert [known.entries[NAME, variant].lower_bound for variant in VARIANTS] == [20, 25, 25]


def test_records_of_a_sweep_fill_the_list_and_a_second_time_change_nothing(tmp_path):
    experiment = Experiment(
        "few", ["open-few-buffers", "multi-4"], [PlannerEntry("smash")], [2.0], instances=1, variants=["topple"]
    )
    with Writer(tmp_path / "runs", RUNS) as records:
        for run in experiment_runs(experiment):
            records.append(record_of(run, run_isolated(run.job), datetime.now(UTC), 0.0))
    command = ("update", tmp_path / "runs", "--list", tmp_path / "list")
    code, words = invoke(best_known, *command)
    assert code == 0
    assert words.startswith("2 improvements; 1 of 1 proven")
    assert "1 records are of other instances" in words
    first = (tmp_path / "list" / "best-known.csv").read_text()
    assert invoke(best_known, *command)[1].startswith("0 improvements")
    assert (tmp_path / "list" / "best-known.csv").read_text() == first
    entry = read_best_known(tmp_path / "list").entries["open-few-buffers-00", "topple"]
    assert (entry.cost, entry.found.by, entry.bound.by) == (26, "smash", "smash")


def test_a_damaged_list_is_one_line(known):
    file = known.directory / "best-known.csv"
    good = file.read_text()
    for bad in (good.replace(NAME, "elsewhere"), good.replace(",20,", ",twenty,"), "a,b\n1,2\n", good + "1,2,3\n"):
        file.write_text(bad)
        with pytest.raises(MalformedFile) as error:
            read_best_known(known.directory)
        assert "\n" not in str(error.value)


def test_the_table_counts_each_generation_of_sets_apart(tmp_path):
    listed = BestKnown(tmp_path)
    listed.add_variant(NAME, "topple")
    listed.offer_plan(NAME, solved("topple").actions, SOMEBODY)
    listed.offer_bound(NAME, PlanOptions(), len(solved("topple").actions), SOMEBODY)
    assert "Proven optimal: 1 of 1; of the first sets 1 of 1." in open_table(listed)
    listed.add_variant("open-few-buffers-2-00", "no-topple")
    text = open_table(listed)
    assert "Proven optimal: 1 of 2; of the first sets 1 of 1; of the harder sets 0 of 1." in text
    assert "| open-few-buffers-2 | – | 0 of 1 |" in text


def test_a_page_without_marks_is_refused():
    with pytest.raises(MalformedFile, match=r"page\.md"):
        put_between(BEGIN, "table", "page.md")


@pytest.fixture(scope="module")
def committed():
    """`results/best-known`, as `make best-known` wrote it."""
    return read_best_known(LIST)


def test_every_open_instance_is_on_the_committed_list(committed):
    assert {name for name, _ in committed.entries} == set(open_instances())


def test_every_committed_plan_is_legal_and_as_long_as_it_says(committed):
    for entry in committed.entries.values():
        actions = committed.actions(entry)
        assert len(actions) == entry.cost
        verdict = Law(open_instances()[entry.instance], options_of(entry.variant)).check(actions)
        assert verdict.accepted, (entry, verdict)
        assert (entry.lower_bound or 0) <= entry.cost
        toppled = any(isinstance(action, Topple) for action in actions)
        assert entry.variant != "no-topple" or not toppled


def test_the_committed_list_reads_back_as_it_was_written(committed):
    assert csv_text(committed.sorted()) == (LIST / "best-known.csv").read_text()


def test_the_sizes_go_from_solved_to_unsolved_with_caps_and_without_topple(committed):
    for variants in ({"max-topple-4", "max-topple-2"}, {"no-topple"}):
        proven = {entry.proven for entry in committed.entries.values() if entry.variant in variants}
        assert proven == {True, False}


def test_the_table_of_the_docs_is_made_from_it(committed):
    page = (ROOT / "docs" / "open-instances.md").read_text()
    assert put_between(page, open_table(committed), "docs") == page
