"""Every block of the tutorials runs, typed from top to bottom."""

import json

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


@pytest.mark.slow
def test_from_a_urdf_to_an_episode(tmp_path):
    pytest.importorskip("pinocchio")
    typed = Typed(tmp_path)
    assert typed.run(TUTORIALS / "bring-your-arm.md") == 10
    episode = json.loads((tmp_path / "episode.json").read_text())
    assert episode["success"]
    assert episode["robot"].startswith("my-arm-")
    assert (tmp_path / "episode.html").stat().st_size > 100_000


def test_every_tutorial_is_tested():
    assert {page.name for page in TUTORIALS.glob("*.md")} == {"bring-your-arm.md", "first-plan.md", "own-planner.md"}


@pytest.mark.slow
def test_the_page_on_data(tmp_path):
    for name in ("examples", "results"):
        (tmp_path / name).symlink_to(ROOT / name)
    assert Typed(tmp_path).run(ROOT / "docs" / "dataset.md") >= 5
