"""From records to cells, ratios, findings and pictures."""

import math

import pandas as pd
import pytest
from smash_analysis.ablation import make
from smash_analysis.charts.heatmaps import ratio_place, ratio_reach
from smash_analysis.statistics.findings import findings, smallest_buffers
from smash_analysis.tables.cells import matched_cells, variant_cells
from smash_analysis.tables.readings import cutoff_check, readings
from smash_analysis.tables.runs import incumbents_table, runs_table
from smash_analysis.tables.writing import median_iqr, of_seconds

from smash.problem.errors import MalformedFile
from smash.records.believing import believed_runs
from tests.analysis.made_up import record, write


def cell(cells, **where):
    for name, value in where.items():
        cells = cells[cells[name] == value]
    assert len(cells) == 1
    return cells.iloc[0]


def test_one_anytime_run_fills_a_row():
    read = readings([record(0, [(0.5, 9), (2.0, 7)])])
    assert read["budget"].tolist() == [0.1, 1.0, 30.0]
    assert read["solved"].tolist() == [False, True, True]
    assert read["cost"].fillna(-1).tolist() == [-1, 9, 7]


def test_a_run_of_one_budget_speaks_for_that_alone():
    read = readings([record(0, [(0.5, 9)], kind="budget", budget=1.0)])
    assert read["budget"].tolist() == [1.0]


def test_a_refused_answer_is_no_success():
    assert not readings([record(0, [(0.0, 5)], outcome="refused")])["solved"].any()


def test_means_are_over_the_runs_solved_in_that_cell():
    read = readings([record(0, [(0.05, 10)]), record(1, [(0.5, 20)]), record(2)])
    cells = variant_cells(read)
    assert cell(cells, budget=0.1)["success"] == pytest.approx(1 / 3)
    assert cell(cells, budget=0.1)["mean_cost"] == 10
    assert cell(cells, budget=1.0)["mean_cost"] == 15


def test_the_ratio_is_given_over_common_instances_and_over_all():
    read = readings(
        [
            record(0, [(0.05, 10)], variant="topple"),
            record(1, [(0.05, 30)], variant="topple"),
            record(0, [(0.05, 20)], variant="no-topple"),
            record(1, variant="no-topple"),
        ]
    )
    pair = cell(matched_cells(read), budget=30.0)
    assert (pair["common"], pair["ratio_common"], pair["ratio_all"]) == (1, 2.0, 1.0)


def test_no_common_instance_gives_no_ratio():
    read = readings([record(0, [(0.0, 10)]), record(1, variant="topple"), record(1, [(0.0, 9)], variant="no-topple")])
    pair = cell(matched_cells(read), budget=30.0)
    assert pair["common"] == 0
    assert math.isnan(pair["ratio_common"])


def test_the_smallest_buffer_count_that_reaches_nine_in_ten():
    late, early, never = [(5.0, 9)], [(0.01, 9)], []
    runs = [record(n, never if n < 2 else early, buffers=0) for n in range(10)]
    runs += [record(n, never if n < 1 else late, buffers=4) for n in range(10)]
    runs += [record(n, early, buffers=8) for n in range(10)]
    cells = variant_cells(readings(runs))
    assert smallest_buffers(cells, every_budget=False) == 4
    assert smallest_buffers(cells, every_budget=True) == 8
    assert smallest_buffers(cells[cells["buffers"] == 0], every_budget=False) is None


def test_real_cutoffs_are_compared_with_the_reading():
    runs = [record(0, [(0.05, 9), (0.5, 7)]), record(0, [(0.06, 9), (0.9, 8)], kind="cutoff", budget=1.0)]
    check = cutoff_check(runs)
    assert (check["cost_read"].tolist(), check["cost_cut"].tolist()) == ([7], [8])
    assert "mean difference (cut off - read) +1.00" in findings(
        variant_cells(readings(runs)), matched_cells(readings(runs)), check
    )


@pytest.mark.parametrize("variants", [("topple", "no-topple"), pytest.param(("topple",), marks=pytest.mark.slow)])
def test_pictures_tables_and_words_are_made(tmp_path, variants):
    runs = [record(n, [(0.5, 20 + n)], variant=v, buffers=b) for n in range(3) for v in variants for b in (0, 12)]
    files = make(write(tmp_path, runs), tmp_path / "out")
    assert all(file.stat().st_size > 0 for file in files)
    assert {file.suffix for file in files} == {".csv", ".md", ".png", ".pdf", ".tex"}
    assert len(pd.read_csv(tmp_path / "out" / "cells.csv")) == 3 * 2 * len(variants)


def test_a_half_written_last_line_is_left_out(tmp_path):
    write(tmp_path, [record(0), record(1)])
    with open(tmp_path / "runs.jsonl", "a") as file:
        file.write('{"format": "smash-ru')
    assert len(believed_runs(tmp_path).records) == 2


@pytest.mark.parametrize("content", ["", "{}\n{}\n", "[1]\n\n"])
def test_a_file_without_records_is_refused(tmp_path, content):
    (tmp_path / "runs.jsonl").write_text(content)
    with pytest.raises(MalformedFile):
        believed_runs(tmp_path)


def test_runs_and_incumbents_are_tidy_tables():
    runs = [record(0, [(0.5, 9), (2.0, 7)]), record(1)]
    table = runs_table(runs)
    assert table["first_seconds"].fillna(-1).tolist() == [0.5, -1]
    assert table["best_seconds"].fillna(-1).tolist() == [2.0, -1]
    assert incumbents_table(runs)["cost"].tolist() == [9, 7]


def test_a_ratio_of_1_is_the_middle_of_its_scale_and_2_as_far_from_it_as_a_half():
    reach = ratio_reach([1.2, 0.5])
    assert reach == 2
    assert [round(ratio_place(ratio, reach), 9) for ratio in (0.5, 1, 2)] == [0, 0.5, 1]
    assert ratio_reach([]) == 1.5


def test_seconds_that_would_round_to_zero_are_milliseconds():
    assert of_seconds(median_iqr, pd.Series([0.001, 0.002, 0.003])) == "2.00 [1.50, 2.50] ms"
    assert of_seconds(median_iqr, pd.Series([0.5, 0.5])) == "0.50 [0.50, 0.50]"
    assert of_seconds(median_iqr, pd.Series([], dtype=float)) == "–"
