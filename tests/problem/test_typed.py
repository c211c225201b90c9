"""Typed data from any thread."""

import re
import subprocess
import sys
from pathlib import Path

import smash

RACE = """
import sys, threading
from smash.forecast.model import default_model
sys.setswitchinterval(1e-6)
together = threading.Barrier(4)
def read():
    together.wait()
    default_model.__wrapped__()
threads = [threading.Thread(target=read) for _ in range(4)]
for thread in threads: thread.start()
for thread in threads: thread.join()
"""
"""Four threads that decode a type which nobody has decoded yet: without a lock every third such process dies."""
DECODES = re.compile(r"msgspec\.convert\(|json\.decode\(|(toml|yaml|msgpack)\.decode\(")


def test_threads_may_decode_the_same_type_at_once():
    for _ in range(3):
        ended = subprocess.run([sys.executable, "-c", RACE], capture_output=True, text=True, timeout=100)
        assert (ended.returncode, ended.stderr) == (0, "")


def test_nobody_decodes_types_past_the_lock():
    home = Path(smash.__file__).parent
    past = [str(file) for file in home.rglob("*.py") if file.name != "typed.py" and DECODES.search(file.read_text())]
    assert not past
