"""Every kind of file that a command opens: whole ones to damage, and the commands that are to read them."""

import json
from dataclasses import dataclass
from itertools import islice
from pathlib import Path

import msgspec

from smash.records.files import EPISODES, RUNS, TRIALS
from tests.analysis.made_up import small_sweep
from tests.fuzz.running import run

ROOT = Path(__file__).parents[2]
FRICTION = ROOT / "results" / "friction"
WORLD = """(define (domain w) (:requirements :strips :typing) (:types block)
 (:predicates (on ?x - block ?y - block) (ontable ?x - block) (clear ?x - block) (handempty) (holding ?x - block))
 (:action pick-up :parameters (?x - block) :precondition (and (clear ?x) (ontable ?x) (handempty))
  :effect (and (not (ontable ?x)) (not (clear ?x)) (not (handempty)) (holding ?x)))
 (:action put-down :parameters (?x - block) :precondition (holding ?x)
  :effect (and (not (holding ?x)) (clear ?x) (handempty) (ontable ?x)))
 (:action stack :parameters (?x - block ?y - block) :precondition (and (holding ?x) (clear ?y))
  :effect (and (not (holding ?x)) (not (clear ?y)) (clear ?x) (handempty) (on ?x ?y)))
 (:action unstack :parameters (?x - block ?y - block) :precondition (and (on ?x ?y) (clear ?x) (handempty))
  :effect (and (holding ?x) (clear ?y) (not (clear ?x)) (not (handempty)) (not (on ?x ?y)))))
"""
SUSSMAN = """; the anomaly
(define (problem sussman) (:domain w) (:objects a b c - block)
 (:init (ontable a) (ontable b) (on c a) (clear b) (clear c) (handempty))
 (:goal (and (on a b) (on b c))))
"""
STEPS = "(unstack c a)\n(put-down c)\n(pick-up b)\n(stack b c)\n(pick-up a)\n(stack a b)\n; cost = 6 (unit cost)\n"
SWEEP = """name = "small"
suites = ["set", "multi-4"]
instances = 2
buffers = [1, 4]
budgets = [0.1, 2]
variants = ["topple", "no-topple", "max-topple-2"]
seeds = [0]
memory = 1024
jobs = 1
cutoff_sample = 1

[[planners]]
name = "greedy"
label = "quick"

[[planners]]
name = "smash-layered"
warm_start = "greedy"
horizon = 4
threads = 1
solver = "highs"
suites = ["set"]

[[planners]]
name = "outside"
command = "true {domain} {problem} {plan}"
encoding = "chain"
"""
STAGES = """name = "two"
about = "two stages"
[[steps]]
name = "first"
about = "the first"
minutes = 0.1
commands = ["smash validate {here}/figure1.json {here}/plan.json",
 "smash generate multi --blocks 3 --count 1 --out {out}/first"]
products = ["first/*.json"]
requires = ["msgspec"]
leaves_out = "nothing"
"""
SCENE = """format = "smash-scene/1"
name = "mine"
base = "default"
[block]
side = 0.045
mass = 0.1
[friction]
block = 0.45
[speed]
velocity = 0.5
[[stacks]]
radius = 0.45
angle = 60
topple = ["clockwise"]
[[stacks]]
radius = 0.45
angle = -60
topple = ["counter-clockwise"]
[[buffers]]
radius = 0.40
angle = 15
"""
ARMED = {
    "format": "smash-instance/2",
    "name": "armed",
    "blocks": ["a", "b", "c", "d"],
    "stacks": ["s1", "s2"],
    "buffers": ["u1"],
    "start": {"s1": ["a", "b"]},
    "table": ["d"],
    "hand": "c",
    "goal": {"kind": "on", "on": {"a": "b"}, "bottom": ["b"], "ontable": ["d"], "clear": ["a"]},
}
PLACED = {
    "format": "smash-instance/1",
    "name": "placed",
    "blocks": ["a", "b", "c"],
    "stacks": ["s1", "s2"],
    "buffers": ["u1"],
    "start": {"s1": ["a", "b"], "u1": ["c"]},
    "goal": {"kind": "positions", "positions": {"b": ["s2", 1], "c": ["s1", 1]}},
}


