"""`smash frontier`: the exact cost against the number of buffers."""

import csv

from click.testing import CliRunner

from smash.cli.frontier import command
from smash.experiments.studies.frontier import fewest_buffers, frontier
from smash.planners.portfolio import SmashPlanner
from smash.problem import PlanOptions, make_instance, write_instance
from smash.problem.buffers import with_buffers
from smash.problem.model import StacksGoal
from smash.problem.sets.suites import read_suite
from tests.oracle import optimal_cost


def test_every_point_is_the_optimum_of_exhaustive_search():
    instance = read_suite("multi-4")[2]
    for point in frontier(instance, SmashPlanner(), 2, 10):
        assert point.status == "optimal"
        assert point.cost == optimal_cost(with_buffers(instance, point.buffers), PlanOptions(point.topple))


def test_more_buffers_never_cost_more_and_the_fewest_are_listed():
    instance = read_suite("multi-6")[3]
    points = list(frontier(instance, SmashPlanner(), 3, 10))
    costs = [point.cost for point in points if not point.topple]
    assert costs == sorted(costs, reverse=True)
    for cost, buffers in fewest_buffers(points, False).items():
        assert costs[buffers] == cost
        assert all(other > cost for other in costs[:buffers])


def test_where_no_plan_exists_the_table_says_so(tmp_path):
    goal = StacksGoal({"s1": ("b", "a")})
    instance = make_instance(name="swap", blocks=["a", "b"], stacks=["s1", "s2"], start={"s1": ["a", "b"]}, goal=goal)
    write_instance(instance, tmp_path / "swap.json")
    result = CliRunner().invoke(command, [str(tmp_path / "swap.json"), "--most", "1"])
    assert result.exit_code == 0
    assert "no plan" in result.output


def test_points_and_pictures_are_written(tmp_path):
    result = CliRunner().invoke(command, ["multi-4", "--instances", "3", "--most", "2", "--out", str(tmp_path)])
    assert result.exit_code == 0, result.output
    with (tmp_path / "frontier.csv").open() as file:
        rows = list(csv.DictReader(file))
    assert len(rows) == 3 * 3 * 2
    assert all(float(row["cpu_seconds"]) >= 0.0 for row in rows)
    assert (tmp_path / "frontier.png").stat().st_size > 5000
    assert (tmp_path / "frontier.pdf").stat().st_size > 2000
