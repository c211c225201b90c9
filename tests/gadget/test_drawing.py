"""Every gadget, instance and motion can be drawn; files are what their suffix says."""

import json
import subprocess
import sys
from pathlib import Path

import pytest

from smash.gadget import gadget_of, smash_gadget
from smash.gadget.drawing.draw import draw, write_motion
from smash.gadget.drawing.figure import gadget_figure
from smash.gadget.drawing.layout import lay_out
from smash.gadget.drawing.pebbles import step_captions, strip_layers
from smash.gadget.drawing.piles import instance_figure
from smash.gadget.drawing.style import RADIUS, save
from smash.gadget.encode import encode
from smash.problem import (
    Carrier,
    Carry,
    Lift,
    OnGoal,
    Pick,
    Place,
    PositionsGoal,
    SmashError,
    Topple,
    Unsupported,
    make_instance,
)

EXAMPLES = Path(__file__).parents[2] / "examples"
MAGIC = {".png": b"\x89PNG", ".pdf": b"%PDF", ".svg": b"<?xml", ".gif": b"GIF8"}


@pytest.fixture
def odd():
    """Return an instance with names that a drawing could trip over, blocks on the table and on a buffer."""
    return make_instance(
        name="odd",
        blocks=["$x_2$", "", "a\nb", "größe & <b>"],
        stacks=["s 1", "$s$", "a long name of a location"],
        buffers=["u", "v"],
        start={"s 1": ["$x_2$", "a\nb"], "u": [""]},
        table=["größe & <b>"],
        goal=OnGoal({"$x_2$": "größe & <b>"}, ("",)),
    )


@pytest.mark.parametrize(("stacks", "blocks"), [(1, 0), (1, 1), (3, 4), (8, 3)])
def test_no_two_nodes_of_a_gadget_are_drawn_over_each_other(stacks, blocks):
    gadget = smash_gadget([f"s{number}" for number in range(stacks)], blocks)
    places = lay_out(gadget).nodes
    for index, (x, y) in enumerate(places):
        assert all(abs(x - u) + abs(y - v) > 2 * RADIUS for u, v in places[:index])


@pytest.mark.parametrize("suffix", [".png", ".pdf", ".svg"])
def test_a_gadget_is_drawn_to_every_still_format(tmp_path, suffix):
    path = tmp_path / f"gadget{suffix}"
    save(gadget_figure(smash_gadget(["s1", "s2"], 2)), path)
    assert path.read_bytes().startswith(MAGIC[suffix])


def test_odd_names_are_drawn(tmp_path, odd):
    save(instance_figure(odd), tmp_path / "instance.svg")
    save(gadget_figure(gadget_of(odd)), tmp_path / "gadget.svg")
    plan = [Topple("s 1", 2), Pick("a\nb", "table"), Place("a\nb", "$s$")]
    write_motion(encode(odd, plan), odd, tmp_path / "plan.svg")
    assert "$x_2$"[:3] in (tmp_path / "instance.svg").read_text(encoding="utf-8")


def test_carriers_and_lifts_are_drawn(tmp_path):
    instance = make_instance(
        name="small",
        blocks=["a", "b", "c"],
        stacks=["s1", "s2"],
        start={"s1": ["a", "b", "c"]},
        goal=OnGoal({}),
        carriers=[Carrier("tray", ("left", "right"), "left", 2)],
        capacities={"lift": 2},
    )
    plan = [Pick("c", "s1"), Place("c", "tray"), Carry("tray", "right"), Lift("s1", 1, "s2")]
    save(gadget_figure(gadget_of(instance)), tmp_path / "gadget.png")
    motion = encode(instance, plan)
    write_motion(motion, instance, tmp_path / "plan.svg")
    places = lay_out(motion.gadget).nodes
    assert len(set(places)) == len(places)
    assert [caption for caption in step_captions(motion, instance) if caption] == [
        "c: s1 → tray",
        "carry tray to right",
        "lift s1 from height 1 to s2",
    ]


def test_an_instance_without_blocks_is_drawn(tmp_path):
    empty = make_instance(name="empty", blocks=[], stacks=["s"], start={}, goal=PositionsGoal({}))
    save(instance_figure(empty), tmp_path / "instance.png")
    write_motion(encode(empty, []), empty, tmp_path / "motion.png")
    write_motion(encode(empty, []), empty, tmp_path / "motion.gif")


def test_captions_say_the_actions_of_each_step(odd):
    plan = [Topple("s 1", 2), Pick("a\nb", "table"), Place("a\nb", "$s$")]
    captions = step_captions(encode(odd, plan), odd)
    assert [caption for caption in captions if caption] == ["topple s 1 from height 2", "a\\nb: table → $s$"]


def test_a_strip_has_the_start_the_staged_blocks_what_follows_and_the_end():
    assert strip_layers(["", "topple s1 from height 2", "", ""], [1]) == [0, 1, 2, 4]
    assert len(strip_layers(["x"] * 100)) == 12


def test_a_plan_that_begins_with_a_full_hand_is_not_drawn_on_the_gadget():
    held = make_instance({"s1": ["a"]}, OnGoal({"b": "a"}), hand="b")
    with pytest.raises(Unsupported, match="no node for 'b', which is in the hand"):
        draw(held, [Place("b", "s1")])


@pytest.mark.parametrize("name", ["picture.txt", "picture"])
def test_other_suffixes_are_refused(tmp_path, name):
    with pytest.raises(SmashError, match="allowed"):
        save(gadget_figure(smash_gadget(["s1"], 1)), tmp_path / name)


def test_a_directory_that_is_not_there_is_one_line(tmp_path):
    with pytest.raises(SmashError, match="cannot be written"):
        save(gadget_figure(smash_gadget(["s1"], 1)), tmp_path / "no" / "x.png")


def test_the_command_animates_a_plan(tmp_path):
    actions = [["topple", "s1", 2], ["pick", "b1", "s1"], ["place", "b1", "s3"]]
    plan = tmp_path / "plan.json"
    plan.write_text(
        json.dumps({"format": "smash-plan/1", "instance": "figure1", "planner": "hand", "cost": 3, "actions": actions})
    )
    out = tmp_path / "plan.gif"
    command = [sys.executable, "-m", "smash", "draw", "plan", str(EXAMPLES / "figure1.json"), str(plan)]
    done = subprocess.run([*command, "--out", str(out)], capture_output=True, text=True, check=False)
    assert (done.returncode, done.stderr) == (0, "")
    assert out.read_bytes().startswith(MAGIC[".gif"])
