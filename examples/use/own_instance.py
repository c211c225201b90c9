"""Instances of one's own: buffers, goals of three kinds, a fallen block, an error; written to a file and read back."""

import smash
from smash.problem import OnGoal, PositionsGoal

# The whole arrangement: blocks and locations follow from start and goal; two buffers beside.
swap = smash.make_instance({"left": ["a", "b"], "right": ["c"]}, {"left": ["c"], "right": ["b", "a"]}, buffers=2)

# One block at the bottom of a further stack, all others anywhere.
dig = smash.make_instance({"s1": ["a", "b", "c", "d"]}, PositionsGoal({"a": ("s2", 1)}), name="dig", stacks=1)

# Relations only, and a block that has fallen already.
tower = smash.make_instance(
    {"s1": ["a", "b"]}, OnGoal({"a": "b", "b": "c"}, bottom=("c",)), name="tower", stacks=2, table=["c"]
)

for instance in (swap, dig, tower):
    print(instance)
    print(smash.State.start_of(instance))
    with_topple, without = smash.plan(instance), smash.plan(instance, topple=False)
    print(f"{with_topple.cost} actions with topple, {without.cost} without\n")

smash.write_instance(dig, "mine.json")
assert smash.read_instance("mine.json") == dig

try:
    smash.make_instance({"s1": ["a", "b"]}, {"s2": ["a"]})
except smash.SmashError as error:
    print(error)
