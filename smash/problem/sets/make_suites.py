"""`python -m smash.problem.sets.make_suites`: write the committed sets again, byte for byte."""

from __future__ import annotations

from smash.problem.files.instances import write_instance
from smash.problem.sets.suites import SUITES, generated_names, made_again


def main() -> None:
    """Write every committed set."""
    for name in generated_names():
        directory = SUITES / name
        directory.mkdir(parents=True, exist_ok=True)
        for instance in made_again(name):
            write_instance(instance, directory / f"{instance.name}.json")


if __name__ == "__main__":
    main()
