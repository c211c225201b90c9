"""The data set: made, described, read back, asked and scored."""

import csv
import json
import re

import pytest

from smash.cli import smash as command
from smash.experiments.best_known.files import LIST
from smash.experiments.dataset.answers import answered_actions
from smash.experiments.dataset.entries import paper_entries
from smash.experiments.dataset.loading import load_dataset
from smash.experiments.dataset.package import write_dataset
from smash.experiments.dataset.prompts import prompt_in_pddl, prompt_in_words
from smash.experiments.dataset.scoring import answer_text, score, summary
from smash.problem import (
    Law,
    OnGoal,
    Pick,
    Place,
    PlanOptions,
    PositionsGoal,
    Topple,
    Unsupported,
    make_instance,
    read_instance,
)
from smash.problem.certificate import proven_bound
from smash.problem.errors import MalformedFile
from smash.problem.files.plans import action_from_list
from smash.problem.sets.open_instances import FAMILIES
from tests.docs.blocks import ROOT

FIGURE_1 = read_instance(ROOT / "examples" / "figure1.json")


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    """A small data set: the first instance of multi-4 with 0 to 12 buffers, with and without topple."""
    out = tmp_path_factory.mktemp("dataset")
    write_dataset(paper_entries(["multi-4"], 1), out)
    return out


@pytest.fixture(scope="module")
def dataset(folder):
    return load_dataset(folder)


def test_every_problem_has_a_legal_plan_of_its_proven_cost(dataset):
    assert len(dataset.problems) == 26
    for name, entry in dataset.problems.items():
        assert name == entry.name
        assert entry.status == "optimal"
        assert Law(entry.instance, entry.options).check(entry.actions).cost == entry.cost == entry.lower_bound


def test_certificates_prove_what_they_say(dataset):
    assert dataset.certificates
    entry = dataset.problems["multi-4-000/B12/topple"]
    proof = dataset.certificates["multi-4-000/topple"]
    assert proven_bound(entry.instance, entry.options, proof) == entry.cost


def test_the_metadata_is_croissant(folder):
    mlcroissant = pytest.importorskip("mlcroissant")
    described = mlcroissant.Dataset(str(folder / "croissant.json"))
    assert not described.metadata.ctx.issues.errors
    assert not described.metadata.ctx.issues.warnings
    for records, count in (("problems", 26), ("plans", 26), ("instances", 1), ("certificates", 2)):
        assert len(list(described.records(records))) == count


FIRST = "multi-4-000/B0/topple"
DAMAGES = {
    "instances.jsonl": [
        (r".*", "[]"),
        (r'"document":".*"', '"document":5'),
        (r'"document":".*"', '"document":"5"'),
        (r'"name":"multi-4-000","set"', '"name":["x"],"set"'),
        (r"(.*)", r"\1\n\1"),
    ],
    "plans.jsonl": [
        (r".*", '{"problem": "x"}'),
        (r'"problem":"[^"]*"', '"problem":[]'),
        (r'"problem":"[^"]*"', '"problem":"elsewhere"'),
        (r'"actions":".*"', '"actions":"5"'),
        (r'"actions":".*"', '"actions":"[5]"'),
        (r'"actions":".*"', r'"actions":"[[\\"topple\\",\\"s1\\",true]]"'),
        (r'"actions":".*"', '"actions":"[[' + "9" * 5000 + ']]"'),
        (r'"actions":".*"', '"actions":[]'),
        (r"(.*)", r"\1\n\1"),
    ],
    "certificates.jsonl": [
        (r'"certificate":".*"', '"certificate":"5"'),
        (r'"bound":\d+', '"bound":"5"'),
        (r"(.*)", r"\1\n\1"),
    ],
    "problems.csv": [
        (FIRST, "elsewhere"),
        (r"multi-4-000,4,", "elsewhere,4,"),
        (r"multi-4-000,4,", "multi-4-000,5,"),
        (r",0,(\w+),topple,", r",99999999,\1,topple,"),
        (r",0,(\w+),topple,", r",,\1,topple,"),
        (r",0,(\w+),topple,", r",0,\1,nonsense,"),
        (r",optimal,", ",open,"),
        (r",optimal,\d+,", ",optimal," + "9" * 5000 + ","),
        (r",optimal,\d+,", ",optimal,,"),
        (r",multi-4,", f",{'m' * 140_000},"),
        (r",optimal,.*", ""),
        (r"$", ",more"),
        (rf"({FIRST}.*)", r"\1\n\1"),
    ],
}


@pytest.mark.parametrize(("file", "damage"), [(file, damage) for file, listed in DAMAGES.items() for damage in listed])
def test_a_damaged_data_set_is_refused_by_line(folder, tmp_path, file, damage):
    for whole in folder.iterdir():
        (tmp_path / whole.name).write_bytes(whole.read_bytes())
    head, first, *others = ("\n" + (folder / file).read_text()).split("\n")
    if file == "problems.csv":
        head, first, *others = first, *others
    damaged = re.sub(damage[0], damage[1], first, count=1)
    assert damaged != first
    (tmp_path / file).write_text("\n".join([*filter(None, [head]), damaged, *others]))
    with pytest.raises(MalformedFile, match=rf"^\S*({file}|problems\.csv):[123]: [^\n]*$"):
        load_dataset(tmp_path)


