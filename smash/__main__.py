"""The `smash` command, also as `python -m smash`: Ctrl-C ends it with exit code 130 at any moment, imports included.

Nothing is imported before `main` is called: until then Ctrl-C is Python's own.
"""

TYPE_CHECKING = False

if TYPE_CHECKING:
    from types import FrameType
    from typing import NoReturn


def main() -> None:
    """Run the command.

    Raises:
        SystemExit: always, with the exit code.
    """
    try:
        _watch()
        from smash.cli import main as command

        command()
    except KeyboardInterrupt:
        _leave()
    finally:
        _end()


def _watch() -> None:
    import signal

    if signal.getsignal(signal.SIGINT) is signal.default_int_handler:  # else it is ignored, as in the background
        signal.signal(signal.SIGINT, _interrupt)


def _interrupt(number: int, frame: "FrameType | None") -> None:
    """Raise `KeyboardInterrupt`, where something is being imported after that.

    An import that is cut short hides it, or tells of a package that is missing.

    Raises:
        KeyboardInterrupt: at once where nothing is being imported.
    """
    import sys

    importer, importing = None, False
    while frame is not None:
        above = importing
        importing = frame.f_code.co_filename.startswith("<frozen importlib")
        importer = frame if above and not importing else importer
        frame = frame.f_back
    if importer is None:
        raise KeyboardInterrupt
    importer.f_trace = _stop  # called at the next line of who began to import
    sys.settrace(lambda *_: None)


def _stop(*_: object) -> "NoReturn":
    raise KeyboardInterrupt


def _end() -> None:
    """Have Ctrl-C end the process at once: all is done but what Python itself does at its end."""
    import signal

    if signal.getsignal(signal.SIGINT) is _interrupt:
        signal.signal(signal.SIGINT, _leave)


def _leave(*_: object) -> None:
    import os

    os._exit(130)


if __name__ == "__main__":
    main()
