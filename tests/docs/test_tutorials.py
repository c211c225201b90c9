"""Every block of the tutorials runs, typed from top to bottom."""

import pytest

from tests.docs.blocks import ROOT, Typed

TUTORIALS = ROOT / "docs" / "tutorials"


@pytest.mark.slow
def test_a_first_plan(tmp_path):
    (tmp_path / "examples").symlink_to(ROOT / "examples")
    assert Typed(tmp_path).run(TUTORIALS / "first-plan.md") >= 10


@pytest.mark.slow
def test_own_planner_to_own_heatmap(tmp_path):
    pytest.importorskip("pandas")
    typed = Typed(tmp_path)
    assert typed.run(TUTORIALS / "own-planner.md") == 8
    for name in ("heatmap-put-aside-my-set.png", "report/index.html"):
        assert (tmp_path / "runs" / "mine" / name).is_file(), sorted((tmp_path / "runs").rglob("*"))


def test_every_tutorial_is_tested():
    assert {page.name for page in TUTORIALS.glob("*.md")} == {"first-plan.md", "own-planner.md"}


@pytest.mark.slow
def test_the_page_on_data(tmp_path):
    for name in ("examples", "results"):
        (tmp_path / name).symlink_to(ROOT / name)
    assert Typed(tmp_path).run(ROOT / "docs" / "dataset.md") >= 5
