"""The family of aggregating actions in PDDL: one part an action, put together into the domain of an instance."""
