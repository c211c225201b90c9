"""`python -m smash.experiments.studies.certified_open`: how many listed bounds a certificate proves.

Prints a Markdown table: of each problem of the list its cost and bound, the bound of its certificate as the checker
finds it, by which argument, CPU seconds of the writer and of the checker, and the bytes of the file.
"""

from __future__ import annotations

import argparse
from collections.abc import Iterable, Iterator
from pathlib import Path
from time import perf_counter, process_time

from smash.experiments.best_known.files import LIST, read_best_known
from smash.experiments.best_known.standing import Entry, open_instances, options_of
from smash.planners.precedence.certify import certify
from smash.problem.certificate import Certificate, certificate_text, proven_bound
from smash.problem.files.documents import write_text
from smash.problem.files.typed import typed_json
from smash.problem.problem import Problem


def rows(entries: Iterable[Entry], budget: float) -> Iterator[str]:
    """Yield the table, a row as soon as it is there, and a line that counts.

    Args:
        entries: problems of the list.
        budget: seconds of wall time each.
    """
    heads = ("instance", "variant", "cost", "bound", "certified", "by", "writer [CPU s]", "checker [CPU s]", "bytes")
    yield f"| {' | '.join(heads)} |\n{'|---' * len(heads)}|"
    asked = {"cycles": 0, "places": 0}
    proven = dict(asked)
    total = 0
    for entry in entries:
        instance, options = open_instances()[entry.instance], options_of(entry.variant)
        began = process_time()
        text = certificate_text(certify(Problem(instance, options), perf_counter() + budget, cost=entry.cost))
        written = process_time()
        certificate = typed_json(text, Certificate)
        bound = proven_bound(instance, options, certificate)
        seconds = f"{written - began:.1f} | {process_time() - written:.2f}"
        by = "cycles" if certificate.places is None else "places"
        total += 1
        asked[by] += bound == entry.lower_bound
        proven[by] += entry.proven and bound == entry.lower_bound
        listed = f"{entry.instance} | {entry.variant} | {entry.cost} | {entry.lower_bound}"
        yield f"| {listed} | {bound} | {by} | {seconds} | {len(text)} |"
    whole = f"{sum(asked.values())} of {total} bounds certified whole, {asked['cycles']} of them by cycles alone"
    yield f"\n{whole}; {sum(proven.values())} and {proven['cycles']} of those that are optima"


def main() -> None:
    """Print the table of the problems that the command line asks for."""
    parser = argparse.ArgumentParser(prog="python -m smash.experiments.studies.certified_open", description=__doc__)
    parser.add_argument("--instance", default="", metavar="PART", help="part of the instance's name (default: all)")
    parser.add_argument("--budget", type=float, default=60.0, metavar="SECONDS", help="each (default: 60)")
    parser.add_argument("--out", type=Path, metavar="FILE", help="write the table to FILE too")
    asked = parser.parse_args()
    lines = []
    for row in rows((e for e in read_best_known(LIST).sorted() if asked.instance in e.instance), asked.budget):
        print(row, flush=True)
        lines.append(row)
    if asked.out is not None:
        write_text(asked.out, "\n".join(lines) + "\n")


if __name__ == "__main__":
    main()
