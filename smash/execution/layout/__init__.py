"""Layouts judged and drawn: the paper's two conditions, ways around the arm, the table from above."""
