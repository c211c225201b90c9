"""What damaged files have shown: each case by itself, with its line."""

import json

import pytest

from tests.fuzz.kinds import ROOT, STAGES, SWEEP
from tests.fuzz.running import run

LIST = ROOT / "results" / "best-known" / "best-known.csv"


def ended(*words):
    answer = run(list(map(str, words)))
    assert answer.said.count("\n") == 1, answer.said
    return answer.code, answer.said


@pytest.mark.parametrize(
    ("text", "words"), [(SWEEP, ("sweep", "--dry-run")), (STAGES, ("reproduce", "--dry-run", "--steps"))]
)
def test_a_number_too_long_for_python_is_no_toml(tmp_path, text, words):
    file = tmp_path / "file.toml"
    file.write_text(f"{text}\nmore = {'9' * 5000}\n")
    code, said = ended(*words, file)
    assert code == 2
    assert "not TOML" in said


def test_a_list_with_a_short_row_or_a_stray_carriage_return_is_none(tmp_path):
    header, row, *_ = LIST.read_text().splitlines()
    (tmp_path / LIST.name).write_text(f"{header}\n{row.partition(',')[0]}\n")
    assert ended("best-known", "table", "--list", tmp_path) == (
        2,
        f"smash: {tmp_path / LIST.name}:2: no row of a list of best known plans of the open instances\n",
    )
    (tmp_path / LIST.name).write_bytes(f"{header}\n{row}".encode() + b"\rx\n")
    assert ended("best-known", "table", "--list", tmp_path)[0] == 2


def test_a_page_that_is_no_utf_8_is_not_written_into(tmp_path):
    page = tmp_path / "page.md"
    page.write_bytes(b"\xff\xfe")
    assert ended("best-known", "table", "--into", page) == (2, f"smash: {page}: not UTF-8 text\n")


@pytest.mark.parametrize("seeds", [b"\xef\xff", b'{"format": "smash-episodes/1", "questions": [{"seeds": 999999999}]}'])
def test_damage_to_what_was_asked_of_episodes_is_said(tmp_path, seeds):
    runs = (ROOT / "results" / "friction" / "runs.jsonl").read_bytes().splitlines(keepends=True)[:1]
    (tmp_path / "runs.jsonl").write_bytes(b"".join(runs))
    (tmp_path / "episodes.jsonl").write_bytes(
        (ROOT / "results" / "friction" / "episodes.jsonl").read_bytes().splitlines(keepends=True)[0]
    )
    (tmp_path / "episodes-asked.json").write_bytes(seeds)
    checked = run(["records", "check", str(tmp_path)])
    assert checked.code == 0
    assert "not known" in checked.said


def test_a_table_on_the_terminal_escapes_what_a_record_of_a_stage_says(tmp_path, every_kind):
    stages, made = tmp_path / "stages.toml", tmp_path / "made"
    stages.write_text(STAGES)
    document = json.loads(every_kind["record of a stage"].whole[0])
    document["made_from"]["packages"] = {"numba": "\x1b[31mred"}
    (made / "records").mkdir(parents=True)
    (made / "records" / "first.json").write_text(json.dumps(document))
    said = run(["reproduce", "--steps", str(stages), "--out", str(made), "--dry-run"]).said
    assert "\\x1b[31mred" in said
    assert "\x1b" not in said