@dataclass(frozen=True)
class Kind:
    """A kind of file.

    Attributes:
        name: In the table of what was tried.
        file: Where it lies below the folder of a case.
        sort: How its values are damaged: `json`, `jsonl`, `toml`, `words`.
        whole: Files as they should be.
        commands: What reads it, each with how many seconds of a processor it takes, about: quick ones are tried more
            often.
        beside: Other files that the commands need.
    """

    name: str
    file: str
    sort: str
    whole: tuple[bytes, ...]
    commands: tuple[tuple[float, str], ...]
    beside: dict[str, bytes]


def _bytes(document):
    return json.dumps(document).encode()


def _read(path):
    return (ROOT / path).read_bytes()


def _head(file, count):
    with open(file, "rb") as lines:
        return b"".join(islice(lines, count))


def kinds(folder):
    """Return every kind; `folder` is where whole files are made."""
    plan, proof, lift = folder / "plan.json", folder / "proof.json", folder / "lift.json"
    example, scoop = ROOT / "examples" / "figure1.json", ROOT / "examples" / "scoop.json"
    for words in (
        f"plan {example} --planner precedence --budget 5 --out {plan}",
        f"certify {example} {plan} --budget 5 --out {proof}",
        f"plan {scoop} --planner greedy --budget 5 --out {lift}",
    ):
        assert run(words.split()).code == 0, words
    instance = {"figure1.json": example.read_bytes()}
    planned = {**instance, "plan.json": plan.read_bytes()}
    listed, submitted = _short_list()
    pddl = {"world.pddl": WORLD.encode(), "problem.pddl": SUSSMAN.encode(), "steps": STEPS.encode()}
    sussman = folder / "sussman.json"
    assert run(["import-blocks", _made(folder, pddl) + "/problem.pddl", "--out", str(sussman)]).code == 0
    imported = {**pddl, "instance.json": sussman.read_bytes()}
    placed = _bytes(PLACED)
    runs = b"".join(_bytes(entry.document) + b"\n" for entry in small_sweep())
    moved, episodes = _few_episodes()
    results = "results/"
    recorded = {results + RUNS.name: runs, results + "experiment.toml": SWEEP.encode(), results + "set/p.json": placed}
    performed = {results + RUNS.name: moved, results + EPISODES.name: episodes}
    asked = (FRICTION / "episodes-asked.json").read_bytes()
    check, export = (0.05, "records check {in}/results"), (0.3, "records export {in}/results --out {out}/tables")
    report = (3.0, "report {in}/results --out {out}/report")
    steps = "import-plan {in}/instance.json {file} --out {out}/plan.json"
    into = "import-plan {in}/instance.json {in}/steps --out {out}/plan.json"
    return [
        Kind(
            "instance",
            "instance.json",
            "json",
            (example.read_bytes(), scoop.read_bytes(), _bytes(ARMED), _bytes(PLACED)),
            (
                (0.01, "validate {file} {in}/plan.json"),
                (0.02, "export-pddl {file} --out {out}/pddl"),
                (0.02, "model {file}"),
                (0.3, "draw instance {file} --out {out}/picture.svg"),
                (0.5, "plan {file} --planner greedy --budget 1 --out {out}/plan.json"),
                (1.0, "plan {file} --planner smash --budget 1"),
                (1.0, "frontier {file} --most 1 --planner greedy --budget 0.5 --out {out}/frontier"),
                (0.05, "certify {file} {in}/plan.json --budget 1 --out {out}/proof.json"),
                (3.0, "execute {file} {in}/plan.json --no-replan"),
            ),
            planned,
        ),
        Kind(
            "plan",
            "a-plan.json",
            "json",
            (plan.read_bytes(), lift.read_bytes()),
            (
                (0.01, "validate {in}/figure1.json {file}"),
                (0.01, "validate {in}/scoop.json {file}"),
                (0.02, "export-plan {in}/figure1.json {file} --as chain --out {out}/steps"),
                (0.02, "export-plan {in}/figure1.json {file} --as classical --out {out}/steps"),
                (0.05, "certify {in}/figure1.json {file} --budget 1 --out {out}/proof.json"),
                (0.02, "verify {in}/figure1.json {file} {in}/proof.json"),
                (0.05, "submit-check {file}"),
                (0.5, "draw plan {in}/figure1.json {file} --out {out}/film.svg"),
            ),
            {**instance, "scoop.json": scoop.read_bytes(), "proof.json": proof.read_bytes()},
        ),
        Kind(
            "submitted plan",
            "mine.json",
            "json",
            (submitted,),
            (
                (0.05, "submit-check {file}"),
                (0.05, "submit-check {file} --list {in}/best-known"),
                (0.3, "best-known add {file} --by me --list {in}/best-known"),
            ),
            listed,
        ),
        Kind(
            "certificate",
            "proof.json",
            "json",
            (proof.read_bytes(),),
            (
                (0.02, "verify {in}/figure1.json {in}/plan.json {file}"),
                (0.05, "submit-check {in}/plan.json --certificate {file}"),
            ),
            planned,
        ),
        Kind(
            "certificate in RESULTS",
            results + "certificates/proof.json",
            "json",
            (proof.read_bytes(),),
            (check,),
            recorded,
        ),
        Kind(
            "PDDL problem",
            "a-problem.pddl",
            "words",
            (SUSSMAN.encode(), _read("tests/problem/blocksworld/line-up.pddl")),
            (
                (0.02, "import-blocks {file} --out {out}/instance.json"),
                (
                    0.02,
                    "import-blocks {file} --domain {in}/world.pddl --stacks 4 --buffers 2 --out {out}/instance.json",
                ),
                (0.02, "validate {in}/instance.json {in}/steps --problem {file} --domain {in}/world.pddl"),
                (0.02, "import-blocks {in} --out {out}/set"),
            ),
            imported,
        ),
        Kind(
            "PDDL domain",
            "a-domain.pddl",
            "words",
            (WORLD.encode(),),
            (
                (0.02, "import-blocks {in}/problem.pddl --domain {file} --out {out}/instance.json"),
                (
                    0.02,
                    f"{into} --problem {{in}}/problem.pddl --domain {{file}}",
                ),
                (0.02, "import-blocks {in} --out {out}/set"),
            ),
            imported,
        ),
        Kind(
            "classical plan",
            "sas_plan",
            "words",
            (STEPS.encode(),),
            (
                (0.01, "validate {in}/instance.json {file}"),
                (0.01, steps),
                (
                    0.02,
                    f"{steps} --problem {{in}}/problem.pddl --domain {{in}}/world.pddl",
                ),
            ),
            imported,
        ),
        Kind(
            "experiment",
            results + "experiment.toml",
            "toml",
            (SWEEP.encode(),),
            (
                (0.05, "sweep {file} --dry-run --out {out}/runs"),
                (0.1, "records check {in}/results --experiment {file}"),
                (0.1, "records check {in}/results"),
                (3.0, "report {in}/results --out {out}/report"),
            ),
            recorded,
        ),
        Kind(
            "instance of a set",
            "set/placed.json",
            "json",
            (_bytes(PLACED), _bytes(ARMED)),
            ((0.05, "sweep {in}/small.toml --dry-run --out {out}/runs"),),
            {"small.toml": SWEEP.encode()},
        ),
        Kind(
            "kept sets",
            results + "instances/sets.json",
            "json",
            (_bytes({"set": "set"}),),
            ((0.05, "sweep {in}/results/experiment.toml --dry-run --out {out}/runs"), check),
            {**recorded, results + "instances/set/placed.json": _bytes(PLACED)},
        ),
        Kind(
            "scene",
            "scene.toml",
            "toml",
            (SCENE.encode(), _read("examples/scoop-scene.toml"), _read("examples/boxes-scene.toml")),
            (
                (0.2, "draw-scene {file}"),
                (0.3, "draw-scene {file} --out {out}/scene.svg"),
                (0.02, "layout {in}/figure1.json --height 1 --attempts 1 --scene {file} --out {out}/made.toml"),
                (0.02, "execute {in}/figure1.json {in}/none.json --scene {file}"),
                (0.05, "episodes {in}/results --scene {file} --dry-run"),
            ),
            {**instance, **performed},
        ),
        Kind(
            "runs",
            results + RUNS.name,
            "jsonl",
            (runs,),
            (
                *(check, export, report),
                (0.1, "best-known update {in}/results --list {in}/best-known"),
                (0.05, "sweep {in}/results/experiment.toml --dry-run --out {in}/results"),
                (0.05, "episodes {in}/results --dry-run"),
            ),
            {**recorded, **listed},
        ),
        Kind(
            "runs with episodes",
            results + RUNS.name,
            "jsonl",
            (moved,),
            (check, (0.1, "costs {in}/results {in}/figure1.json"), (0.05, "episodes {in}/results --dry-run")),
            {**instance, **performed},
        ),
        Kind(
            "episodes",
            results + EPISODES.name,
            "jsonl",
            (episodes,),
            (
                *(check, export, report),
                (0.1, "costs {in}/results {in}/figure1.json --out {out}/priced.json"),
                (0.05, "episodes {in}/results --dry-run"),
            ),
            {**instance, **performed, results + "episodes-asked.json": asked},
        ),
        Kind(
            "episodes asked for",
            results + "episodes-asked.json",
            "json",
            (asked,),
            (check, (3.0, report[1])),
            performed,
        ),
        Kind(
            "trials",
            results + TRIALS.name,
            "jsonl",
            (_head(ROOT / "results/topple-map" / TRIALS.name, 6),),
            ((1.0, report[1]),),
            {},
        ),
        Kind(
            "topple estimates",
            "estimates.json",
            "json",
            (_read("results/topple-map/estimates.json"),),
            ((0.5, "plan {in}/figure1.json --planner greedy --budget 1 --estimates {file} --out {out}/plan.json"),),
            instance,
        ),
        Kind(
            "stages",
            "stages.toml",
            "toml",
            (STAGES.encode(), _read("experiments/reproduce.toml")),
            ((0.1, "reproduce --steps {file} --dry-run --out {out}/made"),),
            {},
        ),
        Kind(
            "record of a stage",
            "made/records/first.json",
            "json",
            (_stage_record(folder),),
            ((0.1, "reproduce --steps {in}/stages.toml --dry-run --out {in}/made"),),
            {"stages.toml": STAGES.encode()},
        ),
        Kind(
            "best-known list",
            "best-known/best-known.csv",
            "words",
            (listed["best-known/best-known.csv"],),
            (
                (0.02, "best-known table --list {in}/best-known"),
                (0.05, "submit-check {in}/mine.json --list {in}/best-known"),
            ),
            {**listed, "mine.json": submitted},
        ),
        Kind(
            "page of the list",
            "page.md",
            "words",
            (_page(),),
            ((0.05, "best-known table --list {in}/best-known --into {file}"),),
            listed,
        ),
        Kind(
            "scaling table",
            results + "scaling.csv",
            "words",
            (_head(ROOT / "results/scaling/scaling.csv", 12),),
            ((1.0, report[1]), (0.01, "records check {in}/results")),
            {},
        ),
    ]


