"""The README's figures and tables are those of the committed results."""

import shutil
from pathlib import Path

import pytest
from smash_analysis.readme import COPIED, DRAWN, PAGES, data_hash, shown_hash, update

ROOT = Path(__file__).parents[2]


@pytest.fixture
def pages(tmp_path):
    """A copy of what the command writes to."""
    for name in (*PAGES, *DRAWN, *COPIED):
        (tmp_path / name).parent.mkdir(parents=True, exist_ok=True)
        if (ROOT / name).is_file():
            shutil.copyfile(ROOT / name, tmp_path / name)
    return tmp_path


def test_the_committed_figures_and_tables_are_current(pages):
    became = dict(update(ROOT / "results", pages))
    assert [name for name, what in became.items() if what == "made"] == [], "run: python -m smash_analysis.readme"
    assert {became[name] for name in DRAWN} == {"current"}


def test_a_figure_of_other_data_is_drawn_again(pages):
    name = "docs/figures/scaling-proofs.png"
    results = pages / "results"
    shutil.copytree(ROOT / "results" / "scaling", results / "scaling")
    table = results / "scaling" / "scaling.csv"
    first, *rest = table.read_text().splitlines()
    table.write_text("\n".join([first, *rest[:40]]) + "\n")
    before = shown_hash(pages / name)
    assert dict(update(results, pages))[name] == "made"
    assert shown_hash(pages / name) != before
    became = dict(update(results, pages))
    assert became[name] == "current"
    assert became["docs/figures/ablation-layered-cold.png"].startswith("left: ")


def test_a_table_between_marks_is_that_of_the_file(pages):
    (pages / "results").mkdir()
    (pages / "results" / "few.md").write_text("| new |\n|---|\n")
    (pages / "README.md").write_text("a\n<!-- few.md -->\n| old |\n<!-- end -->\nb\n<!-- no.md -->\nc\n<!-- end -->\n")
    became = dict(update(pages / "results", pages))
    assert became["README.md, table few.md"] == "made"
    assert became["README.md, table no.md"].startswith("left: ")
    page = (pages / "README.md").read_text()
    assert page == "a\n<!-- few.md -->\n| new |\n|---|\n<!-- end -->\nb\n<!-- no.md -->\nc\n<!-- end -->\n"


def test_the_hash_is_of_values_not_of_how_they_are_stored():
    import pandas as pd

    one = pd.DataFrame({"a": [1.0, 0.1 + 0.2]})
    assert data_hash(one) == data_hash(pd.DataFrame({"a": [1.0, 0.3]})) != data_hash(one + 1)
