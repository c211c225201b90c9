"""A reproduction: each stage once, continued after a kill, made anew where its inputs have changed, with a manifest."""

import json
import re
import signal
import subprocess
import sys
import time
from pathlib import Path
from typing import NamedTuple

import psutil
import pytest
from click.testing import CliRunner

from smash.cli import smash
from smash.experiments.reproduction.code import ANALYSIS, EVERYTHING, PLANNING, ROOMS, _files, _said, rooms_of
from smash.experiments.reproduction.reproduce import STALE
from smash.experiments.reproduction.stages import file_hash, read_stages
from smash.problem import MalformedFile

ROOT = Path(__file__).parents[2]
NOTE = """
import pathlib, sys, time
folder, words = pathlib.Path(sys.argv[1]), sys.argv[2:]
for word in words:
    if not (folder / word).exists():
        time.sleep(0.5 if word == "slow" else 0)
        (folder / word).write_text(word)
    with open(folder / "starts", "a") as starts:
        starts.write(word + " ")
"""
"""A command that makes each file that is not there yet, and notes what it was asked for."""


def stage(name, words, more=""):
    command = f"python {{here}}/note.py {{out}}/{name} {words}"
    return f"""[[steps]]
name = "{name}"
about = "makes {words}"
minutes = 0.1
commands = ['{command}']
products = ["{name}/*"]
{more}
"""


@pytest.fixture
def stages(tmp_path):
    """Write a list of stages; return its file."""

    def write(*parts):
        (tmp_path / "note.py").write_text(NOTE)
        file = tmp_path / "tiny.toml"
        file.write_text('name = "tiny"\nabout = "A tiny one."\n' + "".join(parts))
        return file

    return write


def command(file, out, *more):
    return [sys.executable, "-m", "smash", "reproduce", "--steps", str(file), "--out", str(out), *map(str, more)]


class Ended(NamedTuple):
    returncode: int
    stdout: str
    error: str


def reproduce(file, out, *more):
    """Run the command in this process (its stages have processes of their own)."""
    ended = CliRunner().invoke(smash, [*command(file, out, *more)[3:]])
    code = getattr(ended.exception, "exit_code", ended.exit_code)
    return Ended(code, ended.stdout, str(ended.exception or ""))


def test_a_second_run_does_nothing_and_says_so(stages, tmp_path):
    file, out = (
        stages(stage("one", "a"), stage("two", "b", 'after = ["one"]\nleaves_out = "the rest"')),
        tmp_path / "out",
    )
    first = reproduce(file, out)
    assert first.returncode == 0, first.error
    assert "2 of 2 stages to do" in first.stdout
    page = (out / "MANIFEST.md").read_text()
    again = reproduce(file, out)
    assert "nothing to do" in again.stdout
    assert (out / "one" / "starts").read_text() == "a "
    assert (out / "MANIFEST.md").read_text() == page


def test_the_manifest_says_what_was_run_where_and_what_came_out(stages, tmp_path):
    file, out = stages(stage("one", "a", 'leaves_out = "the rest, for time"')), tmp_path / "out"
    assert reproduce(file, out, "--copy-to", tmp_path / "copy").returncode == 0
    document = json.loads((out / "manifest.json").read_text())
    (made,) = document["steps"]
    assert document["whole"]
    assert made["state"] == "run"
    assert made["products"]["one/a"] == {"sha256": file_hash(out / "one" / "a"), "bytes": 1}
    assert set(made["load_average"]) == {"before", "mean", "most"}
    assert document["machine"]["cores"] >= 1
    assert document["versions"][0]["python"].startswith("3.")
    page = (out / "MANIFEST.md").read_text()
    assert "one: the rest, for time" in page
    assert file_hash(out / "one" / "a") in page
    assert (tmp_path / "copy" / "one" / "a").read_text() == "a"
    assert (tmp_path / "copy" / "MANIFEST.md").read_text() == page


def test_a_changed_input_makes_its_stage_and_those_after_it_anew(stages, tmp_path):
    file, out = stages(stage("one", "a"), stage("two", "b", 'after = ["one"]')), tmp_path / "out"
    reproduce(file, out)
    stages(stage("one", "a c"), stage("two", "b", 'after = ["one"]'))
    planned = reproduce(file, out, "--dry-run").stdout
    assert planned.count("stale") == 2
    assert "its commands have changed" in planned
    assert (out / "one" / "starts").read_text() == "a "
    kept = reproduce(file, out, "--keep-stale")
    assert kept.stdout.count("kept") == 1
    assert "was kept, although its commands have changed" in (out / "MANIFEST.md").read_text()
    assert reproduce(file, out).returncode == 0
    assert (out / "one" / "starts").read_text() == "a c "
    assert (out / STALE / "one-1" / "one" / "starts").read_text() == "a "
    assert "nothing to do" in reproduce(file, out).stdout


