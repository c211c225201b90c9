"""The table of what an episode asks of the arm."""

from smash.execution.executor import Executor
from smash.execution.policy import OPEN
from smash.execution.scene.scene_file import default_scene
from smash.execution.trials.effort import Effort, report
from smash.problem import Pick, Place, PositionsGoal, make_instance
from tests.execution.episodes import plan_of


def test_every_step_is_measured_and_all_stays_within_the_limits():
    instance = make_instance(
        name="one", blocks=["a"], stacks=["s1", "s2"], start={"s1": ["a"]}, goal=PositionsGoal({"a": ("s2", 1)})
    )
    effort = Effort()
    executor = Executor(
        instance,
        plan_of("one", Pick("a", "s1"), Place("a", "s2")),
        default_scene(),
        policy=OPEN,
        on_frame=effort.begin,
    )
    text = report(effort, executor.run())
    shares = [float(figure) for what, figure in effort.rows() if "share" in what]
    assert len(shares) == 4
    assert 0 < min(shares) <= max(shares) <= 1
    assert len(effort.sent) == len(effort.torques) == len(executor.world.recorded) - 1
    assert text.splitlines()[-1] == "| blocks touched outside of grasps and pushes | 0 |"
