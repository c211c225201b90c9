import subprocess
import sys

from smash_baselines.read_problem import read_problem_text

from smash.problem import read_instance
from smash.problem.files.instances import instance_document
from smash.problem.sets.suites import suite_files


def export(*arguments: str) -> subprocess.CompletedProcess[str]:
    return subprocess.run(
        [sys.executable, "-m", "smash", "export-pddl", *arguments], capture_output=True, text=True, check=False
    )


def test_an_exported_problem_reads_back(tmp_path):
    file = suite_files("multi-6")[0]
    done = export(str(file), "--encoding", "conditional", "--out", str(tmp_path / "new"))
    assert done.returncode == 0
    read = read_problem_text((tmp_path / "new" / "problem.pddl").read_text())
    assert instance_document(read.instance) == instance_document(read_instance(file))
    assert "smash-topple-conditional" in (tmp_path / "new" / "domain.pddl").read_text()


def test_what_an_encoding_cannot_say_is_refused_in_one_line(tmp_path):
    file = str(suite_files("multi-6")[0])
    done = export(file, "--encoding", "conditional", "--max-topple", "2", "--out", str(tmp_path))
    assert done.returncode == 6
    assert done.stderr.count("\n") == 1
    (tmp_path / "taken").write_text("")
    done = export(file, "--out", str(tmp_path / "taken" / "below"))
    assert done.returncode == 2
    assert done.stderr.count("\n") == 1
