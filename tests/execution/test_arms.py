"""The arms that come with the package carry plans out, in every engine."""

import pytest

import smash
from smash.problem.extras import ENGINES
from tests.docs.blocks import ROOT


@pytest.mark.slow
@pytest.mark.parametrize("engine", ENGINES)
@pytest.mark.parametrize("robot", ["ur5", "xarm7"])
def test_an_arm_carries_out_the_paper_s_figure(robot, engine):
    pytest.importorskip(ENGINES[engine])
    instance = smash.read_instance(ROOT / "examples" / "figure1.json")
    plan = smash.plan(instance, "astar")
    first = smash.execute(instance, plan, engine=engine, robot=robot, replan=False)
    assert first.success, first.failure
    assert (first.robot, first.engine) == (robot, engine)
    again = smash.execute(instance, plan, engine=engine, robot=robot, replan=False)
    assert first.without_measured_times() == again.without_measured_times()


@pytest.mark.slow
def test_a_sweep_of_the_ur5_stops_sharply_enough_for_the_pile_to_come_apart():
    """With 5 rad/s2 the upper of two blocks stays on the lower one, and neither is picked up."""
    pytest.importorskip("mujoco")
    instance = smash.suite("multi-6")[0]
    plan = smash.plan(instance, "astar")
    assert smash.execute(instance, plan, engine="mujoco", robot="ur5", replan=False).success
