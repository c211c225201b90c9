"""Nested parentheses: read in any case, without comments; a fault is one line that says where."""

import pytest

from smash.problem import MalformedFile
from smash.problem.blocksworld.sexpr import MOST_NESTED, parse_expression


def parse(text):
    return parse_expression(text, "p.pddl")


def test_lists_are_nested_as_the_parentheses_are():
    assert parse("(a (b c) () d)") == ["a", ["b", "c"], [], "d"]


def test_names_are_in_lower_case_and_comments_dropped():
    assert parse("; a ( comment\n(Define (PROBLEM P)) ; (more)") == ["define", ["problem", "p"]]


def test_spaces_and_lines_make_no_difference():
    assert parse("(a(b)c)") == parse("(\n a\t( b ) c\r\n)")


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("(a\n(b", "the `(` of line 2 is never closed"),
        ("(a)\n)", "line 2: a `)` without its `(`"),
        ("(a) b", "line 1: 'b' stands outside of parentheses"),
        ("", "0 expressions"),
        ("(a) (b)", "2 expressions"),
        ("(" * (MOST_NESTED + 1), f"nested deeper than {MOST_NESTED}"),
    ],
)
def test_a_fault_is_one_line_with_its_place(text, words):
    with pytest.raises(MalformedFile) as caught:
        parse(text)
    assert words in str(caught.value)
    assert str(caught.value).startswith("p.pddl")
    assert "\n" not in str(caught.value)


def test_the_deepest_nesting_allowed_is_read():
    expression = parse("(" * MOST_NESTED + ")" * MOST_NESTED)
    for _ in range(MOST_NESTED - 1):
        (expression,) = expression
    assert expression == []
