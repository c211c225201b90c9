"""The table of the scoop: plans and episodes of the same variant meet in one row, savings are paired by seed."""

import pandas as pd
from smash_analysis.scoop import BASELINE, scoop_table
from smash_analysis.tables.scenes import by_scene

from tests.analysis.made_up import record


def run(variant, actions, cost, label="smash"):
    more = {"actions": actions, "cost": cost, "status": "optimal", "wall_seconds": 0.5}
    return record(label=label, variant=variant, instance="scoop", instance_document={"costs": {"unit": "ms"}}, **more)


def episode(variant, seed, execution, success=True, policy="replan"):
    return {
        "policy": policy,
        "label": "smash",
        "variant": variant,
        "instance": "scoop",
        "seed": seed,
        "execution_seconds": execution,
        "success": success,
        "replans": 0,
    }


def test_savings_are_over_the_seeds_on_which_both_succeeded():
    scooped = [["pick", "a", "s"], ["place", "a", "tray"], ["carry", "tray", "right"]]
    runs = [
        run("topple-no-lift", scooped, 8000),
        run(BASELINE, [["pick", "a", "s"]] * 4, 10000),
        run("topple-no-lift", None, 8000, "fd-opt"),
    ]
    episodes = pd.DataFrame(
        [
            episode(BASELINE, 0, 10.0),
            episode(BASELINE, 1, 99.0),
            episode("topple-no-lift", 0, 8.0),
            episode("topple-no-lift", 1, None, success=False),
        ]
    )
    table = scoop_table(runs, episodes)
    assert list(table["plan"]) == ["pick and place only", "+ topple, scoop"]
    row = table.iloc[1]
    assert row["saved [%]"].startswith("20 ")
    assert row["saved [%]"].endswith("on 1")
    assert (row["kinds"], row["success"], row["predicted [s]"]) == ("1 carry", "1/2", "8.0")
    assert row["others"] == "fd-opt: 8000 optimal"


def test_each_policy_has_its_row_and_few_seeds_a_range():
    episodes = pd.DataFrame(
        [
            episode(variant, seed, seconds + seed, policy=policy)
            for variant, seconds in ((BASELINE, 20.0), ("topple", 10.0))
            for policy in ("open", "replan")
            for seed in range(3)
        ]
    )
    runs = [run(BASELINE, [["pick", "a", "s"]] * 4, 10000), run("topple", [["topple", "s", 1]], 5000)]
    table = scoop_table(runs, episodes)
    assert table["policy"].tolist() == ["open", "replan"] * 2
    assert table.iloc[2]["execution [s]"] == "11.0 (10.0 to 12.0)"
    assert table.iloc[2]["saved [%]"] == "48 (45 to 50) on 3"


def test_a_plan_that_was_not_carried_out_has_a_row():
    runs = [run(BASELINE, [["pick", "a", "s"]], 10000)]
    (row,) = scoop_table(runs, pd.DataFrame([episode("topple", 0, 1.0)])).to_dict("records")
    assert (row["policy"], row["execution [s]"], row["success"]) == ("–", "–", "0/0")


def test_scenes_have_rows_of_their_own_and_an_instance_may_be_without_costs():
    scenes = ((None, 1.0), ("default pace=0.1", 3.0))
    episodes = pd.DataFrame(
        [
            episode(variant, 0, seconds * slower) | {"scene": scene}
            for variant, seconds in ((BASELINE, 20.0), ("topple", 10.0))
            for scene, slower in scenes
        ]
    )
    runs = [run(BASELINE, [["pick", "a", "s"]] * 4, 4), run("topple", [["topple", "s", 1]], 1)]
    bare = record(label="smash", variant="topple", instance="bare", actions=[["pick", "a", "s"]], cost=1)
    table = scoop_table([*runs, bare], by_scene(episodes))
    rows = table[table["plan"] == "+ topple, scoop, lift"].set_index("policy")["execution [s]"]
    assert rows[["replan, default", "replan, default pace=0.1"]].str[:4].tolist() == ["10.0", "30.0"]
    assert table.loc[table["instance"] == "bare", "cost"].item().startswith("1 actions")
    assert scoop_table([], episodes).empty
