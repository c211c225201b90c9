"""Domains of further shapes: surfaces, sites, hands in `holding`, opposites, relations told twice, macros."""

import pytest

from smash import plan
from smash.problem.blocksworld.placing import placed
from smash.problem.blocksworld.plan_text import PlanText
from smash.problem.blocksworld.plans import exported, imported
from smash.problem.errors import Infeasible, Unsupported
from tests.pddl_replay import replay
from tests.pddl_worlds import Dress
from tests.problem.test_blocksworld_domains import TOWERS, read

FOUR = Dress("four")
GOAL = FOUR.goal(on=[("a", "c")])
GRIPPED = Dress("four", typed=True, extras=frozenset({"hand-object", "full"}))
SURFACES = """(define (domain s) (:types surface - object block tbl - surface)
 (:action take :parameters (?b - block ?s - surface) :precondition (and (on ?b ?s) (clear ?b) (empty))
  :effect (and (held ?b) (not (on ?b ?s)) (not (empty)) (not (clear ?b))
   (when (exists (?o - block) (= ?o ?s)) (clear ?s))))
 (:action put-block :parameters (?b ?u - block) :precondition (and (held ?b) (clear ?u))
  :effect (and (on ?b ?u) (empty) (clear ?b) (not (clear ?u)) (not (held ?b))))
 (:action put-table :parameters (?b - block ?t - tbl) :precondition (held ?b)
  :effect (and (on ?b ?t) (empty) (clear ?b) (not (held ?b)))))"""
ON_SURFACES = """(define (problem p) (:domain s) (:objects a b c - block t - tbl)
 (:init (on a t) (on b a) (on c t) (clear b) (clear c) (empty)) (:goal (and (on a c) (on b t))))"""
SITES = """(define (domain s)
 (:action pickup :parameters (?b ?s) :precondition (and (block ?b) (site ?s) (at ?b ?s) (clear ?b) (empty))
  :effect (and (held ?b) (not (at ?b ?s)) (not (empty)) (not (clear ?b))))
 (:action putdown :parameters (?b ?s) :precondition (and (block ?b) (site ?s) (held ?b))
  :effect (and (at ?b ?s) (empty) (clear ?b) (not (held ?b))))
 (:action unstack :parameters (?b ?c) :precondition (and (on ?b ?c) (clear ?b) (empty))
  :effect (and (held ?b) (not (on ?b ?c)) (clear ?c) (not (empty)) (not (clear ?b))))
 (:action stack :parameters (?b ?c) :precondition (and (held ?b) (clear ?c))
  :effect (and (on ?b ?c) (empty) (clear ?b) (not (clear ?c)) (not (held ?b)))))"""
AT_A_SITE = """(define (problem p) (:domain s) (:objects a b c t)
 (:init (site t) (block a) (block b) (block c) (at a t) (on b a) (at c t) (clear b) (clear c) (empty))
 (:goal (and (on a c) (at b t))))"""


def blocked():
    """`blocked` in place of `clear`."""
    domain = FOUR.domain()
    for variable in ("?x", "?y"):
        domain = domain.replace(f"(not (clear {variable}))", f"(BLOCKED {variable})")
        domain = domain.replace(f"(clear {variable})", f"(not (blocked {variable}))")
    facts = FOUR.problem(TOWERS, GOAL)
    for block in "bcd":
        facts = facts.replace(f"(clear {block})", "(blocked a)" if block == "b" else "")
    return domain.lower(), facts


def busy():
    """`busy` in place of `handempty`."""
    domain = FOUR.domain().replace("(not (handempty))", "(busy)").replace("(handempty)", "(not (busy))")
    return domain, FOUR.problem(TOWERS, GOAL).replace("(handempty)", "")


def under():
    """`under` beside `on`."""
    domain = FOUR.domain().replace("(not (on ?x ?y))", "(not (on ?x ?y)) (not (under ?y ?x))")
    domain = domain.replace("(handempty)  (on ?x ?y)))", "(handempty) (on ?x ?y) (under ?y ?x)))")
    assert "(under ?y ?x)))" in domain
    return domain, FOUR.problem(TOWERS, GOAL).replace("(on b a)", "(on b a) (under a b)")


SHAPES = {
    "surfaces": (SURFACES, ON_SURFACES),
    "a site": (SITES, AT_A_SITE),
    "the hand in holding": (GRIPPED.domain().replace("(holding ?x)", "(holding ?h ?x)"), GRIPPED.problem(TOWERS, GOAL)),
    "blocked": blocked(),
    "busy": busy(),
    "under": under(),
    "two blocks": (FOUR.domain(), FOUR.problem((("a", "b"),), "(on a b)")),
    "one block": (Dress("four", "random").domain(), Dress("four", "random").problem((("a",),), "(and)")),
}


@pytest.mark.parametrize("shape", SHAPES)
def test_the_shape_is_read_and_its_plan_is_replayed_by_its_own_domain(shape):
    domain, problem = SHAPES[shape]
    found = read(domain, problem)
    instance = placed(found).instance
    answer = plan(instance, planner="greedy", topple=False, budget=20)
    steps = exported(instance, answer.actions, found.reading, moves=False).steps
    assert replay(domain, problem, [f"({' '.join(step)})" for step in steps])
    assert len(imported(instance, PlanText(steps), found.reading).actions) == len(steps) == answer.cost


def test_an_action_that_takes_and_puts_at_once_is_two_steps_here():
    jump = """(:action jump :parameters (?x ?y) :precondition (and (clear ?x) (ontable ?x) (clear ?y) (handempty))
     :effect (and (on ?x ?y) (not (ontable ?x)) (not (clear ?y))))"""
    found = read(FOUR.domain()[:-1] + jump + ")", FOUR.problem(TOWERS, FOUR.goal(on=[("c", "d")])))
    instance = placed(found).instance
    assert len(imported(instance, PlanText((("jump", "c", "d"),)), found.reading).actions) == 2


def test_two_sites_are_no_table():
    with pytest.raises(Unsupported, match=r"\(t, u\); one is supported"):
        read(SITES, AT_A_SITE.replace("b c t)", "b c t u)").replace("(site t)", "(site t) (site u)"))


def test_objects_without_the_type_that_actions_ask_for_leave_nothing_to_do():
    with pytest.raises(Infeasible, match="none applies"):
        read(Dress("four", typed=True).domain(), FOUR.problem(TOWERS, "(and)"))


def test_a_block_from_the_table_is_moved_in_one_step():
    dress = Dress("three")
    found = read(dress.domain(), dress.problem(TOWERS, dress.goal(on=[("c", "b")])))
    instance = placed(found).instance
    answer = plan(instance, planner="greedy", topple=False, budget=20)
    assert exported(instance, answer.actions, found.reading, moves=True).steps == (("lift", "c", "b"),)
