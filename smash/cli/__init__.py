"""The `smash` command. Each subcommand is a module of its own, imported only when it is asked for."""

from __future__ import annotations

import importlib
import os
import sys
import traceback
import warnings
from typing import NoReturn

import click

from smash.problem.errors import SmashError
from smash.problem.extras import missing_extra
from smash.problem.words import one_line

COMMANDS: dict[str, tuple[str, str]] = {
    "generate": ("smash.cli.generate", "make random benchmark instances (single-goal, multi-goal)"),
    "plan": ("smash.cli.plan", "plan one instance and print or write the plan"),
    "execute": ("smash.cli.execute", "carry a plan out: a robot, simulated, partially grounded"),
    "episodes": ("smash.cli.episodes", "carry out every plan of a sweep"),
    "costs": ("smash.cli.costs", "fit the costs of actions to the durations of episodes"),
    "robot": ("smash.cli.robot", "list the robots, check a robot file, fit its spheres, measure its reach"),
    "draw-scene": ("smash.cli.draw_scene", "draw the table to scale and check the paper's two conditions"),
    "layout": ("smash.cli.layout", "find places and landing strips for an instance, or say why there are none"),
    "topple-map": ("smash.cli.topple_map", "measure where toppled blocks land, and what topples succeed"),
    "validate": ("smash.cli.validate", "judge a plan by the law"),
    "export-pddl": ("smash.cli.export_pddl", "write an instance as PDDL for any planner outside"),
    "planners": ("smash.cli.planners", "list the planners, what they support and what is missing"),
    "certify": ("smash.cli.certify", "write down why no plan is cheaper"),
    "verify": ("smash.cli.verify", "check a plan and its certificate of optimality, without a solver"),
    "import-blocks": (
        "smash.cli.import_blocks",
        "turn blocks-world problems in PDDL into instances, folders into sets",
    ),
    "import-plan": ("smash.cli.import_plan", "turn the plan of a PDDL planner into a plan of the testbed"),
    "export-plan": ("smash.cli.export_plan", "write a plan as the steps of a PDDL planner"),
    "model": ("smash.cli.model", "write the MILP that a planner would solve"),
    "draw": ("smash.cli.draw", "draw a gadget, an instance, or a plan as moving pebbles"),
    "compare": ("smash.cli.compare", "planners on the same instances: coverage, times, costs, proofs, failures"),
    "scaling": ("smash.cli.scaling", "run planners over growing sizes, for curves of time against blocks"),
    "frontier": ("smash.cli.frontier", "show what buffers buy: the exact cost against their number"),
    "sweep": ("smash.cli.sweep", "run an experiment file: planners, instances, budgets, buffers, variants"),
    "reproduce": ("smash.cli.reproduce", "make every table and figure from nothing, with a manifest"),
    "report": ("smash.cli.report", "records as one page to read, and its parts for a paper"),
    "records": ("smash.cli.records", "check the records of a sweep, or write them as tables"),
    "best-known": ("smash.cli.best_known", "keep the list of best known costs of the open instances"),
    "dataset": ("smash.cli.dataset", "write the instance sets with what is proven of them, to cite and load"),
    "prompt": ("smash.cli.prompt", "print a problem for a language model, in words or in PDDL"),
    "score": ("smash.cli.score", "judge plans from elsewhere: legality, gap to the best known cost"),
    "submit-check": ("smash.cli.submit_check", "say whether a plan improves on the best known one"),
}
"""Subcommand -> (module that holds a click command called `command`, one line of help)."""


class LazyGroup(click.Group):
    """A click group that imports a subcommand's module only when that subcommand runs."""

    def list_commands(self, ctx: click.Context) -> list[str]:
        """Return the subcommands, in the order of `COMMANDS`."""
        return list(COMMANDS)

    def get_command(self, ctx: click.Context, cmd_name: str) -> click.Command | None:
        """Import and return one subcommand, or None where there is no such command."""
        if cmd_name not in COMMANDS:
            return None
        command: click.Command = importlib.import_module(COMMANDS[cmd_name][0]).command
        return command

    def format_commands(self, ctx: click.Context, formatter: click.HelpFormatter) -> None:
        """Write the list of subcommands from `COMMANDS`, importing none of them."""
        with formatter.section("Commands"):
            formatter.write_dl([(name, text) for name, (_, text) in COMMANDS.items()])


@click.group(
    cls=LazyGroup,
    context_settings={"help_option_names": ["-h", "--help"], "max_content_width": 100, "show_default": True},
    epilog="Exit codes: 0 done; 2 malformed file or flags; 3 proven infeasible, or a plan that the law refuses; "
    "4 budget spent without a plan; 5 execution failed; 6 unsupported or not installed; "
    "7 the planner crashed or hit its memory limit; 130 interrupted.",
)
@click.version_option(package_name="smash-testbed", prog_name="smash")
def smash() -> None:
    """Compare planners that may topple stacks of blocks with planners that only pick and place.

    \b
    Examples:
      smash generate multi --blocks 9 --buffers 12 --count 20 --seed 1 --out my-set
      smash plan my-set/multi-9-000.json --planner smash --out plan.json
      smash validate my-set/multi-9-000.json plan.json
    """


def fail(message: str, code: int) -> NoReturn:
    """Print one line on stderr and end with `code`."""
    print(f"smash: {one_line(message)}", file=sys.stderr)
    sys.stdout.flush()
    sys.exit(code)


def _prepare_streams() -> None:
    """Have three streams, whatever the caller has closed: no file that is opened later may take the place of one."""
    for number, name in enumerate(("stdin", "stdout", "stderr")):
        try:
            os.fstat(number)
        except OSError:
            os.open(os.devnull, os.O_RDWR)  # takes the lowest number that is free
            setattr(sys, name, open(number, "w" if number else "r", encoding="utf-8", closefd=False))  # noqa: SIM115 - until the end
    for stream in (sys.stdout, sys.stderr):
        if hasattr(stream, "reconfigure"):
            stream.reconfigure(errors="backslashreplace")
    if not sys.warnoptions:
        warnings.simplefilter("ignore")  # a library's words to programmers; `python -W default` shows them


def _fail_unforeseen(error: Exception) -> NoReturn:
    """End with one line on what no command foresaw: a file that the system refuses, a missing extra, or a defect."""
    if isinstance(error, OSError):
        fail(f"{error.filename}: {error.strerror}" if error.filename is not None else error.strerror or str(error), 2)
    missing = missing_extra(error, "this command")
    if missing is not None:
        fail(str(missing), missing.exit_code)
    last = traceback.extract_tb(error.__traceback__)[-1]
    fail(f"defect: {type(error).__name__}: {error} ({os.path.basename(last.filename)}:{last.lineno})", 7)


def main() -> NoReturn:
    """Run the command: errors are one line on stderr and an exit code, never a traceback."""
    _prepare_streams()
    try:
        code = smash.main(standalone_mode=False, prog_name="smash")
        sys.stdout.flush()
    except SmashError as error:
        fail(str(error), error.exit_code)
    except click.exceptions.NoArgsIsHelpError as asked:
        print(asked.format_message())
        sys.exit(0)
    except click.exceptions.Abort:
        fail("interrupted", 130)
    except click.exceptions.Exit as ended:
        sys.exit(ended.exit_code)
    except click.ClickException as error:
        fail(error.format_message(), 2)
    except KeyboardInterrupt:
        fail("interrupted", 130)
    except BrokenPipeError:
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        sys.exit(141)
    except Exception as error:
        _fail_unforeseen(error)
    sys.exit(code if isinstance(code, int) else 0)
