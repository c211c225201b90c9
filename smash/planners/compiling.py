"""Functions that run interpreted or compiled by numba: one source, and numba imported only where it pays.

The compiled ones are copies whose calls to each other lead to compiled ones. Their machine code is cached
beside the source, so that it is made once a machine (`python -m smash.planners.warm`).
"""

from __future__ import annotations

import threading
import types
from collections.abc import Sequence
from pathlib import Path
from time import perf_counter
from typing import Any, ClassVar


def compiled_functions(modules: Sequence[Any]) -> dict[str, Any]:
    """Return compiled copies of the functions of `modules` by name; each is compiled, or loaded, when first called."""
    from numba import njit

    drop_stale_cache(modules)
    own = {module.__name__ for module in modules}
    scope: dict[str, Any] = {}
    for module in modules:
        scope.update({name: value for name, value in vars(module).items() if not name.startswith("__")})
    for name, function in list(scope.items()):
        if isinstance(function, types.FunctionType) and function.__module__ in own:
            copy = types.FunctionType(function.__code__, scope, name, function.__defaults__)
            copy.__module__ = function.__module__
            copy.__qualname__ = function.__qualname__
            scope[name] = njit(cache=True, nogil=True)(copy)
    return scope


def drop_stale_cache(modules: Sequence[Any]) -> None:
    """Delete machine code older than any of the sources: numba looks only at the file of the function itself."""
    sources = [Path(module.__file__) for module in modules if module.__file__]
    newest = max(source.stat().st_mtime for source in sources)
    for index in (sources[0].parent / "__pycache__").glob("*.nbi"):
        if index.stat().st_mtime < newest:
            index.unlink(missing_ok=True)


class CompiledOnce:
    """Functions that are compiled once a process, in a thread: the first time ever it takes long, and budgets are kept.

    A subclass says in `_compile` how they are made, and calls each once.
    """

    _thread: ClassVar[threading.Thread | None] = None
    _code: ClassVar[Any] = None

    @classmethod
    def code(cls, deadline: float) -> Any:
        """Return the compiled functions, ready to run, or None where `deadline` passes before they are."""
        if cls._thread is None:
            cls._thread = threading.Thread(target=cls._compile, daemon=True)
            cls._thread.start()
        cls._thread.join(min(threading.TIMEOUT_MAX, max(0.0, deadline - perf_counter())))
        return cls._code

    @classmethod
    def started(cls) -> bool:
        """Return whether compiling has begun."""
        return cls._thread is not None

    @classmethod
    def warm_up(cls) -> None:
        """Compile now, so that the machine code is cached."""
        cls._compile()

    @classmethod
    def _compile(cls) -> None:
        """Set `_code`, once every function has been called."""
        raise NotImplementedError
