"""`smash.planners.family` of 0.1."""
