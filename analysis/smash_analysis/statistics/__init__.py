"""Statistics that are fair to subsets, effects, findings in words."""
