"""Made-up records with known figures, to test what analysis computes from them."""

import json

import msgspec

from smash.problem.files.instances import instance_from_document
from smash.records.runs import RunRecord, instance_hash

DOCUMENT = {
    "blocks": ["a", "<b>", "c"],
    "stacks": ["s1", "s2"],
    "buffers": ["u1"],
    "start": {"s1": ["a", "<b>"], "s2": ["c"]},
    "goal": {"kind": "stacks", "stacks": {"s1": ["c", "a", "<b>"]}},
}


def document(number, name, buffers):
    """An instance with plans of every cost from 3 on: the way from s1 to s2 costs 1, by s3 nothing."""
    spare = [f"u{count}" for count in range(1, buffers + 1)]
    blocks = [f"{name}{number}" for name in ("a", "<b>", "c", "d", "e", "f", "g", "h", "i")]
    places = {"s1": [0.0, 0.0], "s2": [1.0, 0.0], "s3": [0.5, 0.0], "table": [0.0, 0.0]}
    return {
        "format": "smash-instance/2",
        "name": name,
        "blocks": blocks,
        "stacks": ["s1", "s2", "s3"],
        "buffers": spare,
        "start": {"s1": blocks[::-1]},
        "goal": {"kind": "positions", "positions": {f"a{number}": ["s2", 1]}},
        "costs": {"travel": 1.0, "positions": places | {buffer: [0.0, 0.0] for buffer in spare}},
    }


def plan_of(number, cost):
    """The actions of a plan of this cost for `document(number)`; none for a cost that none has."""
    if cost is None or cost < 3:
        return None
    block = f"a{number}"
    wasted = [["pick", block, "s1"], ["place", block, "s1"]] * ((cost - 3) // 2 if cost % 2 else (cost - 4) // 2)
    if cost % 2:
        return [*wasted, ["pick", block, "s1"], ["place", block, "s2"]]
    return [*wasted, ["pick", block, "s1"], ["place", block, "s3"], ["pick", block, "s3"], ["place", block, "s2"]]


def record(number=0, trace=(), *, budget=30.0, kind="anytime", variant="topple", buffers=0, label="p", **more):
    budgets = more.pop("budgets", [0.1, 1.0, 30.0] if kind == "anytime" else [budget])
    costs = [cost for _, cost in trace]
    made = document(number, more.get("instance", f"i{number}"), buffers)
    fields = {
        "format": "smash-run/1",
        "key": f"{label}-{number}-{variant}-{buffers}-{kind}-{budget}",
        "experiment": "made-up",
        "label": label,
        "planner": label,
        "suite": "multi-9",
        "instance": f"i{number}",
        "instance_hash": instance_hash(instance_from_document(made)),
        "variant": variant,
        "topple": variant != "no-topple",
        "max_topple": None,
        "kind": kind,
        "budget": budget,
        "budgets": budgets,
        "buffers": buffers,
        "stacks": 3,
        "blocks": 9,
        "instance_document": made,
        "memory_limit_mib": 4096,
        "warm_start": None,
        "horizon": None,
        "threads": 1,
        "seed": 0,
        "outcome": "feasible" if trace else "budget-spent",
        "reason": "",
        "status": "feasible" if trace else "unknown",
        "cost": min(costs, default=None),
        "lower_bound": None,
        "bound_origin": None,
        "verdict": None,
        "details": {},
        "log": "",
        "incumbents": [[seconds, cost, "milp"] for seconds, cost in trace],
        "actions": plan_of(number, min(costs, default=None)),
        "wall_seconds": budget,
        "cpu_seconds": None,
        "started": "2026-01-01T00:00:00.000+00:00",
        "load_average": [0.1, 0.2],
        "versions": {"python": "3.11.7"},
        "machine": {"processor": "p", "cores": 2, "usable_cores": 2, "memory_mib": 1000, "system": "Linux"},
        "memory_mib": 50.0,
        "commit": {"hash": "c", "dirty": False},
        **more,
    }
    return msgspec.convert(fields, RunRecord)


def write(directory, records):
    directory.mkdir(parents=True, exist_ok=True)
    (directory / "runs.jsonl").write_text("".join(json.dumps(entry.document) + "\n" for entry in records))
    return directory


def small_sweep():
    """Two planners, two instances, with and without topple, two buffer counts: all is solved but one setting."""
    runs = []
    for number in range(2):
        for buffers in (0, 4):
            for variant in ("topple", "no-topple"):
                better, cost = number, 10 if variant == "topple" else 15
                setting = {"variant": variant, "buffers": buffers, "load_average": [0.1, 0.1]}
                solved = [(0.05, cost + better + 2), (0.5, cost + better)]
                proven = {"status": "optimal", "outcome": "optimal"}
                runs.append(record(number, solved, label="p & q", **proven, **setting))
                lost = buffers == 0 and variant == "no-topple"
                runs.append(record(number, [] if lost else [(0.5, cost + better + 1)], label="weak", **setting))
    return runs
