"""`smash score DATASET ANSWERS`: plans from elsewhere, judged: legality, and the gap to the best known cost."""

from __future__ import annotations

import json
from dataclasses import asdict
from pathlib import Path
from typing import Literal

import click
import msgspec

from smash.problem.errors import MalformedFile
from smash.problem.files.documents import convert, parse_json, read_bytes, write_text


class Answer(msgspec.Struct):
    """A line of ANSWERS; further keys may say whose answer it is."""

    problem: str
    answer: str
    form: Literal["words", "pddl"] = "words"


@click.command("score")
@click.argument("dataset", type=click.Path(path_type=Path, file_okay=False))
@click.argument("answers", type=click.Path(path_type=Path, dir_okay=False))
@click.option("--out", type=click.Path(path_type=Path, dir_okay=False), help="Write each score as a line of JSON here.")
def command(dataset: Path, answers: Path, out: Path | None) -> None:
    """Judge ANSWERS to problems of DATASET, a directory that `smash dataset` wrote.

    ANSWERS has a JSON object a line: `problem`, its name in the data set (`multi-4-000/B12/topple`), and `answer`, the
    text that came back. The plan is the last JSON list of actions in it, else its lines that name actions; with
    `"form": "pddl"`, for answers to `smash prompt --as pddl`, its lines (name argument ...).
    An answer that is no legal plan counts as such, with the reason; its words are no error of this command.

    \b
    Example:
      smash dataset --set multi-4 --instances 2 --out few
      smash score few answers.jsonl --out scores.jsonl
    """
    from smash.experiments.dataset.loading import load_dataset
    from smash.experiments.dataset.scoring import score, summary

    known = load_dataset(dataset).problems
    scores = []
    for number, line in enumerate(read_bytes(answers).splitlines(), start=1):
        where = f"{answers}:{number}"
        given = convert(parse_json(line, where), Answer, where)
        if given.problem not in known:
            raise MalformedFile(where, f"`problem`: {given.problem!r} is not in {dataset}")
        scores.append(score(known[given.problem], given.answer, pddl=given.form == "pddl"))
    if out is not None:
        lines = (json.dumps({**asdict(one), "gap": one.gap}, ensure_ascii=False) + "\n" for one in scores)
        write_text(out, "".join(lines))
    for one in scores:
        if not one.legal:
            click.echo(f"{one.problem}: {one.reason}")
    click.echo("\n".join(summary(scores)))
