"""Made-up records with known figures, to test what analysis computes from them."""

import json

import msgspec

from smash.records.runs import RunRecord

DOCUMENT = {
    "blocks": ["a", "<b>", "c"],
    "stacks": ["s1", "s2"],
    "buffers": ["u1"],
    "start": {"s1": ["a", "<b>"], "s2": ["c"]},
    "goal": {"kind": "stacks", "stacks": {"s1": ["c", "a", "<b>"]}},
}


def record(number=0, trace=(), *, budget=30.0, kind="anytime", variant="topple", buffers=0, label="p", **more):
    budgets = more.pop("budgets", [0.1, 1.0, 30.0] if kind == "anytime" else [budget])
    costs = [cost for _, cost in trace]
    fields = {
        "format": "smash-run/1",
        "key": f"{label}-{number}-{variant}-{buffers}-{kind}-{budget}",
        "experiment": "made-up",
        "label": label,
        "planner": label,
        "suite": "multi-9",
        "instance": f"i{number}",
        "instance_hash": f"h{number}",
        "variant": variant,
        "topple": variant != "no-topple",
        "max_topple": None,
        "kind": kind,
        "budget": budget,
        "budgets": budgets,
        "buffers": buffers,
        "stacks": 3,
        "blocks": 9,
        "instance_document": {**DOCUMENT, "name": f"i{number}"},
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
        "actions": None,
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
                better, cost = number + buffers, 10 if variant == "topple" else 15
                setting = {"variant": variant, "buffers": buffers, "instance_document": DOCUMENT}
                setting |= {"instance_hash": f"h{number}-{buffers}", "load_average": [0.1, 0.1]}
                solved = [(0.05, cost + better + 2), (0.5, cost + better)]
                runs.append(record(number, solved, label="p & q", status="optimal", **setting))
                lost = buffers == 0 and variant == "no-topple"
                runs.append(record(number, [] if lost else [(0.5, cost + better + 1)], label="weak", **setting))
    return runs
