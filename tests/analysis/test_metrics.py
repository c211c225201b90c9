"""Metrics of others: what they give, and that one which is broken breaks nothing else."""

import math

from smash_analysis import metrics
from smash_analysis.tables.runs import runs_table

from tests.analysis.made_up import record


def test_a_metric_becomes_a_column_and_a_failing_one_is_named(monkeypatch, capsys):
    def topples(run):
        return sum(action[0] == "topple" for action in run["actions"] or []) if run["actions"] else None

    monkeypatch.setattr(metrics, "metrics", lambda: {"topples": topples, "wrong": lambda run: run["nothing"]})
    table = runs_table([record(actions=[["topple", "s1", 1], ["pick", "b1", "table"]]), record()])
    assert table["metric.topples"][0] == 1
    assert math.isnan(table["metric.topples"][1])
    assert table["metric.wrong"].isna().all()
    assert metrics.metric_names(table) == ["topples", "wrong"]
    assert "metric 'wrong' fails on 2 runs: KeyError" in capsys.readouterr().err


def test_a_metric_is_given_the_record_as_plain_data(monkeypatch):
    given = []
    monkeypatch.setattr(metrics, "metrics", lambda: {"keep": given.append})
    run = record(actions=[["pick", "b1", "s1"]], details={"nodes": 7})
    assert runs_table([run])["metric.keep"].isna().all()
    assert given == [run.document]
    assert given[0]["actions"] == [["pick", "b1", "s1"]]
    assert given[0]["commit"]["hash"] == "c"