def test_a_stage_depends_on_the_rooms_that_its_commands_run():
    assert rooms_of(["python -m smash_analysis.ablation {out}/a --out {out}/a"]) == ANALYSIS
    assert rooms_of(["smash  sweep x.toml"]) == PLANNING
    assert rooms_of(["smash sweep x.toml", "smash report {out}"]) >= PLANNING | ANALYSIS
    assert not any("execution" in room or "motion" in room for room in PLANNING | ANALYSIS)
    assert rooms_of(["smash episodes {out}"]) == rooms_of(["python {here}/mine.py"]) == EVERYTHING
    assert rooms_of(["python -m smash_analysis_of_mine"]) == EVERYTHING


def test_every_room_is_there_and_none_is_forgotten():
    for rooms in (ANALYSIS, PLANNING, EVERYTHING, *ROOMS.values()):
        assert all(list(_files(frozenset({room}))) for room in rooms)
    parts = {name for name, _ in _files(PLANNING | ANALYSIS)}
    assert parts < {name for name, _ in _files(EVERYTHING)}
    assert {"domains/pick-and-place.pddl", "smash_analysis/report/templates/page.html"} <= parts


@pytest.mark.parametrize(
    ("text", "same"),
    [
        ('"""Other words."""\n\ndef f(x):\n    """Of it."""\n    # a comment\n    return (x\n        + 1)\n', True),
        ("def f(x):\n    return x + 2\n", False),
    ],
)
def test_what_a_program_says_counts_and_not_how_it_is_laid_out(tmp_path, text, same):
    first, second = tmp_path / "first.py", tmp_path / "second.py"
    first.write_text('"""Words."""\n\n\ndef f(x):\n    return x + 1\n')
    second.write_text(text)
    assert (_said(first) == _said(second)) == same


def test_a_file_that_a_command_names_is_an_input(stages, tmp_path):
    file, out = stages(stage("one", "a")), tmp_path / "out"
    reproduce(file, out)
    (tmp_path / "note.py").write_text(NOTE + "\n# changed")
    assert "note.py has changed" in reproduce(file, out, "--dry-run").stdout


def test_a_missing_product_is_made_again_and_a_changed_one_from_nothing(stages, tmp_path):
    file, out = stages(stage("one", "a b")), tmp_path / "out"
    reproduce(file, out)
    (out / "one" / "a").unlink()
    reproduce(file, out)
    assert (out / "one" / "starts").read_text() == "a b a b "
    (out / "one" / "b").write_text("forged")
    assert "one/b is not as it was made" in reproduce(file, out, "--dry-run").stdout
    reproduce(file, out)
    assert (out / "one" / "b").read_text() == "b"


def test_a_killed_stage_is_continued_and_nothing_of_it_lives_on(stages, tmp_path):
    file, out = stages(stage("one", "a slow b"), stage("two", "c")), tmp_path / "out"
    running = subprocess.Popen(command(file, out), stderr=subprocess.DEVNULL, stdout=subprocess.DEVNULL)
    while not (out / "one" / "a").exists():
        time.sleep(0.01)
    below = psutil.Process(running.pid).children(recursive=True)
    running.send_signal(signal.SIGKILL)
    running.wait()
    assert psutil.wait_procs(below, timeout=60)[1] == []
    planned = reproduce(file, out, "--dry-run").stdout
    assert "continued" in planned
    assert "it was killed" in planned
    assert reproduce(file, out).returncode == 0
    assert (out / "one" / "starts").read_text() == "a a slow b "
    assert "in 2 starts" in (out / "MANIFEST.md").read_text()
    assert "nothing to do" in reproduce(file, out).stdout


def test_an_interrupted_one_says_so_and_writes_what_it_has(stages, tmp_path):
    file, out = stages(stage("one", "a"), stage("two", "slow " * 40)), tmp_path / "out"
    running = subprocess.Popen(command(file, out), stderr=subprocess.PIPE, stdout=subprocess.DEVNULL, text=True)
    while not (out / "two").exists():
        time.sleep(0.01)
    running.send_signal(signal.SIGINT)
    _, said = running.communicate(timeout=100)
    assert running.returncode == 130
    assert said.splitlines()[-1] == "smash: interrupted; start again to go on"
    assert [made["state"] for made in json.loads((out / "manifest.json").read_text())["steps"]] == ["run", "not run"]


