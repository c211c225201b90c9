"""The report: one page that needs nothing else, every figure from the records, every cell answered."""

import json
import re

import pandas as pd
import pytest
from smash_analysis.report.appendix import robot_given
from smash_analysis.report.grids import ablation_grids, coverage_grids
from smash_analysis.report.page import make, prose
from smash_analysis.report.pictures import scenes
from smash_analysis.report.sources import find_sources

from smash.records.reading import NoRecords
from tests.analysis.made_up import DOCUMENT, record, small_sweep, write


def behind(page):
    return json.loads(re.search(r'<script type="application/json" id="behind">(.*?)</script>', page, re.S).group(1))


def test_the_page_asks_for_nothing_outside_itself(report):
    page = report.read_text(encoding="utf-8")
    assert "http" not in re.sub(r"<pre.*?</pre>", "", page, flags=re.S)
    assert not re.search(r"<(link|script|img)[^>]+(src|href)=[\"'](?!data:)", page)


def test_every_identifier_is_there_once(report):
    identifiers = re.findall(r'\sid="([^"]*)"', report.read_text(encoding="utf-8"))
    assert len(identifiers) == len(set(identifiers))


def test_what_others_wrote_is_text_and_no_markup(report):
    page = report.read_text(encoding="utf-8")
    assert "<b></text>" not in page
    assert "&lt;b&gt;" in page
    assert page.count("</script>") == 3  # of the page itself


def test_every_cell_knows_the_runs_behind_it(report):
    page = report.read_text(encoding="utf-8")
    data = behind(page)
    cells = [int(number) for number in re.findall(r'data-cell="(\d+)"', page)]
    assert sorted(cells) == list(range(len(data["cells"])))
    for grid, entries in data["cells"]:
        store, extra = data["grids"][grid]
        assert entries
        assert all(len(entry) == 1 + len(extra) for entry in entries)
        assert all(entry[0] < len(data["stores"][store]["rows"]) for entry in entries)


def test_the_overview_says_what_the_records_say(report):
    page = report.read_text(encoding="utf-8")
    words = "15.5 actions without topple, 10.5 with topple on the 2 instances where both are proven"
    assert f"with 0 buffers: {words}" in page
    assert "Most proofs of optimality: p &amp; q 8 of 8." in page
    assert "No two planners contradict each other." in page


@pytest.mark.parametrize(("label", "given"), [("ur5", "ur5"), ("my-arm-0a1b2c3d", "my-arm.toml")])
def test_a_robot_is_given_as_it_can_be_typed(label, given):
    assert robot_given(label) == given


def test_code_in_a_sentence_is_code_and_the_rest_is_text():
    assert prose("`make <x>` & more") == "<code>make &lt;x&gt;</code> &amp; more"


def test_sets_stand_in_one_order_in_every_variant():
    rows = [("p", suite, variant, True, True) for suite, variant in (("a", "topple"), ("b", "no"), ("a", "no"))]
    runs = pd.DataFrame(rows, columns=["label", "suite", "variant", "solved", "proven"])
    grids = coverage_grids([], range(3), runs).grids
    assert [grid.columns for grid in grids] == [["a"], ["a"], ["a", "b"], ["a", "b"]]


def test_a_cell_of_the_heatmap_holds_the_readings_at_its_budget():
    runs = small_sweep()
    block = next(block for block in ablation_grids(runs) if block.title == "p & q on multi-9")
    actions = next(grid for grid in block.grids if grid.title == "Mean actions, with topple")
    early = actions.cells[actions.rows.index("0")][actions.columns.index("0.1")]
    late = actions.cells[actions.rows.index("0")][actions.columns.index("30")]
    assert (early.text, late.text) == ("12.5", "10.5")
    assert [entry[1:] for entry in early.entries] == [["12", "0.05"], ["13", "0.05"]]
    assert [runs[entry[0]].instance for entry in late.entries] == ["i0", "i1"]


def test_a_cell_without_a_plan_says_so_and_still_answers():
    block = next(block for block in ablation_grids(small_sweep()) if block.title == "weak on multi-9")
    actions = next(grid for grid in block.grids if grid.title == "Mean actions, without topple")
    cell = actions.cells[actions.rows.index("0")][-1]
    assert (cell.text, len(cell.entries)) == ("", 2)
    assert cell.words.endswith("no plan")


def test_parts_are_written_for_paper_too(report):
    parts = {file.relative_to(report.parent / "parts").as_posix() for file in report.parent.rglob("parts/*/*")}
    assert {f"first/first-heatmap-p-q-multi-9.{ending}" for ending in ("png", "pdf", "md", "tex", "csv")} <= parts
    assert {"first/first-topple-effect.md", "first/first-topple-effect.tex", "first/first-anytime.pdf"} <= parts
    latex = (report.parent / "parts" / "report.tex").read_text(encoding="utf-8")
    assert r"\end{document}" in latex
    assert ">TEX, one column</a>" in report.read_text(encoding="utf-8")
    assert "](first/first-anytime.png)" in (report.parent / "parts" / "report.md").read_text(encoding="utf-8")


def test_replays_are_linked_from_the_page_by_relative_links(report):
    assert 'href="../results/first/replays/i1--topple.html"' in report.read_text(encoding="utf-8")


def test_the_report_itself_is_no_source(tmp_path):
    write(tmp_path, [record(0)])
    write(tmp_path / "report" / "old", [record(0)])
    assert [source.path for source in find_sources(tmp_path, tmp_path / "report")] == [tmp_path]


def test_a_damaged_directory_is_named_beside_the_whole_ones(tmp_path):
    write(tmp_path / "whole", [record(0)])
    (tmp_path / "torn").mkdir()
    (tmp_path / "torn" / "runs.jsonl").write_text("{}\n{}\n")
    whole = {source.name: source for source in find_sources(tmp_path, tmp_path / "out")}
    assert "torn/runs.jsonl:1" in str(whole["torn"].problems[0])
    assert len(whole["whole"].runs) == 1


@pytest.mark.parametrize("files", [(), ("runs.jsonl",)])
def test_without_records_there_is_one_line(tmp_path, files):
    for name in files:
        (tmp_path / name).write_text("")
    with pytest.raises(NoRecords, match="no finished run"):
        make(tmp_path, tmp_path / "report")


@pytest.mark.parametrize(
    ("goal", "words"),
    [
        ({"kind": "positions", "positions": {"a": ["s2", 1]}}, "s1: empty; s2: a"),
        ({"kind": "on", "on": {"a": "c"}, "bottom": ["c"]}, "at the bottom: c, a"),
        ({"kind": "on", "on": {}}, "Goal, each pile from the bottom: "),
        ({"kind": "stacks", "stacks": {}}, "s1: empty; s2: empty"),
    ],
)
def test_every_kind_of_goal_is_drawn(goal, words):
    (start, drawn), _ = scenes(DOCUMENT | {"goal": goal, "table": ["c"]})
    assert words in drawn.words
    assert "table: c" in start.words
