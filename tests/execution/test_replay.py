"""The replay page of a recording made by hand: what it holds whatever things are called, and what a browser shows."""

import base64
import json
import re

import numpy as np
import pytest

from smash.execution.scene.scene_file import default_scene
from smash.execution.viewing.replay import goal_in_words, write_replay
from smash.problem import OnGoal, PositionsGoal, StacksGoal, make_instance
from tests.browser import CHROMIUM, Browser
from tests.execution.made_up import episode_of, recording_of
from tests.execution.scooping import scoop, scoop_scene

in_a_browser = pytest.mark.skipif(CHROMIUM is None, reason="no Chromium")
NASTY = ["{{data}}", "{{title}}", "<!--<script>", "</script>", "&amp;", "\\1"]


def data_of(page):
    """What a browser would parse: the text up to the first end of a script."""
    return json.loads(re.search(r'<script id="data" type="application/json">(.*?)</script', page, re.DOTALL)[1])


def one_block(name="b1", location="s1"):
    return make_instance(
        name="one",
        blocks=[name],
        stacks=[location, "s2"],
        buffers=["u1"],
        start={location: [name]},
        goal=PositionsGoal({name: ("s2", 1)}),
    )


@pytest.mark.parametrize("name", NASTY)
def test_names_that_look_like_the_template_or_like_markup_are_only_names(name, tmp_path):
    episode = episode_of(name, ("pick", name, name))
    write_replay(tmp_path / "r.html", recording_of(1), default_scene(), episode, one_block(name, name))
    page = (tmp_path / "r.html").read_text(encoding="utf-8")
    data = data_of(page)
    assert data["blocks"] == [name]
    assert data["places"][0][0] == name
    assert data["actions"][0]["text"] == f"pick {name} {name}"
    assert page.count("<!--") == 0
    assert page.count("<script") == page.count("</script") == 2
    assert len(re.search(r"<h1>(.*?)</h1>", page)[1]) < 100


@pytest.mark.parametrize(
    ("goal", "words"),
    [
        (StacksGoal({"s2": ("b1", "b2"), "s3": (), "s1": ("b3",)}), "s2 = b1 b2; s1 = b3 (bottom first)"),
        (PositionsGoal({"b2": ("s3", 2), "b1": ("s3", 1)}), "s3 = b1 b2 (bottom first, other blocks anywhere)"),
        (OnGoal({"b2": "b1", "b3": "b2"}, ("b1",)), "b2 on b1; b3 on b2; b1 at the bottom"),
        (OnGoal({"b2": "b1"}, (), ("b1",), ("b2", "b3")), "b2 on b1; b1 on the table; b2 clear; b3 clear"),
        (StacksGoal({"s1": ()}), "nothing"),
        (OnGoal({}), "nothing"),
    ],
)
def test_goals_in_words(goal, words):
    assert goal_in_words(goal) == words


def test_each_location_and_station_is_named_beyond_its_place_and_unused_slots_are_not(tmp_path):
    scene, instance = scoop_scene(), scoop()
    recording = recording_of(4)
    recording.trays = [np.array([[0, 0, 0, 0, 0, 0, 1.0]]) for _ in recording.times]
    write_replay(tmp_path / "r.html", recording, scene, episode_of("scoop"), instance)
    named = {name: (x, y) for name, x, y in data_of((tmp_path / "r.html").read_text(encoding="utf-8"))["places"]}
    slots = scene.bind(instance) | scene.bind_stations(instance)
    assert list(named) == list(slots) == ["s1", "s2", "g1", "g2", "left", "right"]
    for name, slot in slots.items():
        assert np.hypot(*named[name]) > slot.radius + scene.side / 2
        assert slot.distance(*named[name]) < 0.1


@pytest.fixture(scope="module")
def browser():
    with Browser() as opened:
        yield opened


@pytest.fixture
def page(tmp_path):
    episode = episode_of("one", ("pick", "b1", "s1"), ("place", "b1", "s2"))
    write_replay(tmp_path / "r.html", recording_of(1), default_scene(), episode, one_block())
    return tmp_path / "r.html"


def test_gap_tasks_and_what_is_touched_are_told(page):
    data = data_of(page.read_text(encoding="utf-8"))
    assert [action["gap"] for action in data["actions"]] == [False, False]
    assert data["touched"][0] == [0]
    assert data["touched"][-1] == []
    poses = np.frombuffer(base64.b64decode(data["poses"]), dtype="<i2").reshape(-1, 7) * data["unit"]
    assert poses[0] == pytest.approx([0.3, 0.0, 0.0225, 0, 0, 0, 1], abs=1e-4)


SHOWN = "[...document.querySelectorAll('.label')].filter(l => l.checkVisibility()).map(l => l.textContent)"


@in_a_browser
def test_the_names_of_blocks_and_places_are_shown_until_they_are_hidden(browser, page):
    browser.open(page)
    if browser.run("gl === null"):
        pytest.skip("no WebGL")
    assert {"b1", "s1", "s2"} <= set(browser.run(SHOWN)) <= {"b1", "s1", "s2", "u1"}
    assert browser.run("document.querySelector('#goal').textContent").startswith("goal: s2 = b1 (bottom first")
    assert not browser.run("document.querySelector('#blind').checkVisibility()")
    browser.click("#names")
    assert browser.run(SHOWN) == []
    assert browser.errors() == []
    assert browser.requests() == []


@in_a_browser
def test_what_stands_before_a_place_hides_its_name(browser, page):
    browser.open(page)
    if browser.run("gl === null"):
        pytest.skip("no WebGL")
    name = "[...document.querySelectorAll('.place')].find(l => l.textContent === 's2').checkVisibility()"
    look = "playing = false; [turn, tilt, target] = [Math.atan2({y}, {x}), 0.1, [0, 0, 0.1]]; paint(); " + name
    _, x, y = data_of(page.read_text(encoding="utf-8"))["places"][1]
    assert browser.run(look.format(x=x, y=y))
    assert not browser.run(look.format(x=-x, y=-y))


@in_a_browser
def test_a_long_goal_is_cut_in_the_header_and_whole_in_its_title(browser, tmp_path):
    names = [f"block number {n}" for n in range(12)]
    instance = make_instance(
        name="long", blocks=names, stacks=["s1", "s2"], start={"s1": names}, goal=StacksGoal({"s2": tuple(names)})
    )
    write_replay(tmp_path / "r.html", recording_of(12), default_scene(), episode_of("long"), instance)
    browser.open(tmp_path / "r.html", 800)
    assert browser.run("(g => g.scrollWidth > g.clientWidth && g.title.endsWith('(bottom first)'))(el('goal'))")
    assert browser.run("document.querySelector('header').clientHeight") < 60
    assert browser.run("document.documentElement.scrollWidth <= innerWidth")


@in_a_browser
def test_without_webgl_a_line_says_so_and_list_and_clock_go_on(page):
    with Browser() as browser:
        hidden = "HTMLCanvasElement.prototype.getContext = () => null"
        browser.call("Page.addScriptToEvaluateOnNewDocument", source=hidden)
        browser.open(page)
        assert browser.run("document.querySelector('#blind').checkVisibility()")
        assert browser.run("document.querySelector('#result').textContent") == "success"
        browser.click("#actions li:nth-child(2)")
        browser.run("playing = false; now = 0.5; paint()")
        assert browser.run("document.querySelector('[aria-current]').textContent") == "place b1 s2"
        assert browser.run("document.querySelector('#clock').textContent").startswith("0.5 / 1.0")
        assert browser.errors() == []
