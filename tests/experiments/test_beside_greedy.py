"""The study of `smash` beside `greedy`: sixty problems, a row each, and what is worse."""

from smash.experiments.studies.beside_greedy import Stated, rows, stated


def test_sixty_problems_are_stated_each_once():
    names = [problem.name for problem in stated()]
    assert len(names) == len(set(names)) == 60


def test_a_problem_is_the_same_each_time():
    problem = stated()[0]
    assert problem.problem().instance == problem.problem().instance


def test_each_problem_is_a_row_and_no_plan_is_worse():
    table = list(rows([Stated(12, 4, 2, False, 0), Stated(12, 4, 2, True, 0)], (5.0,)))
    assert [line.split(" | ")[0] for line in table[1:3]] == ["| beside-12-4-2-plain-0", "| beside-12-4-2-topple-0"]
    assert table[-1] == "\n0 of 2 worse than greedy alone"
