"""The paper's claim: a legal plan is a pebble motion on the gadget, and the motion gives a plan back."""

import itertools
from random import Random

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from smash.gadget import gadget_of
from smash.gadget.decode import decode
from smash.gadget.encode import encode
from smash.gadget.motion import PebbleMotion, motion_fault, settled
from smash.problem import IllegalAction, Law, Pick, Place, PlanOptions, StacksGoal, State, Topple, make_instance
from tests.gadget.plans import walks
from tests.strategies import family_instances, family_options


def put_backs(actions):
    """Count blocks that are put back where they were just taken from: no motion of a pebble."""
    return sum(
        isinstance(first, Pick) and isinstance(then, Place) and first.source == then.target
        for first, then in itertools.pairwise(actions)
    )


def final_state(instance, actions):
    law, state = Law(instance), State.start_of(instance)
    for action in actions:
        law.apply(state, action)
    return state


@settings(max_examples=150, deadline=None)
@given(walks(max_blocks=6, max_stacks=4, odd_names=True))
def test_every_legal_plan_is_a_motion_of_the_same_cost_that_decodes_to_the_same_state(walk):
    instance, actions, state = walk
    motion = encode(instance, actions)
    assert motion_fault(motion) is None
    assert motion.cost == len(actions) - 2 * put_backs(actions)
    assert motion.layers[0] == settled(motion.gadget, instance.blocks, State.start_of(instance))
    assert motion.layers[-1] == settled(motion.gadget, instance.blocks, state)
    decoded = decode(motion, Law(instance))
    assert len(decoded) == motion.cost
    assert final_state(instance, decoded).key() == state.key()


def price_of_put_backs(instance, actions):
    """Return what the pairs cost that `put_backs` counts."""
    return put_backs(actions) * (instance.costs.of("pick") + instance.costs.of("place"))


@settings(max_examples=100, deadline=None)
@given(walks(most_actions=18, drawn=family_instances, max_blocks=5, max_buffers=2))
def test_plans_of_the_whole_family_are_motions_of_the_same_cost(walk):
    instance, actions, state = walk
    motion = encode(instance, actions)
    assert motion_fault(motion) is None
    assert motion.cost == Law(instance).price(actions) - price_of_put_backs(instance, actions)
    assert motion.layers[-1] == settled(motion.gadget, instance.blocks, state)
    decoded = decode(motion, Law(instance))
    assert Law(instance).price(decoded) == motion.cost
    after = final_state(instance, decoded)
    assert after.key() == state.key()


@settings(max_examples=60, deadline=None)
@given(family_instances(max_stacks=2), family_options(), st.integers(0, 10**6))
def test_every_motion_that_obeys_the_rules_is_a_legal_plan_of_its_cost(instance, options, seed):
    """Random walks of the pebbles, step by step: those that break no rule decode to a plan of the motion's cost."""
    motion = random_motion(Random(seed), instance, gadget_of(instance, options))
    decoded = decode(motion, Law(instance, options))
    assert Law(instance, options).price(decoded) == motion.cost


def random_motion(random, instance, gadget, steps=14):
    """Draw a motion that breaks no rule (where it ends apart), by trying random moves of some pebbles a step."""
    layers, active = [settled(gadget, instance.blocks, State.start_of(instance))], []
    for _ in range(steps):
        for _ in range(8):
            there, activated = one_more_layer(gadget, layers[-1], random)
            fault = motion_fault(PebbleMotion(gadget, instance.blocks, (layers[-1], there), (activated,)))
            if fault is None or "ends in" in fault:
                layers.append(there)
                active.append(activated)
                break
    return PebbleMotion(gadget, instance.blocks, tuple(layers), tuple(active))