def test_a_stage_that_fails_is_named_and_stops_only_those_that_have_nothing_without_it(stages, tmp_path):
    bad = stage("bad", "a").replace("python {here}", "python {here}/nowhere")
    file = stages(bad, stage("after", "b", 'after = ["bad"]'), stage("apart", "c"), stage("lacks", "d", LACKS))
    ended = reproduce(file, tmp_path / "out")
    assert ended.returncode == 2
    assert ended.error.startswith("stage bad: `python {here}/nowhere")
    states = {made["name"]: made for made in json.loads((tmp_path / "out" / "manifest.json").read_text())["steps"]}
    assert [made["state"] for made in states.values()] == ["failed", "not run", "run", "not run"]
    assert states["after"]["why"] == "there is nothing of bad"
    assert states["lacks"]["why"] == "not installed: no-such-package"


def test_a_stage_after_several_uses_those_that_there_are(stages, tmp_path):
    bad = stage("bad", "a").replace("python {here}", "python {here}/nowhere")
    file = stages(bad, stage("good", "b"), stage("after", "c", 'after = ["bad", "good"]'))
    assert reproduce(file, tmp_path / "out").returncode == 2
    assert (tmp_path / "out" / "after" / "c").exists()
    stages(stage("bad", "a"), stage("good", "b"), stage("after", "c", 'after = ["bad", "good"]'))
    assert reproduce(file, tmp_path / "out").returncode == 0
    assert (tmp_path / "out" / STALE / "after-1").exists()
    assert "nothing to do" in reproduce(file, tmp_path / "out").stdout


def test_of_alternatives_one_is_enough(stages, tmp_path):
    file = stages(
        stage("one", "a", 'requires = ["no-such-package or numpy"]'),
        stage("two", "b", LACKS.replace('e"]', 'e or other"]')),
    )
    assert [each.lacking() for each in read_stages(file).stages] == [[], ["no-such-package or other"]]


LACKS = 'requires = ["no-such-package"]'


@pytest.mark.parametrize(
    ("part", "problem"),
    [
        (stage("../one", "a"), "steps[0].name"),
        (stage("logs", "a"), "steps[0].name"),
        (stage("one", "a") * 2, "stands twice"),
        (stage("one", "a", 'after = ["two"]'), "no earlier stage"),
        (stage("one", "a").replace("python", "rm"), "does not begin with smash or python"),
        (stage("one", "a").replace('"one/*"', '"../*"'), "does not lie in the stage's folder"),
        (stage("one", "a").replace("minutes = 0.1", ""), "minutes"),
        ("", "steps"),
    ],
)
def test_a_bad_list_is_refused_in_one_line(stages, tmp_path, part, problem):
    with pytest.raises(MalformedFile, match=re.escape(problem)):
        read_stages(stages(part))


@pytest.mark.parametrize("name", ["reproduce", "reproduce-full"])
def test_the_committed_lists_name_files_that_are_there(name):
    stages = read_stages(ROOT / "experiments" / f"{name}.toml")
    assert stages.name == name
    named = [word for stage in stages.stages for command in stage.commands for word in command.split()]
    assert all((ROOT / "experiments" / word[7:]).is_file() for word in named if word.startswith("{here}/"))


def test_the_small_grid_is_said_to_take_at_most_ninety_minutes():
    assert sum(stage.minutes for stage in read_stages(ROOT / "experiments" / "reproduce.toml").stages) <= 90


@pytest.mark.slow
def test_real_stages_from_sweep_to_figures(tmp_path):
    (tmp_path / "few.toml").write_text(
        'name = "few"\nsuites = ["multi-4"]\ninstances = 2\nbuffers = [0, 2]\nbudgets = [0.5, 1]\ncutoff_sample = 1\n'
        '[[planners]]\nname = "smash-layered"\n'
    )
    (tmp_path / "tiny.toml").write_text(
        """name = "tiny"
about = "Tiny."
[[steps]]
name = "ablation"
about = "heatmaps"
minutes = 1
commands = ["smash sweep {here}/few.toml --out {out}/ablation", "python -m smash_analysis.ablation {out}/ablation"]
products = ["ablation/runs.jsonl", "ablation/*.png"]
[[steps]]
name = "frontier"
about = "frontier"
minutes = 1
commands = ["smash frontier multi-4 --most 2 --instances 2 --out {out}/frontier"]
products = ["frontier/*"]
"""
    )
    out = tmp_path / "out"
    running = subprocess.Popen(command(tmp_path / "tiny.toml", out), stderr=subprocess.DEVNULL)
    while not ((out / "ablation" / "runs.jsonl").exists() and (out / "ablation" / "runs.jsonl").read_text()):
        time.sleep(0.02)
    running.send_signal(signal.SIGKILL)
    running.wait()
    ended = reproduce(tmp_path / "tiny.toml", out)
    assert ended.returncode == 0, ended.error
    assert "continued" in ended.stdout
    keys = [json.loads(line)["key"] for line in (out / "ablation" / "runs.jsonl").read_text().splitlines()]
    assert len(keys) == len(set(keys))
    assert "nothing to do" in reproduce(tmp_path / "tiny.toml", out).stdout