@pytest.mark.parametrize(
    "answer",
    [
        'Sure: [["topple", "s1", 2], ["pick", "b1", "s1"], ["place", "b1", "s3"]]. That is it.',
        "```json\n[[1]]\n```\nno, rather\n" + answer_text([Topple("s1", 2), Pick("b1", "s1"), Place("b1", "s3")]),
        "1. topple(s1, 2)\n2. pick b1 s1\n3. Place b1 s3",
        "- (topple s1 2)\n- (pick b1 s1)\n- (place b1 s3)",
        "**1.** **topple** s1 2\n**2.** `pick` `b1` from `s1`\n3) place b1 -> s3.",
        "Now s1: [], s3: []\n* topple s1 at height 2\n* pick b1 from s1\n* place b1 on s3",
        '1: ["topple", "s1", 2]\n2: ["pick", "b1", "s1"]\n3: ["place", "b1", "s3"]',
        '[["topple","s1",2],["pick","b1","s1"],["place","b1","s3"]]\nThen: [["b1"],["b2","b3"]] and [].',
        "topple s1 from height 2\npick b1 from s1, and then place b1->s3; done.",
        "topple(s1, 2), pick(b1, s1), place(b1, s3)",
        "**Step 1:** topple s1 at height 2\nStep 2. Pick b1 from s1\nStep 3 - place b1 onto s3",
        "First, topple s1 2.\nNext, pick b1 from s1.\nFinally, place b1 on s3.",
        "| step | action |\n| 1 | topple | s1 | 2 |\n| 2 | pick | b1 | s1 |\n| 3 | place | b1 | s3 |",
        "[['topple', 's1', 2], ['pick', 'b1', 's1'], ['place', 'b1', 's3']]",
        '{"plan": [[["topple", "s1", 2], ["pick", "b1", "s1"], ["place", "b1", "s3"]]]}',
    ],
)
def test_a_plan_is_found_in_what_a_model_says(answer):
    assert answered_actions(answer) == (Topple("s1", 2), Pick("b1", "s1"), Place("b1", "s3"))


def test_an_empty_list_is_a_plan_where_nothing_else_is_there():
    assert answered_actions("Nothing is to be done: []") == ()
    with pytest.raises(MalformedFile, match="is no action"):
        answered_actions('[["b1"], ["b2"]]')


@pytest.mark.parametrize(
    "answer",
    [
        *(piece * 100_000 for piece in ("[", "[[", "[ ", '["a",', '[["a"],', '"', "\n", "* ", "1. ", "(", "()\n")),
        "[[" + '"a",' * 100_000,
        "pick " + "the " * 100_000 + "(",
        "topple s2 " + "9" * 5_000,
        f'[["topple", "s2", {"9" * 5_000}]]',
        '[["topple", "s2", 01]]',
        '[["topple", "s2", 1.0]]',
        f"[['topple', 's2', {'9' * 5_000}]]",
        '[["topple", "s\\q", 1]]',
        '[["topple", "\\ud800", 1]]',
        "topple \ud800 1",
        "(topple \ud800)",
    ],
    ids=lambda answer: ascii(answer[:12]),
)
@pytest.mark.parametrize("pddl", [False, True])
def test_a_bad_answer_is_a_bad_answer(dataset, answer, pddl):
    if pddl:
        pytest.importorskip("smash_baselines.steps")
    judged = score(dataset.problems["multi-4-000/B12/topple"], answer, pddl=pddl)
    assert not judged.legal
    assert judged.reason.encode()


def test_answers_are_scored_by_legality_and_gap(dataset):
    entry = dataset.problems["multi-4-000/B12/no-topple"]
    best = score(entry, entry.actions)
    again = score(entry, answer_text([*entry.actions, *_there_and_back(entry)]))
    none, wrong = score(entry, "I cannot."), score(entry, '[["pick", "nobody", "s1"]]')
    assert (best.legal, best.gap, again.cost) == (True, 0.0, entry.cost + 4)
    assert not none.legal
    assert "step 1" in wrong.reason
    lines = summary([best, again, none, wrong])
    assert lines[:2] == ["legal: 2 of 4", "optimal: 1 of 4"]


def _there_and_back(entry):
    block, home = entry.actions[-1].block, entry.actions[-1].target
    aside = entry.instance.buffers[-1]
    return Pick(block, home), Place(block, aside), Pick(block, aside), Place(block, home)


