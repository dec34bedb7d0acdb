"""The command line: the engine that the window drives, for scripts, batches and checks.

``kirigami-studio`` without a sub-command opens the window.  Exit codes: 0 done, 1 the work failed (one sentence on
standard error), 2 wrong usage, 130 stopped by Ctrl+C.  Sub-commands read inputs, call one stage or the pipeline, and
print.
"""

from __future__ import annotations

import argparse
import os
import signal
import sys
from collections.abc import Sequence
from pathlib import Path

from kirigami_studio.cli.console import STREAM, sentences_to
from kirigami_studio.cli.parser import build_parser, open_window
from kirigami_studio.foundation.errors import KirigamiError, UsageError
from kirigami_studio.foundation.garbage import collect_seldom
from kirigami_studio.foundation.log import quiet_libraries
from kirigami_studio.pipeline.worker import WORKER_FLAG, serve

#: Exit code of programs that Ctrl+C ends, as shells count it: 128 and the number of the signal.
INTERRUPTED = 128 + signal.SIGINT


def main(argv: Sequence[str] | None = None) -> int:
    """Run one sub-command; return the exit code (argparse itself exits with 2)."""
    _replace_missing_streams()
    if argv is None:
        quiet_libraries()
    words = list(sys.argv[1:] if argv is None else argv)
    if words == [WORKER_FLAG]:
        return serve()
    # A file manager starts the program with the name of a file alone; no sub-command has a dot.
    shown = words if len(words) == 1 and Path(words[0]).suffix and Path(words[0]).is_file() else []
    arguments = build_parser().parse_args([] if shown else words)
    arguments.shown = shown
    if argv is None and arguments.run is not open_window:
        collect_seldom()
    try:
        with sentences_to(None if getattr(arguments, "quiet", False) else "stdout"):
            code = _run(arguments)
        sys.stdout.flush()
        return code
    except UsageError as error:
        return _fail(error, 2)
    except KirigamiError as error:
        return _fail(error, 1)
    except KeyboardInterrupt:
        return _fail(KirigamiError("cli.interrupted"), INTERRUPTED)
    except MemoryError:
        return _fail(KirigamiError("cli.out_of_memory"), 1)
    except BrokenPipeError:
        # The reader of our output went away (``| head``): not an error, but nothing more may be printed.
        _drop_output()
        return 0
    except OSError as error:
        # Files that the packages write have problems of their own; what is left is mostly standard output.
        _drop_output()
        reason = error.strerror or str(error)
        if error.filename:
            return _fail(KirigamiError("cli.file_not_usable", path=error.filename, reason=reason), 1)
        return _fail(KirigamiError("cli.output_not_usable", reason=reason), 1)


def _run(arguments: argparse.Namespace) -> int:
    """Run the command, its input in a file where that is standard input."""
    if not any(value == STREAM or (isinstance(value, list) and STREAM in value) for value in vars(arguments).values()):
        return int(arguments.run(arguments))
    from kirigami_studio.cli.inputs import standard_input

    with standard_input(arguments):
        return int(arguments.run(arguments))


def _replace_missing_streams() -> None:
    """Give a program without a console, as Windows starts it, streams that drop all output."""
    for name in ("stdout", "stderr"):
        if getattr(sys, name) is None:
            setattr(sys, name, Path(os.devnull).open("w", encoding="utf-8"))  # noqa: SIM115 - as long as the program


def _drop_output() -> None:
    """Discard what is still buffered, so that the interpreter does not fail on it when it ends."""
    os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())


def _fail(problem: KirigamiError, code: int) -> int:
    sys.stderr.write(f"kirigami-studio: {problem}\n")
    return code
