"""The replay page of a recording made by hand: what it holds whatever things are called."""

import json
import re

import numpy as np
import pytest

from smash.execution.episode import Arrangement, Episode, Performed, Times, Totals
from smash.execution.recording import Recording
from smash.execution.replay import write_replay
from smash.execution.scene_file import default_scene

NASTY = ["{{data}}", "{{title}}", "<!--<script>", "</script>", "&amp;", "\\1"]


def recording_of(blocks, seconds=1.0, interval=0.08):
    """The arm at rest, the blocks in a row that slides."""
    taken = Recording()
    for moment in np.arange(0.0, seconds + interval / 2, interval):
        row = [[0.3 + 0.02 * moment, 0.06 * n, 0.0225, 0, 0, 0, 1] for n in range(blocks)]
        taken.times.append(float(moment))
        taken.joints.append(np.array([0, -0.4, 0, -2.2, 0, 1.8, 0.8, 0.04, 0.04]))
        taken.links.append(np.tile([0, 0, 0.3, 0, 0, 0, 1.0], (10, 1)))
        taken.blocks.append(np.array(row))
        taken.trays.append(np.zeros((0, 7)))
    return taken


def episode_of(name, *actions):
    return Episode(
        instance=name,
        planner="by hand",
        topple=True,
        max_topple=None,
        scene="default",
        seed=0,
        replanning=False,
        success=True,
        failure=None,
        plan_cost=len(actions),
        actions_executed=len(actions),
        replans=0,
        retries=0,
        times=Totals(offline=0, offline_cpu=0, online=0, online_cpu=0, execution=1, task=0),
        final=Arrangement(piles={}, table=[]),
        actions=[
            Performed(step=n + 1, action=list(action), origin="plan", begun=0.5 * n, times=Times(execution=0.5))
            for n, action in enumerate(actions)
        ],
    )


def data_of(page):
    """What a browser would parse: the text up to the first end of a script."""
    return json.loads(re.search(r'<script id="data" type="application/json">(.*?)</script', page, re.DOTALL)[1])


@pytest.mark.parametrize("name", NASTY)
def test_names_that_look_like_the_template_or_like_markup_are_only_names(name, tmp_path):
    episode = episode_of(name, ("pick", name, "s1"))
    write_replay(tmp_path / "r.html", recording_of(1), default_scene(), episode, [name])
    page = (tmp_path / "r.html").read_text(encoding="utf-8")
    assert data_of(page)["blocks"] == [name]
    assert data_of(page)["actions"][0]["text"] == f"pick {name} s1"
    assert page.count("<!--") == 0
    assert page.count("<script") == page.count("</script") == 2
    assert len(re.search(r"<h1>(.*?)</h1>", page)[1]) < 100
