"""`python -m smash.experiments.studies.records_at_scale`: what reading many records takes.

Makes a results directory of many runs from the records of a small sweep, each run copied for instances of other names,
and has `smash records check`, `smash records export` and `smash report` read it, each in a process of its own. Prints
a Markdown table of seconds of a processor and the most memory; with `--out DIR` it is written to DIR/records.md too.
"""

from __future__ import annotations

import argparse
import json
import os
import sys
import tempfile
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

from smash.problem.files.documents import write_text
from smash.problem.files.instances import instance_from_document
from smash.records.files import RUNS
from smash.records.reading import finished
from smash.records.runs import RunRecord, instance_hash

RUNS_WANTED = 45_000
SWEEP = Path("results/ablation")


@dataclass(frozen=True, slots=True)
class Effort:
    """What a command took: its exit code, seconds of a processor (its own and the system's), and memory [MiB]."""

    exit_code: int
    cpu_seconds: float
    memory_mib: float


def copies(records: Sequence[RunRecord], count: int) -> Iterator[bytes]:
    """Yield `count` lines of `runs.jsonl`: the records again and again, each time of instances of other names."""
    for number in range(count):
        turn, which = divmod(number, len(records))
        document = json.loads(json.dumps(records[which].document))
        if turn:
            name = f"{document['instance']}-{turn}"
            document["instance"] = document["instance_document"]["name"] = name
            document["instance_hash"] = instance_hash(instance_from_document(document["instance_document"]))
            document["key"] = f"{document['key']}-{turn}"
        yield json.dumps(document).encode() + b"\n"


def make_results(sweep: Path, count: int, directory: Path) -> int:
    """Write a results directory of `count` runs made of those of a small sweep; return the bytes of its records.

    Raises:
        MalformedFile: where the sweep has no records, or the directory cannot be written.
    """
    directory.mkdir(parents=True, exist_ok=True)
    file = RUNS.path(directory)
    with file.open("wb") as lines:
        lines.writelines(copies(finished(sweep, RUNS).records, count))
    return file.stat().st_size


def effort(words: Sequence[str]) -> Effort:
    """Run a `smash` command in a process of its own, its words thrown away."""
    process = os.posix_spawn(
        sys.executable,
        [sys.executable, "-m", "smash", *words],
        os.environ,
        file_actions=[(os.POSIX_SPAWN_OPEN, stream, os.devnull, os.O_WRONLY, 0) for stream in (1, 2)],
    )
    _, status, used = os.wait4(process, 0)
    return Effort(os.waitstatus_to_exitcode(status), used.ru_utime + used.ru_stime, used.ru_maxrss / 1024)


def rows(results: Path, size: int, count: int) -> Iterator[str]:
    """Yield the table: a row a command."""
    yield f"{count} runs, {size / 1e6:.0f} MB of records."
    yield ""
    yield "| command | exit | processor [s] | most memory [MiB] |"
    yield "|---|---|---|---|"
    commands = {
        "records check": ["records", "check", str(results)],
        "records export": ["records", "export", str(results), "--out", str(results / "tables")],
        "report": ["report", str(results), "--out", str(results / "report")],
    }
    for name, words in commands.items():
        took = effort(words)
        yield f"| `smash {name}` | {took.exit_code} | {took.cpu_seconds:.1f} | {took.memory_mib:.0f} |"


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--runs", type=int, default=RUNS_WANTED, metavar="N", help="Runs to make and read.")
    parser.add_argument("--sweep", type=Path, default=SWEEP, metavar="DIR", help="The small sweep they are made of.")
    parser.add_argument("--keep", type=Path, metavar="DIR", help="Make the results here, and leave them there.")
    parser.add_argument("--out", type=Path, metavar="DIR", help="Write the table to DIR/records.md too.")
    given = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        results = given.keep or Path(folder, "results")
        size = make_results(given.sweep, given.runs, results)
        lines = []
        for line in rows(results, size, given.runs):
            print(line, flush=True)
            lines.append(line)
    if given.out is not None:
        write_text(given.out / "records.md", "\n".join(lines) + "\n")


if __name__ == "__main__":
    main()
