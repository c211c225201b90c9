"""`smash import-blocks PROBLEM.pddl|FOLDER…`: classical blocks-world problems as instances, folders as sets."""

from __future__ import annotations

import sys
from collections import Counter
from collections.abc import Iterator, Sequence
from pathlib import Path

import click

from smash.cli import fail
from smash.problem.blocksworld.folders import Found, Importer, found_files
from smash.problem.blocksworld.placing import Placed, placed
from smash.problem.blocksworld.problem import BlocksProblem
from smash.problem.blocksworld.world import MOVE
from smash.problem.errors import Infeasible, MalformedFile, SmashError, Unsupported
from smash.problem.files.instances import write_instance
from smash.problem.sets.generators import MOST
from smash.problem.words import counted, one_line

FAILURES = ((MalformedFile, "malformed"), (Infeasible, "infeasible"), (Unsupported, "unsupported"))


@click.command("import-blocks")
@click.argument("problems", nargs=-1, required=True, type=click.Path(path_type=Path), metavar="PROBLEM.pddl|FOLDER…")
@click.option(
    "--domain",
    type=click.Path(path_type=Path, dir_okay=False),
    metavar="DOMAIN.pddl",
    help="Read predicates and actions by what this domain's actions do, not by their usual names.",
)
@click.option("--stacks", type=click.IntRange(1, MOST), metavar="N", help="Stacks (default: as many as blocks).")
@click.option("--buffers", type=click.IntRange(0, MOST), default=0, show_default=True, metavar="N", help="Buffers.")
@click.option("--name", metavar="NAME", help="Name of the instance, where it is one (default: the problem's name).")
@click.option(
    "--out",
    type=click.Path(path_type=Path),
    required=True,
    help="Instance file to write; a directory for a folder or several files.",
)
def command(
    problems: tuple[Path, ...], domain: Path | None, stacks: int | None, buffers: int, name: str | None, out: Path
) -> None:
    """Turn blocks-world problems in PDDL into instances; a folder, or several files, into a set.

    Without topple the costs of a domain with a hand (pick-up, put-down, stack, unstack) are the classical plan
    lengths; a move of a domain without one costs 2 here, a pick and a place.

    Towers go in the order of :init, the tallest first, onto stacks, then onto buffers. `--stacks 4 --buffers 12` fits
    the default scene of `smash execute`.

    Of a folder each file becomes the instance that is called like it (`sub-file` in a sub-folder). A `domain.pddl`
    beside the problems, or the domain that they name, serves as --domain. A file that cannot be read is one line, the
    rest goes on, and the exit code is 2 at the end.

    \b
    Examples:
      smash import-blocks probBLOCKS-16-1.pddl --out blocks-16-1.json
      smash import-blocks mystery/p01.pddl --domain mystery/domain.pddl --stacks 4 --buffers 12 --out p01.json
      smash import-blocks ipc2000/ --out my-set
      smash compare my-set --planner smash --planner greedy --out results
    """
    found = found_files(problems)
    importer = Importer(domain, beside=any(path.is_dir() for path in problems) or len(problems) > 1)
    if domain is not None:
        importer.recognizer(domain)
    if len(problems) == 1 and not problems[0].is_dir() and not out.is_dir():
        _import_one(importer.problem(found[0]), stacks, buffers, name, out)
        return
    if name is not None:
        raise click.BadParameter("several instances are called after their files", param_hint="--name")
    _import_all(importer, found, stacks, buffers, out)


def _import_one(problem: BlocksProblem, stacks: int | None, buffers: int, name: str | None, out: Path) -> None:
    made = placed(problem, stacks, buffers, name)
    write_instance(made.instance, out)
    _say(problem, made)
    click.echo(f"{counted(len(made.instance.blocks), 'block')} in {out}")


def _say(problem: BlocksProblem, made: Placed) -> None:
    """Say how a problem was read, and where a tower stands on a buffer."""
    click.echo(how_read(problem))
    for warning in _warnings(problem, made):
        click.echo(one_line(f"smash: {problem.where}: {warning}"), err=True)


def how_read(problem: BlocksProblem) -> str:
    """Return in one line how a problem was read."""
    reading = problem.reading
    if reading.by_name:
        how = "by the usual names"
        way = "with a hand" if reading.hand else "no hand is in :init, so that it reads as moves: one move costs 2 here"
        return f"read {how}: {way}"
    actions = ", ".join(dict.fromkeys(template.action for template in reading.templates))
    way = f"a hand ({actions})" if reading.hand else f"moves without a hand ({actions}): one move costs 2 here"
    both = dict.fromkeys(template.action for template in reading.templates if reading.hand and template.kind == MOVE)
    if both:
        way += f", {', '.join(both)} a pick and a place at once, which costs 2 here"
    return f"recognised by its domain: {way}; {reading.said()}"


def _warnings(problem: BlocksProblem, made: Placed) -> Iterator[str]:
    if problem.unknown:
        shown = ", ".join(problem.unknown[:6]) + (", …" if len(problem.unknown) > 6 else "")
        yield f"facts of {shown} are passed over; whether actions need them is known with --domain alone"
    if problem.costs_differ:
        yield "its actions have costs of their own; here every action counts 1"
    if made.on_buffers:
        yield f"{counted(made.on_buffers, 'tower')} on buffers: more towers than stacks"


def _import_all(importer: Importer, found: Sequence[Found], stacks: int | None, buffers: int, out: Path) -> None:
    """Import what can be, then say what cannot and why."""
    try:
        out.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise MalformedFile(str(out), f"cannot be made: {error.strerror}") from None
    failures: Counter[str] = Counter()
    said: set[str] = set()
    written: set[str] = set()
    for one in _shown(found):
        if importer.is_domain(one.path):
            continue
        try:
            problem = importer.problem(one)
            made = placed(problem, stacks, buffers, one.name)
            write_instance(made.instance, out / f"{one.name}.json")
        except SmashError as error:
            failures[_kind(error)] += 1
            line = str(error) if str(one.path) in str(error) else f"{one.path}: {error}"
            click.echo(f"smash: {' '.join(line.split())}", err=True)
            continue
        written.add(f"{one.name}.json")
        for line in (how_read(problem), *_warnings(problem, made)):
            if line not in said:
                click.echo(f"{one.name}: {line}" if said else line)
                said.add(line)
    _end(written, failures, out)


def _kind(error: SmashError) -> str:
    return next((kind for family, kind in FAILURES if isinstance(error, family)), "without a place for every tower")


def _end(written: set[str], failures: Counter[str], out: Path) -> None:
    if written:
        click.echo(f"{counted(len(written), 'instance')} in {out}")
    others = sorted(file.name for file in out.glob("*.json") if file.name not in written)
    if written and others:
        more = f" and {len(others) - 1} more" if len(others) > 1 else ""
        click.echo(f"{out} holds other files too, which belong to the set now: {others[0]}{more}", err=True)
    if failures:
        listed = ", ".join(f"{count} {kind}" for kind, count in failures.most_common())
        fail(f"{counted(sum(failures.values()), 'file')} not imported: {listed}", 2)
    if not written:
        fail("no PDDL problem was found, domains alone", 2)


def _shown(found: Sequence[Found]) -> Iterator[Found]:
    """Yield the files, and show how far a long folder is, where someone is watching."""
    if not sys.stderr.isatty():
        yield from found
        return
    with click.progressbar(found, label="importing", file=sys.stderr) as bar:
        yield from bar