def test_answers_in_pddl_are_read_by_the_encoding_of_the_prompt(dataset):
    pytest.importorskip("smash_baselines.steps")
    from smash_baselines.steps import steps_of

    from smash.experiments.dataset.prompts import pddl_task

    for variant in ("topple", "no-topple"):
        entry = dataset.problems[f"multi-4-000/B2/{variant}"]
        steps = steps_of(entry.actions, pddl_task(entry.instance, entry.options))
        answer = "\n".join(f"({' '.join(step)})" for step in steps)
        assert score(entry, f"The plan:\n{answer}\n", pddl=True).cost == entry.cost
        assert not score(entry, "(nonsense b1)", pddl=True).legal


def test_a_prompt_tells_the_rules_that_hold():
    words = prompt_in_words(FIGURE_1)
    assert '"b1" is at height 1 of "s3"' in words
    assert "topple" in words
    without = prompt_in_words(FIGURE_1, PlanOptions(topple=False))
    assert '"topple"' not in without
    assert "at most 2" in prompt_in_words(FIGURE_1, PlanOptions(max_topple=2))
    relations = make_instance({"s1": ["a", "b"]}, OnGoal({"a": "b"}, bottom=("b",)), buffers=1)
    assert '"a" lies directly on "b"' in prompt_in_words(relations)
    assert "(define (problem" in prompt_in_pddl(FIGURE_1)
    with pytest.raises(Unsupported):
        prompt_in_words(read_instance(ROOT / "examples" / "scoop.json"))


def test_a_prompt_says_where_nothing_is_asked_or_there():
    idle = make_instance({"s1": ["a", "b"]}, OnGoal({}), buffers=1)
    assert "Goal:\n- nothing is asked\n" in prompt_in_words(idle)
    empty = make_instance({"s1": []}, {"s1": []})
    assert "for example []." in prompt_in_words(empty)


def test_a_prompt_in_pddl_tells_costs_by_the_chain():
    pytest.importorskip("smash_baselines.steps")
    assert "carry-cost" in prompt_in_pddl(read_instance(ROOT / "examples" / "scoop.json"))


@pytest.mark.parametrize(
    ("step", "reason"),
    [
        ("fly b01", "no action is called 'fly'"),
        ("pick b1 b2", "no object is called 'b1'"),
        ("pick", "an argument is missing"),
        ("pick-base s01 s01", "'s01' is not what stands at its place"),
    ],
)
def test_a_step_outside_the_encoding_is_named(dataset, step, reason):
    pytest.importorskip("smash_baselines.steps")
    judged = score(dataset.problems["multi-4-000/B2/topple"], f"({step})", pddl=True)
    assert judged.reason == f"step ({step}) does not fit the encoding ({reason})"


def test_a_truth_is_no_height():
    with pytest.raises(MalformedFile, match="is no action"):
        action_from_list(["topple", "s2", True], "plan")
    with pytest.raises(MalformedFile, match="is no action"):
        action_from_list(["lift", "s2", True, "s1"], "plan")
    with pytest.raises(MalformedFile, match="not allowed"):
        make_instance({"s1": ["a"]}, PositionsGoal({"a": ("s1", True)}))


def test_the_commands_ask_and_score(folder, dataset, tmp_path, capsys):
    entry = dataset.problems["multi-4-000/B0/topple"]
    answers = tmp_path / "answers.jsonl"
    answers.write_text(json.dumps({"problem": entry.name, "answer": answer_text(entry.actions)}) + "\n")
    command.main(["score", str(folder), str(answers), "--out", str(tmp_path / "s.jsonl")], standalone_mode=False)
    assert "optimal: 1 of 1" in capsys.readouterr().out
    assert json.loads((tmp_path / "s.jsonl").read_text())["gap"] == 0


@pytest.mark.parametrize(
    "line",
    [
        '{"problem": "nowhere", "answer": ""}',
        '{"problem": ["x"], "answer": ""}',
        '{"problem": {}, "answer": ""}',
        '{"problem": "multi-4-000/B0/topple", "answer": 5}',
        '{"problem": "multi-4-000/B0/topple", "answer": "", "form": []}',
        "[]",
    ],
)
def test_a_line_that_is_no_answer_is_refused(folder, tmp_path, line):
    answers = tmp_path / "answers.jsonl"
    answers.write_text(line + "\n")
    with pytest.raises(MalformedFile, match=r"answers\.jsonl:1"):
        command.main(["score", str(folder), str(answers)], standalone_mode=False)


def test_the_committed_data_set_says_what_the_list_of_best_known_plans_says():
    known = _rows(LIST / "best-known.csv")
    for row in known:
        row["status"] = "optimal" if row["proven"] == "yes" else "open"
    said = [row for row in _rows(ROOT / "results" / "dataset" / "problems.csv") if row["set"] in FAMILIES]
    differing = {row[:2] for row in _standings(known) ^ _standings(said)}
    assert not differing, f"{len(differing)} problems of results/dataset are older than the list: `make dataset`"


def _rows(path):
    return list(csv.DictReader(path.read_text().splitlines()))


def _standings(rows):
    return {tuple(row[name] for name in ("instance", "variant", "status", "cost", "lower_bound")) for row in rows}
