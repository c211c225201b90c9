"""`smash import-blocks`: what it says, folders as sets, places for towers, exit codes."""

import json
import subprocess
import sys

import pytest
from click.testing import CliRunner

from smash import suite
from smash.cli.import_blocks import command
from smash.problem.errors import SmashError
from tests.pddl_worlds import Dress

TOWERS = (("c",), ("a", "b"), ("d",))
FOUR, CRATES, THREE = Dress("four"), Dress("four", "crates"), Dress("three")


def smash(*arguments):
    return subprocess.run(
        [sys.executable, "-m", "smash", *map(str, arguments)], capture_output=True, text=True, timeout=110
    )


def run(*arguments):
    return CliRunner().invoke(command, list(map(str, arguments)))


@pytest.fixture
def folder(tmp_path):
    """Problems of three domains, one file that is none, and one that holds no instance."""
    root = tmp_path / "found"
    for sub, dress in (("", FOUR), ("crates", CRATES), ("three", THREE)):
        (root / sub).mkdir(parents=True, exist_ok=True)
        (root / sub / "domain.pddl").write_text(dress.domain())
        for number, on in enumerate((("a", "c"), ("d", "a")), start=1):
            (root / sub / f"p{number}.pddl").write_text(dress.problem(TOWERS, dress.goal(on=[on])))
    (root / "notes.txt").write_text("nothing")
    return root


def test_a_folder_becomes_a_set(folder, tmp_path):
    ended = run(folder, "--out", tmp_path / "set")
    assert ended.exit_code == 0
    assert "6 instances in" in ended.output
    assert ended.output.count("recognised by its domain") == 3
    assert "one move costs 2 here" in ended.output
    names = [instance.name for instance in suite(tmp_path / "set")]
    assert names == ["crates-p1", "crates-p2", "p1", "p2", "three-p1", "three-p2"]


@pytest.mark.slow
def test_a_folder_becomes_a_table_in_three_commands(folder, tmp_path):
    out, results = tmp_path / "set", tmp_path / "results"
    assert smash("import-blocks", folder, "--out", out).returncode == 0
    compared = smash("compare", out, "--planner", "greedy", "--planner", "astar", "--budget", 5, "--out", results)
    assert compared.returncode == 0
    assert smash("report", results).returncode == 0


def test_what_cannot_be_read_is_a_line_each_and_a_count_by_kind(folder, tmp_path):
    (folder / "bad.pddl").write_text("(define (problem")
    (folder / "gone.pddl").symlink_to("nowhere")
    (folder / "two.pddl").write_text(FOUR.problem(TOWERS, "(or (on a b) (on b a))"))
    (folder / "never.pddl").write_text(FOUR.problem(TOWERS, "(and (on a b) (on a c))"))
    ended = smash("import-blocks", folder, "--out", tmp_path / "set")
    assert ended.returncode == 2
    assert len(list((tmp_path / "set").glob("*.json"))) == 6
    *lines, last = ended.stderr.splitlines()
    assert [line.split(":")[1].rpartition("/")[2] for line in lines] == [
        "bad.pddl",
        "gone.pddl",
        "never.pddl",
        "two.pddl",
    ]
    assert last == "smash: 4 files not imported: 2 malformed, 1 infeasible, 1 unsupported"


def test_several_files_are_called_after_them_and_told_apart(folder, tmp_path):
    files = [folder / "p1.pddl", folder / "p2.pddl", folder / "crates" / "p1.pddl"]
    assert run(*files, "--out", tmp_path / "set").exit_code == 0
    assert sorted(path.stem for path in (tmp_path / "set").iterdir()) == ["crates-p1", "found-p1", "p2"]


def test_a_domain_is_no_problem_and_no_failure(folder, tmp_path):
    domains = tmp_path / "domains"
    domains.mkdir()
    (domains / "some-domain.pddl").write_text(FOUR.domain())
    assert run(domains, "--out", tmp_path / "set").exit_code == 2
    assert run(folder, domains, "--out", tmp_path / "set").exit_code == 0


