"""Tree search, with obstacles made up in joint space."""

from itertools import pairwise

import numpy as np

from smash.motion import rrtconnect
from tests.robots import PANDA, READY


class Wall:
    """Joint 1 must not be within 0.2 rad of 0, unless joint 2 is above `gap` [rad]."""

    robot = PANDA

    def __init__(self, gap):
        self.gap = gap

    def free(self, joints):
        return bool(abs(joints[0]) > 0.2 or joints[1] > self.gap)

    def segment_free(self, begin, end):
        return all(self.free(begin + part * (end - begin)) for part in np.linspace(0, 1, 60))


def aside(turn):
    return READY + np.array([turn, 0, 0, 0, 0, 0, 0])


def test_the_way_leads_through_the_gap_and_stays_within_the_limits():
    wall = Wall(0.5)
    way = rrtconnect.connect(aside(-0.5), aside(0.5)[None], wall, 1)
    assert np.allclose(way[0], aside(-0.5))
    assert np.allclose(way[-1], aside(0.5))
    assert all(wall.segment_free(begin, end) for begin, end in pairwise(way))
    assert way[:, 1].max() > 0.5
    assert np.all((way >= PANDA.lower) & (way <= PANDA.upper))


def test_the_same_seed_finds_the_same_way_whatever_was_searched_before():
    first = rrtconnect.connect(aside(-0.5), aside(0.5)[None], Wall(0.5), 7)
    rrtconnect.connect(aside(0.6), aside(-0.6)[None], Wall(0.3), 2)
    assert np.array_equal(rrtconnect.connect(aside(-0.5), aside(0.5)[None], Wall(0.5), 7), first)


def test_of_several_goals_one_is_reached():
    goals = np.stack([aside(0.5), aside(-0.9)])
    way = rrtconnect.connect(aside(-0.5), goals, Wall(9.0), 1)
    assert np.allclose(way[-1], goals[1])


def test_a_search_without_a_way_gives_up(monkeypatch):
    monkeypatch.setattr(rrtconnect, "ITERATIONS", 200)
    assert rrtconnect.connect(aside(-0.5), aside(0.5)[None], Wall(9.0), 1) is None
