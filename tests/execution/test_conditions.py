import dataclasses
from math import radians

import pytest

from smash.execution.layout.conditions import violations
from smash.execution.layout.drawing import draw
from smash.execution.scene.scene_file import default_scene
from smash.execution.scene.tabletop import Slot
from smash.execution.scene.tray import Tray


def scene(*stacks, buffers=()):
    return dataclasses.replace(default_scene(), stacks=stacks, buffers=buffers)


def stack(radius=0.45, angle=0.0, direction="counter-clockwise"):
    return Slot(radius, radians(angle), (direction,))


@pytest.mark.slow
def test_the_default_scene_keeps_both_conditions():
    assert violations(default_scene()) == []


def test_two_stacks_far_apart_keep_both_conditions():
    assert violations(scene(stack(), stack(angle=90))) == []


def test_a_stack_in_another_s_landing_strip_breaks_the_second_condition():
    (problem,) = violations(scene(stack(angle=0), stack(angle=25)), height=3)
    assert problem.condition == "monotone transformation"
    assert "stacks[1] lies in the strip" in problem.problem


def test_a_stack_out_of_reach_breaks_the_first_condition():
    found = violations(scene(stack(radius=0.95)), height=3)
    assert any(problem.condition == "non-interactivity" and "reach" in problem.problem for problem in found)


def test_high_piles_close_by_break_the_first_condition():
    close = [Slot(0.45, radians(angle)) for angle in (-9, 9)]
    found = violations(scene(stack(angle=120), buffers=(Slot(0.45, 0.0), *close)), buffer_height=9)
    assert any("leaves no room" in problem.problem for problem in found)


def test_a_tray_in_a_landing_strip_breaks_the_second_condition():
    with_tray = dataclasses.replace(scene(stack()), tray=Tray(0.045), stations=(Slot(0.45, radians(30)),))
    assert any("stations[0] lies in the strip" in problem.problem for problem in violations(with_tray, height=3))


def test_a_tray_that_takes_the_hand_s_room_breaks_the_first_condition():
    with_tray = dataclasses.replace(scene(stack()), tray=Tray(0.045), stations=(Slot(0.45, radians(-3)),))
    assert any("stations[0]" in problem.problem for problem in violations(with_tray, height=1))


def test_a_scene_is_drawn(tmp_path):
    draw(default_scene(), tmp_path / "scene.png")
    assert (tmp_path / "scene.png").read_bytes().startswith(b"\x89PNG")