def one_more_layer(gadget, here, random):
    """Move some pebbles at random; those that an activation can move mostly together."""
    active = random.randrange(len(gadget.aggregates)) if gadget.aggregates and random.random() < 0.4 else None
    edges = () if active is None else [gadget.edges[number] for number in gadget.aggregates[active].edges]
    together = {edge.tail: edge.head for edge in edges}
    there = []
    for node in here:
        ways = [gadget.edges[e].head for e in gadget.outgoing[node] if e not in gadget.activations]
        if node in together and random.random() < 0.9:
            there.append(together[node])
        else:
            there.append(random.choice(ways) if ways and random.random() < 0.4 else node)
    return tuple(there), active


@settings(max_examples=50, deadline=None)
@given(walks(max_blocks=5, options=PlanOptions(True, 2)))
def test_a_capped_plan_fits_the_capped_gadget(walk):
    instance, actions, _ = walk
    options = PlanOptions(True, 2)
    motion = encode(instance, actions, gadget_of(instance, options))
    assert motion_fault(motion) is None
    assert len(decode(motion, Law(instance, options))) == motion.cost


@pytest.fixture
def tower():
    """Return three blocks on s1, and s2 and s3 empty."""
    blocks = ["a", "b", "c"]
    return make_instance(
        name="tower", blocks=blocks, stacks=["s1", "s2", "s3"], start={"s1": blocks}, goal=StacksGoal({"s1": blocks})
    )


def test_a_topple_is_one_activation_for_all_its_blocks(tower):
    motion = encode(tower, [Topple("s1", 2)])
    assert motion.cost == 1
    assert decode(motion, Law(tower)) == (Topple("s1", 2),)


def test_moves_of_different_locations_share_a_step():
    instance = make_instance(
        name="x",
        blocks=["a", "b"],
        stacks=["s1", "s2", "s3", "s4"],
        start={"s1": ["a"], "s2": ["b"]},
        goal=StacksGoal({"s1": ["a"], "s2": ["b"]}),
    )
    alone = encode(instance, [Pick("a", "s1"), Place("a", "s3")])
    both = encode(instance, [Pick("a", "s1"), Place("a", "s3"), Pick("b", "s2"), Place("b", "s4")])
    assert (alone.steps, both.steps) == (3, 3)
    assert (alone.cost, both.cost) == (2, 4)


def test_a_plan_that_ends_with_a_held_block_is_no_motion(tower):
    with pytest.raises(IllegalAction, match="in the hand"):
        encode(tower, [Pick("c", "s1")])


def test_an_illegal_plan_is_no_motion(tower):
    with pytest.raises(IllegalAction):
        encode(tower, [Pick("a", "s1")])


def test_a_topple_needs_a_gadget_that_has_it(tower):
    with pytest.raises(IllegalAction, match="no part"):
        encode(tower, [Topple("s1", 1)], gadget_of(tower, PlanOptions(topple=False)))


def motion_of(instance, *layers):
    gadget = gadget_of(instance)
    nodes = {str(node.key.location) + str(node.key.index): number for number, node in enumerate(gadget.nodes)}
    return PebbleMotion(gadget, instance.blocks, tuple(tuple(nodes[name] for name in layer) for layer in layers))


def test_three_tops_cannot_rotate_in_one_step():
    start = {"s1": ["a"], "s2": ["b"], "s3": ["c"]}
    instance = make_instance(name="x", blocks="abc", stacks=list(start), start=start, goal=StacksGoal(start))
    motion = motion_of(instance, ("s13", "s23", "s33"), ("s23", "s33", "s13"))
    assert "2 times" in motion_fault(motion)


def test_two_pebbles_do_not_swap_along_a_chain(tower):
    motion = motion_of(tower, ("s11", "s12", "s13"), ("s12", "s11", "s13"))
    assert "swap" in motion_fault(motion)


def test_a_stack_is_left_alone_while_blocks_of_it_are_staged(tower):
    gadget = gadget_of(tower)
    motion = encode(tower, [Topple("s1", 3), Pick("b", "s1"), Place("b", "s2")], gadget)
    staged = gadget.aggregates[0].gather
    late = list(motion.layers)
    assert late[1][2] == staged
    late[2] = (late[2][0], late[2][1], staged)
    fault = motion_fault(PebbleMotion(gadget, motion.blocks, tuple(late)))
    assert fault is not None
