"""Carry a plan out in simulation (the extra `execution`) and say what each action took."""

import smash

instance = smash.make_instance({"s1": ["a", "b"]}, {"s2": ["a", "b"]}, name="move", stacks=1)
plan = smash.plan(instance)
episode = smash.execute(instance, plan, seed=1)
for done in episode.actions:
    print(f"{' '.join(map(str, done.action)):16} {done.outcome:8} {done.times.execution:5.1f} s")
print("success" if episode.success else f"failed: {episode.failure.reason}")
