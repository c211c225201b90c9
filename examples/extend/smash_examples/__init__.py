"""Additions to the testbed from outside, each in one short file."""
