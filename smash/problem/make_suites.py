"""`python -m smash.problem.make_suites`: write the committed benchmark sets again, byte for byte."""

from __future__ import annotations

from smash.problem.files import write_instance
from smash.problem.suites import PAPER_SUITES, SUITES, paper_suite


def main() -> None:
    """Write every committed benchmark set."""
    for name in PAPER_SUITES:
        directory = SUITES / name
        directory.mkdir(parents=True, exist_ok=True)
        for instance in paper_suite(name):
            write_instance(instance, directory / f"{instance.name}.json")


if __name__ == "__main__":
    main()
