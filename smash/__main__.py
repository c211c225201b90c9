"""The `smash` command, also as `python -m smash`: Ctrl-C ends it with exit code 130 at any moment, imports included.

Nothing is imported before `main` is called: until then Ctrl-C is Python's own.
"""


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
    """Make Ctrl-C wait for the end of an import: one that is cut short tells of a missing package, or hides it."""
    import signal

    if signal.getsignal(signal.SIGINT) is signal.default_int_handler:  # else it is ignored, as in the background
        signal.signal(signal.SIGALRM, _interrupt)
        signal.signal(signal.SIGINT, _interrupt)


def _interrupt(number: int, frame: object) -> None:
    """Raise `KeyboardInterrupt`, after the import that is under way where there is one.

    Raises:
        KeyboardInterrupt: where nothing is being imported.
    """
    import signal

    while frame is not None:
        if frame.f_code.co_filename.startswith("<frozen importlib"):  # type: ignore[attr-defined]
            signal.setitimer(signal.ITIMER_REAL, 0.005)
            return
        frame = frame.f_back  # type: ignore[attr-defined]
    raise KeyboardInterrupt


def _end() -> None:
    """Have Ctrl-C end the process at once: all is done but what Python itself does at its end."""
    import signal

    if signal.getsignal(signal.SIGINT) is _interrupt:
        signal.signal(signal.SIGINT, _leave)
        signal.signal(signal.SIGALRM, signal.SIG_IGN)


def _leave(*_: object) -> None:
    import os

    os._exit(130)


if __name__ == "__main__":
    main()
