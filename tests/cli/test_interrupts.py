"""Ctrl-C ends a command with 130 and at most one line at any moment, while it is still importing too."""

import signal
import subprocess
import sys

import pytest

INTERRUPTED_AT = """
import os, runpy, signal, sys

name = sys.argv.pop(1)


class Interrupting:
    def find_spec(self, wanted, path=None, target=None):
        if wanted == name:
            sys.meta_path.remove(self)
            os.kill(os.getpid(), signal.SIGINT)


sys.meta_path.insert(0, Interrupting())
sys.argv[0] = "smash"
runpy.run_module("smash", run_name="__main__", alter_sys=True)
"""
"""`python -m smash`, with Ctrl-C where a module is looked for."""
INTERRUPTED_AT_THE_END = """
import atexit, os, runpy, signal, sys

atexit.register(lambda: os.kill(os.getpid(), signal.SIGINT))
sys.argv[0] = "smash"
runpy.run_module("smash", run_name="__main__", alter_sys=True)
"""


def run(code, *words, ignored=False):
    """Run code with Ctrl-C ignored, or as in the foreground, wherever these tests themselves run."""
    manner = signal.SIG_IGN if ignored else signal.SIG_DFL
    words = [sys.executable, "-c", code, *words]
    return subprocess.run(
        words, capture_output=True, text=True, timeout=60, preexec_fn=lambda: signal.signal(signal.SIGINT, manner)
    )


@pytest.mark.parametrize("module", ["smash.cli", "click", "smash.problem.errors", "msgspec", "smash.cli.planners"])
def test_an_interrupt_while_a_module_is_imported_ends_in_one_line(module):
    ended = run(INTERRUPTED_AT, module, "planners")
    assert ended.returncode == 130
    assert ended.stderr.strip() in ("", "smash: interrupted")
    assert ended.stdout == ""


def test_an_interrupt_when_all_is_said_is_no_traceback():
    ended = run(INTERRUPTED_AT_THE_END, "--version")
    assert ended.returncode == 130
    assert ended.stderr == ""
    assert ended.stdout.startswith("smash")


def test_who_is_to_ignore_interrupts_ignores_them():
    ended = run(INTERRUPTED_AT, "click", "--version", ignored=True)
    assert (ended.returncode, ended.stderr) == (0, "")