def test_a_given_domain_serves_all(folder, tmp_path):
    (folder / "crates" / "domain.pddl").rename(tmp_path / "d.pddl")
    assert run(folder / "crates", "--domain", tmp_path / "d.pddl", "--out", tmp_path / "set").exit_code == 0
    assert run(folder / "crates", "--domain", folder / "p1.pddl", "--out", tmp_path / "set").exception is not None
    ended = smash("import-blocks", folder / "crates", "--out", tmp_path / "none")
    assert ended.returncode == 2
    assert "give it with --domain" in ended.stderr


def test_towers_stand_tallest_first_on_stacks_then_on_buffers(folder, tmp_path):
    out = tmp_path / "p.json"
    ended = smash("import-blocks", folder / "p1.pddl", "--stacks", 2, "--buffers", 3, "--name", "mine", "--out", out)
    assert ended.returncode == 0
    assert "1 tower on buffers" in ended.stderr
    written = json.loads(out.read_text())
    assert (written["name"], written["stacks"], written["buffers"]) == ("mine", ["p1", "p2"], ["u1", "u2", "u3"])
    assert written["start"] == {"p1": ["a", "b"], "p2": ["c"], "u1": ["d"]}


def test_too_few_places_are_refused_with_the_flags_that_fit(folder, tmp_path):
    ended = smash("import-blocks", folder / "p1.pddl", "--stacks", 1, "--buffers", 1, "--out", tmp_path / "p.json")
    assert ended.returncode == 2
    assert "3 towers at the start, 2 places; `--stacks 3`, or `--stacks 1 --buffers 2`, would fit" in ended.stderr
    assert not (tmp_path / "p.json").exists()


def test_a_name_is_for_one_instance(folder, tmp_path):
    assert run(folder, "--name", "x", "--out", tmp_path / "set").exit_code == 2
    assert run(folder, "--out", folder / "p1.pddl").exception is not None


@pytest.mark.parametrize(
    ("init", "goal", "code", "words"),
    [
        ("(on a a) (handempty)", "(on a b)", 2, "does not stand"),
        ("(ontable a) (on b a) (clear b) (handempty)", "(and (on a b) (on a c))", 3, "(on a b) and (on a c)"),
        ("(ontable a) (on b a) (handempty)", "(on a b)", 3, "no action applies"),
        ("(ontable a) (on b a) (clear b) (handempty)", "(holding a)", 6, "a block in the hand at the end"),
    ],
)
def test_exit_codes_say_what_is_wrong_and_no_file_is_written(tmp_path, init, goal, code, words):
    path = tmp_path / "p.pddl"
    objects = "a b c" if "c" in goal else "a b"
    more = " (ontable c) (clear c)" if "c" in goal else ""
    path.write_text(f"(define (problem p) (:domain d) (:objects {objects}) (:init {init}{more}) (:goal {goal}))")
    ended = smash("import-blocks", path, "--out", tmp_path / "p.json")
    assert ended.returncode == code
    assert words in ended.stderr
    assert ended.stderr.count("\n") == 1
    assert not (tmp_path / "p.json").exists()


def test_how_a_problem_was_read_is_said(tmp_path):
    path, out = tmp_path / "p.pddl", tmp_path / "p.json"
    facts = "(ontable a) (clear a) (red a) (= (size a) 2)"
    path.write_text(f"(define (problem p) (:domain d) (:objects a) (:init {facts}) (:goal (ontable a)))")
    ended = smash("import-blocks", path, "--out", out)
    assert "no hand is in :init" in ended.stdout
    assert "facts of red, size are passed over" in ended.stderr
    path.write_text(CRATES.problem(TOWERS, "(and)"))
    (tmp_path / "d.pddl").write_text(CRATES.domain())
    said = smash("import-blocks", path, "--domain", tmp_path / "d.pddl", "--out", out).stdout
    assert "on = rests, ontable = grounded, clear = free, holding = dangling, handempty = crane-idle" in said


def test_a_path_that_is_missing_is_one_line(tmp_path):
    error = run(tmp_path / "none.pddl", "--out", tmp_path / "o.json").exception
    assert isinstance(error, SmashError)
    assert error.exit_code == 2
