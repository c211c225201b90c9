"""The aggregating actions: topple, carry, lift, and those that others add."""
