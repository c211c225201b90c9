"""`smash.problem.sexpr` of 0.1: `smash.problem.blocksworld.sexpr`."""

from smash.problem.blocksworld.sexpr import MOST_NESTED, Expression, parse_expression

__all__ = ["MOST_NESTED", "Expression", "parse_expression"]
