"""Experiment files: what they mean, and that a bad one is refused in one line before anything runs."""

import pytest

from smash.experiments.sweeps.experiment import experiment_runs, read_experiment
from smash.problem import MalformedFile
from smash.problem.buffers import with_buffers
from smash.problem.sets.suites import read_suite

GOOD = """
name = "try"
suites = ["multi-4"]
instances = 2
buffers = [0, 3]
budgets = [0.5, 0.1, 2]
[[planners]]
name = "greedy"
"""


def runs_of(tmp_path, text):
    file = tmp_path / "experiment.toml"
    file.write_text(text)
    return experiment_runs(read_experiment(file), tmp_path)


def test_the_largest_budget_stands_for_the_smaller_ones(tmp_path):
    runs = runs_of(tmp_path, GOOD)
    assert len(runs) == 2 * 2 * 2
    assert {(run.kind, run.job.budget, run.budgets) for run in runs} == {("anytime", 2.0, (0.1, 0.5, 2))}
    assert {len(run.job.instance.buffers) for run in runs} == {0, 3}
    assert {run.job.options.topple for run in runs} == {True, False}


@pytest.mark.usefixtures("third_party")
@pytest.mark.parametrize(("planner", "kind", "count"), [("bare", "budget", 24), ("sound", "anytime", 8)])
def test_a_planner_that_depends_on_its_budget_is_run_at_each(tmp_path, planner, kind, count):
    runs = runs_of(tmp_path, GOOD.replace("greedy", planner))
    assert [run.kind for run in runs] == [kind] * count


def test_a_sample_is_cut_off_at_each_smaller_budget(tmp_path):
    runs = runs_of(tmp_path, "cutoff_sample = 3" + GOOD)
    assert sorted(run.job.budget for run in runs if run.kind == "cutoff") == [0.1, 0.1, 0.1, 0.5, 0.5, 0.5]


def test_a_planner_may_have_a_grid_and_a_label_of_its_own(tmp_path):
    grid = 'suites = ["single-4"]\nbuffers = [1]\nvariants = ["max-topple-2"]\n'
    more = f'[[planners]]\nname = "greedy"\nlabel = "small"\n{grid}'
    mine = [run for run in runs_of(tmp_path, GOOD + more) if run.label == "small"]
    assert len(mine) == 2
    assert {(run.suite, run.variant, run.job.options.max_topple) for run in mine} == {("single-4", "max-topple-2", 2)}


def test_a_planner_for_seconds_is_run_at_each_budget_under_a_name_of_its_own(tmp_path):
    grid = 'objective = "seconds"\nsuites = ["single-4"]\nbuffers = [1]\nvariants = ["topple"]\n'
    mine = [run for run in runs_of(tmp_path, f'{GOOD}[[planners]]\nname = "greedy"\n{grid}') if run.suite == "single-4"]
    assert {(run.label, run.kind, run.job.settings.objective) for run in mine} == {
        ("greedy (seconds)", "budget", "seconds")
    }
    assert len(mine) == 2 * 3
    with pytest.raises(MalformedFile, match="actions, seconds"):
        runs_of(tmp_path, f'{GOOD}objective = "speed"')


def test_instances_come_one_after_the_other(tmp_path):
    names = [run.job.instance.name for run in runs_of(tmp_path, GOOD)]
    assert names == sorted(names)


def test_keys_are_the_same_each_time_and_differ_between_runs(tmp_path):
    keys = [run.key for run in runs_of(tmp_path, GOOD)]
    assert keys == [run.key for run in runs_of(tmp_path, GOOD)]
    assert len(set(keys)) == len(keys)


@pytest.mark.parametrize(
    ("old", "new", "words"),
    [
        ("name = ", "name: ", "not TOML"),
        ('"try"', '"../try"', "no plain file name"),
        ('"try"', "3", "`name`"),
        ('name = "try"', "", "`name`"),
        ("multi-4", "multi-5", "multi-4, multi-6"),
        ("[[planners]]", "[[planner]]", "planner"),
        ('"greedy"', '"gredy"', "known: "),
        ('"greedy"', '"greedy"\nwarm_start = "x"', "known: "),
        ('"greedy"', '"greedy"\nhorizn = 3', "horizn"),
        ('"greedy"', '"greedy"\nsolver = "cplex"', "'cplex' is not allowed; highs, cpsat, scip, gurobi"),
        ('"greedy"', '"greedy"\nlabel = "g"\n[[planners]]\nname = "greedy"\nsolver = "cpsat"\nlabel = "g"', "label"),
        ('"greedy"', '"greedy"\nthreads = 0', "threads"),
        ('"greedy"', '"greedy"\nthreads = 100000', "threads"),
        ("[0.5, 0.1, 2]", "[0.5, -1]", "-1.0 is not allowed"),
        ("[0.5, 0.1, 2]", "[]", "empty"),
        ("[0.5, 0.1, 2]", "[nan]", "not allowed"),
        ("[0.5, 0.1, 2]", "[1, 1]", "twice"),
        ("[0, 3]", "[0, 1.5]", "buffers"),
        ("[0, 3]", "[-1]", "-1 is not allowed"),
        ("instances = 2", "instances = 0", "instances"),
        ("instances = 2", 'variants = ["toppel"]', "no-topple"),
        ("instances = 2", "jobs = 0", "jobs"),
        ("instances = 2", "memory = 0", "memory"),
        ("instances = 2", "seeds = []", "seeds"),
        ('"greedy"', '"greedy"\n[[planners]]\nname = "greedy"', "twice"),
        ('"greedy"', '"greedy"\n[[planners]]\nname = "greedy"\nhorizon = 4', "label"),
    ],
)
def test_a_bad_file_is_refused_in_one_line(tmp_path, old, new, words):
    assert old in GOOD
    with pytest.raises(MalformedFile) as refused:
        runs_of(tmp_path, GOOD.replace(old, new, 1))
    assert words in str(refused.value)
    assert "\n" not in str(refused.value)


def test_buffers_that_hold_blocks_stay_and_new_names_are_fresh():
    instance = read_suite("multi-4")[0]
    assert with_buffers(instance, 2).buffers == ("u1", "u2")
    assert with_buffers(instance, 14).buffers[-2:] == ("u13", "u14")
    assert with_buffers(instance, 12) == instance


def test_the_solver_is_part_of_a_run_its_key_and_its_label(tmp_path):
    runs = runs_of(tmp_path, GOOD.replace('"greedy"', '"smash-flow"\nsolver = "cpsat"', 1))
    chosen = {run.label: run.job.settings.solver for run in runs}
    assert chosen["smash-flow (cpsat)"] == "cpsat"
    others = runs_of(tmp_path, GOOD.replace('"greedy"', '"smash-flow"\nlabel = "smash-flow (cpsat)"', 1))
    assert {run.key for run in runs if run.label == "smash-flow (cpsat)"}.isdisjoint(run.key for run in others)
