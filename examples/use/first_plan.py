"""The first plan: make an instance, plan it, check the plan."""

import smash

instance = smash.make_instance(start={"s1": ["a", "b"], "s2": ["c"]}, goal={"s2": ["c", "a", "b"]})
plan = smash.plan(instance)
print(f"{plan.status}, {plan.cost} actions", *plan.actions, sep="\n")
print(smash.check(instance, plan))
