"""The keys of runs, letter by letter: a sweep that was begun goes on, whatever the package has become since."""

from smash.experiments.sweeps.experiment import experiment_runs, read_experiment
from smash.records.runs import instance_hash

EXPERIMENT = """
name = "pinned"
suites = ["pair"]
budgets = [2, 0.5]
variants = ["max-topple-3-no-carry", "no-topple"]
seeds = [7]
memory = 512
cutoff_sample = 1
[[planners]]
name = "smash-layered"
label = "warm"
warm_start = "greedy"
horizon = 4
threads = 2
[[planners]]
name = "greedy"
cutoff_sample = 0
"""

PAIR = """
{
 "format": "smash-instance/2",
 "name": "pair",
 "blocks": ["a", "b"],
 "stacks": ["s", "t"],
 "buffers": ["u1"],
 "start": {"s": ["a", "b"]},
 "goal": {"kind": "positions", "positions": {"a": ["t", 1]}},
 "carriers": [{"name": "tray", "stations": ["near", "far"], "at": "near", "capacity": 2}],
 "capacities": {"lift": 2},
 "costs": {"actions": {"pick": 3, "topple": 2}}
}
"""

KEYS = {
    ("warm", "max-topple-3-no-carry", "anytime"): "19b122e2f094e01997fa",
    ("warm", "max-topple-3-no-carry", "cutoff"): "cb52356e4631e39e9721",
    ("warm", "no-topple", "anytime"): "3a0b0aa3d35caae29fbb",
    ("greedy", "max-topple-3-no-carry", "anytime"): "1abcab8b278502b49f36",
    ("greedy", "no-topple", "anytime"): "256f011d364ab23afcd5",
}
"""As version 0.1.0 named these runs in its records."""


def test_the_keys_of_runs_are_those_of_the_first_version(tmp_path):
    (tmp_path / "pair").mkdir()
    (tmp_path / "pair" / "pair.json").write_text(PAIR)
    (tmp_path / "experiment.toml").write_text(EXPERIMENT)
    runs = experiment_runs(read_experiment(tmp_path / "experiment.toml"), tmp_path)
    assert {(run.label, run.variant, run.kind): run.key for run in runs} == KEYS
    assert {instance_hash(run.job.instance) for run in runs} == {"cd976e920644ed0c"}
