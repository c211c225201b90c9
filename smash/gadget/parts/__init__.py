"""The aggregating actions as parts of a gadget, and those that others add."""
