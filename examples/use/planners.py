"""A loop over planners: the same problem for each, what it costs, what is proven, and why one does not take it."""

import smash

instance = smash.generate("multi", 6, buffers=2, seed=4)[0]
print(instance)
for name in smash.planner_names():
    try:
        plan = smash.plan(instance, name, budget=1, isolated=True)
    except smash.SmashError as error:
        print(f"{name:20} {error}")
        continue
    found = f"{plan.cost} actions after {plan.incumbents[-1].seconds:.3f} s" if plan.incumbents else "no plan in time"
    proven = "" if plan.lower_bound is None else f", none has fewer than {plan.lower_bound}"
    print(f"{name:20} {plan.status:10} {found}{proven}")
