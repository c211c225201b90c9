"""Made-up records with known figures, to test what analysis computes from them."""

import json


def record(number=0, trace=(), *, budget=30.0, kind="anytime", variant="topple", buffers=0, label="p", **more):
    budgets = more.pop("budgets", [0.1, 1.0, 30.0] if kind == "anytime" else [budget])
    costs = [cost for _, cost in trace]
    return {
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
        "blocks": 9,
        "seed": 0,
        "outcome": "feasible" if trace else "budget-spent",
        "reason": "",
        "status": "feasible" if trace else "unknown",
        "cost": min(costs, default=None),
        "lower_bound": None,
        "incumbents": [[seconds, cost, "milp"] for seconds, cost in trace],
        "actions": None,
        "wall_seconds": budget,
        "memory_mib": 50.0,
        "commit": {"hash": "c", "dirty": False},
        **more,
    }


def write(directory, records):
    directory.mkdir(parents=True, exist_ok=True)
    (directory / "runs.jsonl").write_text("".join(json.dumps(entry) + "\n" for entry in records))
    return directory
