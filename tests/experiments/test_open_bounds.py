"""The study of the open problems: every row says what was listed and what is proven now."""

from smash.experiments.studies.open_bounds import open_entries, rows


def test_bounds_on_an_open_problem_never_pass_its_plan():
    entries = open_entries("", "")
    assert entries
    assert all(not entry.proven for entry in entries)
    head, row, counts = rows(entries[:1], "greedy", 0.5)
    assert head.startswith("| instance | variant |")
    assert row.startswith(f"| {entries[0].instance} | {entries[0].variant} | {entries[0].cost} |")
    assert counts.endswith("0 bounds better than listed")


def test_goals_and_names_choose():
    assert {entry.instance[:7] for entry in open_entries("on", "open-on")} <= {"open-on"}
    assert open_entries("on", "few-buffers") == []