def _made(folder, files):
    for name, content in files.items():
        (folder / name).write_bytes(content)
    return str(folder)


def _few_episodes():
    """The first runs of a sweep that were carried out, and their episodes."""
    episodes = _head(FRICTION / EPISODES.name, 4)
    keys = {msgspec.json.decode(line)["run"] for line in episodes.splitlines()}
    with open(FRICTION / RUNS.name, "rb") as lines:
        runs = b"".join(line for line in lines if msgspec.json.decode(line)["key"] in keys)
    return runs, episodes


def _short_list():
    """A few lines of the list of best known plans with their plans, and one of these."""
    header, *rows = _read("results/best-known/best-known.csv").splitlines(keepends=True)
    short = [row for row in rows if row.startswith(b"open-short-stacks-00")]
    plans = sorted((ROOT / "results/best-known/plans").glob("open-short-stacks-00*.json"))
    listed = {f"best-known/plans/{plan.name}": plan.read_bytes() for plan in plans}
    return {**listed, "best-known/best-known.csv": header + b"".join(short)}, plans[0].read_bytes()


def _page():
    """The page of open instances without most of its table."""
    lines = _read("docs/open-instances.md").splitlines(keepends=True)
    return b"".join(line for line in lines if not line.startswith(b"| open-"))


def _stage_record(folder):
    stages = folder / "stages.toml"
    (folder / "figure1.json").write_bytes(_read("examples/figure1.json"))
    stages.write_text(STAGES)
    assert run(["reproduce", "--steps", str(stages), "--out", str(folder / "made")]).code == 0
    return (folder / "made" / "records" / "first.json").read_bytes()
