"""The comparison's figures: common subsets, gaps, contradictions, failures, curves."""

import math

import numpy as np
import pytest
from smash_analysis.charts.curves import best_known, coverage_curve, quality_curve
from smash_analysis.comparison import compared, comparison_table, failure_table, make, outcome_table
from smash_analysis.tables.believed import believed_of
from smash_analysis.tables.paradigms import TOGETHER, paradigm_table

from tests.analysis.made_up import record, write


def one(table, **where):
    for name, value in where.items():
        table = table[table[name] == value]
    assert len(table) == 1
    return table.iloc[0]


def test_common_costs_are_over_problems_that_every_able_planner_solved():
    runs = [
        record(0, [(1.0, 10)], label="a"),
        record(1, [(1.0, 30)], label="a"),
        record(0, [(1.0, 12)], label="b"),
        record(1, label="b"),
        record(0, label="never"),
        record(1, label="never"),
    ]
    table = comparison_table(compared(runs))
    assert one(table, planner="a")["cost, common"] == "10.00 ± 0.00 (n=1)"
    assert one(table, planner="a")["cost, solved"] == "20.00 ± 14.14"
    assert one(table, planner="never")["coverage"] == "0/2"


def test_gaps_are_to_proven_optima_only():
    runs = [
        record(0, [(1.0, 10)], label="a", status="optimal", lower_bound=10),
        record(0, [(1.0, 12)], label="b"),
        record(1, [(1.0, 9)], label="b"),
    ]
    gaps = compared(runs)["gap"].tolist()
    assert gaps[:2] == pytest.approx([0.0, 0.2])
    assert math.isnan(gaps[2])


def test_gaps_are_never_negative_where_a_planner_lies(tmp_path):
    lie = record(0, [(1.0, 12)], label="liar", status="optimal", outcome="optimal")
    truth = [
        record(0, [(1.0, 10)], label="b"),
        record(1, [(1.0, 9)], label="liar", status="optimal", outcome="optimal"),
    ]
    found = believed_of(write(tmp_path, [lie, *truth]))
    runs = compared(found.records)
    assert runs["gap"].isna().all()
    assert not runs["proven"].any()
    (line,) = map(str, found.contradictions)
    assert line.endswith("liar says that no plan is cheaper than 12, b has a plan of 10")


def test_every_failure_is_counted_with_its_reason():
    runs = compared([record(0, outcome="crashed", reason="boom"), record(1), record(2, [(0.1, 3)])])
    assert failure_table(runs)["reason"].tolist() == ["boom", "no plan by the budget"]
    assert one(outcome_table(runs), planner="p")["feasible"] == 1


def test_curves_count_every_problem_at_every_time():
    runs = [record(0, [(0.5, 20), (2.0, 10)]), record(1)]
    times = np.array([0.1, 1.0, 10.0])
    assert coverage_curve(runs, times).tolist() == [0, 0.5, 0.5]
    assert quality_curve(runs, best_known(runs), times).tolist() == [0, 0.25, 0.5]


def test_a_problem_that_is_solved_at_the_start_has_full_quality():
    runs = [record(0, [(0.0, 0)])]
    assert quality_curve(runs, best_known(runs), np.array([1.0])).tolist() == [1.0]


def ended(number, planner, seconds, cost=9, **more):
    proven = {"status": "optimal", "lower_bound": 9} if cost == 9 else {}
    return record(number, [(0.1, cost)], label=planner, wall_seconds=seconds, **proven | more)


def test_each_paradigm_is_shown_by_its_best_planner_and_the_quickest_that_proves_most_wins():
    runs = [ended(n, "smash", 0.1) for n in range(2)]
    runs += [ended(n, "fd-opt:chain", 2.0 + n) for n in range(2)]
    runs += [ended(0, "symk-opt", 0.5), record(1, label="symk-opt")]
    runs += [ended(n, "clingo", 1.0) for n in range(2)]
    runs += [ended(n, "fd-lama", 5.0, cost=11) for n in range(2)]
    (row,) = paradigm_table(compared(runs)).to_dict("records")
    assert row[TOGETHER] == "2/2 in 0.10 s"
    assert row["PDDL, optimal"] == "2/2 in 2.50 s"
    assert row["PDDL, satisficing"] == "+22 %"
    assert row["wins"] == "answer sets"


def test_a_planner_with_fewer_runs_than_others_is_not_compared():
    runs = [ended(n, "didp", 1.0) for n in range(2)] + [ended(0, "clingo", 0.1), record(0, label="mine")]
    (row,) = paradigm_table(compared(runs)).to_dict("records")
    assert (row["answer sets"], row["mine"], row["wins"]) == ("", "", "dynamic programming")


def test_a_paradigm_without_a_plan_says_so():
    runs = [record(0, label="enhsp"), ended(0, "greedy", 0.1, cost=11)]
    (row,) = paradigm_table(compared(runs)).to_dict("records")
    assert (row["PDDL, satisficing"], row["greedy"], row["wins"]) == ("no plan", "plans", "greedy")


def test_processor_seconds_are_of_all_runs_that_recorded_them():
    runs = [record(0, [(1.0, 10)], cpu_seconds=2.0), record(1, cpu_seconds=4.0), record(2, cpu_seconds=None)]
    assert one(comparison_table(compared(runs)), planner="p")["CPU [s]"] == "3.00 [2.50, 3.50]"


@pytest.mark.slow
def test_tables_and_curves_are_made(tmp_path):
    runs = [record(n, [(0.5, 9)], variant=v, label=x) for n in range(2) for v in ("topple", "no-topple") for x in "ab"]
    files = make(write(tmp_path, runs), tmp_path / "out")
    assert all(file.stat().st_size > 0 for file in files)
