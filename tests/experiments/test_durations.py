"""Costs fitted to durations: what went into made-up episodes comes out again."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from smash.experiments.studies.durations import Duration, durations, fit
from smash.records.episodes import Performed, Times
from tests.execution.scooping import scoop

PLACES = {name: (x, 0.0) for name, x in {"s1": 0.0, "s2": 0.1, "g1": 1.0, "g2": 1.1, "left": 0.2, "right": 1.2}.items()}
PLACES["table"] = (0.0, 0.3)
seconds = st.floats(0.5, 10.0)


@given(seconds, seconds, st.floats(0.0, 5.0))
def test_bases_and_travel_come_out_again(pick, place, per_metre):
    measured = [Duration("pick", 0.0, pick)] + [
        Duration("place", way, place + per_metre * way) for way in (0.1, 0.5, 1)
    ]
    fitted = fit(measured)
    assert fitted.bases == pytest.approx({"pick": pick, "place": place}, abs=1e-6)
    assert fitted.per_metre == pytest.approx(per_metre, abs=1e-6)
    assert fitted.costs(PLACES).of("pick") == round(1000 * pick)


def row(*action, time=1.0, outcome="done", attempts=1):
    times = Times(execution=time)
    return Performed(step=1, action=list(action), origin="plan", outcome=outcome, attempts=attempts, times=times)


def test_an_episode_counts_as_far_as_it_went_as_planned():
    rows = [
        row("topple", "s1", 2, time=3.0),
        row("pick", "a", "s1"),
        row("place", "a", "tray", time=2.0),
        row("carry", "tray", "right", time=5.0),
        row("pick", "a", "tray", outcome="slip"),
        row("pick", "a", "tray"),
    ]
    found = list(durations(rows, scoop(), PLACES))
    assert [(d.kind, d.seconds) for d in found] == [("topple", 3.0), ("pick", 1.0), ("place", 2.0), ("carry", 5.0)]
    assert [d.travel for d in found] == pytest.approx([0.0, 0.0, 0.2, 1.0])


def test_nothing_measured_is_no_fit():
    with pytest.raises(ValueError, match="no action"):
        fit([])
