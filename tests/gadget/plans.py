"""Random legal plans: walks under the law that end with the hand empty."""

from hypothesis import strategies as st

from smash.problem import Law, PlanOptions, State
from tests.strategies import instances


@st.composite
def walks(draw, most_actions=14, options=None, drawn=instances, **shape):
    """Draw an instance and a legal plan for it (its goal is left aside)."""
    instance = draw(drawn(**shape))
    law, state, actions = Law(instance, options or PlanOptions()), State.start_of(instance), []
    for _ in range(draw(st.integers(0, most_actions))):
        legal = list(law.legal_actions(state))
        if not legal:
            break
        actions.append(draw(st.sampled_from(legal)))
        law.apply(state, actions[-1])
    if state.hand is not None:
        actions.append(draw(st.sampled_from(list(law.legal_actions(state)))))
        law.apply(state, actions[-1])
    return instance, actions, state
