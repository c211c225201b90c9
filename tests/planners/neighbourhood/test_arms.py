"""Arms: what saves is tried more often, and nothing is left out for ever."""

import random
from collections import Counter

from smash.planners.neighbourhood.arms import Arm, choose


def tried(arms, gain, times):
    draw, counts = random.Random(1), Counter()
    for _ in range(times):
        arm = choose(arms, draw)
        counts[arm.size] += 1
        arm.paid(gain(arm), arm.width / 100)
    return counts


def test_in_the_long_run_arms_that_save_nothing_get_efforts_of_one_order():
    arms = [Arm(1, 1, 0.01), Arm(2, 10, 0.1)]
    counts = tried(arms, lambda arm: 0, 5000)
    assert 3 < counts[1] / counts[2] < 20  # an effort ten times as large, tried about a tenth as often


def test_an_arm_that_saves_gets_more_than_one_that_does_not():
    counts = tried([Arm(1, 1, 0.01), Arm(2, 1, 0.01)], lambda arm: arm.size - 1, 2000)
    assert counts[2] > 3 * counts[1] > 0


def test_old_gains_fade():
    arm = Arm(1, 1, 0.01)
    arm.paid(10, 0.0)
    for _ in range(100):
        arm.paid(0, 0.0)
    assert arm.gain < 0.01
