"""Compiling once a process: budgets are kept meanwhile, and old machine code is thrown away."""

import os
import threading
from time import perf_counter

import pytest

from smash.planners import compiling
from smash.planners.astar.compiler import Compiler
from smash.planners.precedence.compiler import GraphCompiler

BOTH = pytest.mark.parametrize("compiler", [Compiler, GraphCompiler])


@BOTH
def test_the_machine_code_is_waited_for_no_longer_than_the_deadline(compiler, monkeypatch):
    there = threading.Event()

    def slow():
        there.wait()
        return None

    monkeypatch.setattr(compiler, "_thread", None)
    monkeypatch.setattr(compiler, "_code", None)
    monkeypatch.setattr(compiler, "_compile", slow)
    assert not compiler.started()
    assert compiler.code(0.0) is None
    assert compiler.started()
    there.set()
    compiler._thread.join()


@BOTH
def test_it_is_compiled_once_a_process(compiler, monkeypatch):
    begun, made = [], object()

    def quick():
        begun.append(True)
        compiler._code = made

    monkeypatch.setattr(compiler, "_thread", None)
    monkeypatch.setattr(compiler, "_code", None)
    monkeypatch.setattr(compiler, "_compile", quick)
    assert compiler.code(perf_counter() + 110) is compiler.code(0.0) is made
    assert begun == [True]


def test_machine_code_older_than_a_source_is_dropped(tmp_path):
    cache = tmp_path / "__pycache__"
    cache.mkdir()
    for name, age in (("source.py", 100), ("__pycache__/old.nbi", 50), ("__pycache__/new.nbi", 150)):
        (tmp_path / name).touch()
        os.utime(tmp_path / name, (age, age))
    source = type("Module", (), {"__file__": str(tmp_path / "source.py")})
    compiling.drop_stale_cache([source])
    assert [file.name for file in cache.iterdir()] == ["new.nbi"]
