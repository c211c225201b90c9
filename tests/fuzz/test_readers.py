"""Whatever stands in a file: a command ends with one line and an exit code, in time, and writes where it is told."""

import random
import shutil
from collections import Counter

import pytest

from tests.fuzz.damage import damage
from tests.fuzz.running import LONGEST, outside, run

SAMPLE, MANY = 6, 400
"""Files of each kind in the default run and in the slow one."""
QUICK = 0.2
"""What a command of the default run may take [s]; a kind that only slower ones read is left to the slow run."""
MEANT = {0, 2, 3, 4, 5, 6}
JUDGES = ("submit-check", "best-known add")
"""Commands that end with 1 where a plan is no better than what is known."""


def trial(kind, case, seed, slowest=None):
    """Damage a file of a kind, run a command on it; return what is wrong with how that ended."""
    draw = random.Random(f"{kind.name} {seed}")
    shutil.rmtree(case, ignore_errors=True)
    folder, out = case / "in", case / "out"
    out.mkdir(parents=True)
    for name, content in kind.beside.items():
        (folder / name).parent.mkdir(parents=True, exist_ok=True)
        (folder / name).write_bytes(content)
    file = folder / kind.file
    file.parent.mkdir(parents=True, exist_ok=True)
    made = damage(file, draw.choice(kind.whole), kind.sort, draw)
    chosen = [command for command in kind.commands if slowest is None or command[0] <= slowest] or kind.commands[:1]
    words = draw.choices([words for _, words in chosen], [1 / seconds for seconds, _ in chosen])[0]
    ended = run([word.format(**{"in": folder, "out": out, "file": file}) for word in words.split()], longest=LONGEST)
    wrong = []
    if ended.code not in MEANT | ({1} if words.startswith(JUDGES) else set()):
        wrong.append(f"ended with {ended.code}")
    if "Traceback" in ended.said or "defect" in ended.said or "\x1b[31m" in ended.said:
        wrong.append("said what nobody can read")
    if ended.code in MEANT - {0} and not ended.said.strip():
        wrong.append("said nothing")
    strays = outside(ended, folder, out)
    if strays:
        wrong.append(f"wrote {strays}")
    return [f"{kind.name}, {seed}: {words}: {fault}: {ended.said[-300:]}" for fault in wrong], made


NAMES = [
    *("instance", "plan", "submitted plan", "certificate", "certificate in RESULTS", "PDDL problem", "PDDL domain"),
    *("classical plan", "experiment", "instance of a set", "kept sets", "scene", "runs", "runs with episodes"),
    *("episodes", "episodes asked for", "trials", "topple estimates", "stages", "record of a stage"),
    *("best-known list", "page of the list", "scaling table"),
]


def test_every_kind_is_tried(every_kind):
    assert set(every_kind) == set(NAMES)


@pytest.mark.parametrize("name", NAMES)
def test_a_damaged_file_ends_in_one_line(every_kind, name, tmp_path):
    kind = every_kind[name]
    if all(seconds > QUICK for seconds, _ in kind.commands):
        pytest.skip("no quick command reads it: the slow run does")
    wrong = Counter()
    for seed in range(SAMPLE):
        wrong.update(trial(kind, tmp_path / "case", seed, slowest=QUICK)[0])
    assert not wrong, "\n".join(wrong)


@pytest.mark.slow
@pytest.mark.parametrize("name", NAMES)
def test_many_damaged_files_end_in_one_line(every_kind, name, tmp_path):
    wrong = Counter()
    for seed in range(10_000, 10_000 + MANY):
        wrong.update(trial(every_kind[name], tmp_path / "case", seed)[0])
    assert not wrong, "\n".join(wrong)
