"""Recordings and episodes made by hand: nothing is simulated."""

import numpy as np

from smash.execution.viewing.recording import Recording
from smash.records.episodes import Arrangement, Episode, Performed, Times, Totals


def recording_of(blocks, seconds=1.0, interval=0.08):
    """The arm at rest, the blocks in a row that slides."""
    taken = Recording(names=[f"b{n}" for n in range(blocks)])
    for moment in np.arange(0.0, seconds + interval / 2, interval):
        row = [[0.3 + 0.02 * moment, 0.06 * n, 0.0225, 0, 0, 0, 1] for n in range(blocks)]
        taken.times.append(float(moment))
        taken.joints.append(np.array([0, -0.4, 0, -2.2, 0, 1.8, 0.8, 0.04, 0.04]))
        taken.links.append(np.tile([0, 0, 0.3, 0, 0, 0, 1.0], (10, 1)))
        taken.blocks.append(np.array(row))
        taken.trays.append(np.zeros((0, 7)))
        taken.touched.append([0] if moment < 0.5 else [])
    return taken


def episode_of(name, *actions):
    return Episode(
        instance=name,
        planner="by hand",
        topple=True,
        max_topple=None,
        scene="default",
        seed=0,
        replanning=False,
        success=True,
        failure=None,
        plan_cost=len(actions),
        actions_executed=len(actions),
        replans=0,
        retries=0,
        times=Totals(offline=0, offline_cpu=0, online=0, online_cpu=0, execution=1, task=0),
        final=Arrangement(piles={}, table=[]),
        actions=[
            Performed(step=n + 1, action=list(action), origin="plan", begun=0.5 * n, times=Times(execution=0.5))
            for n, action in enumerate(actions)
        ],
    )
