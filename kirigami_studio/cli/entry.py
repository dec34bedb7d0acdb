"""Parse, dispatch, and turn every expected failure into one sentence and an exit code."""

from __future__ import annotations

import os
import sys
from collections.abc import Sequence
from pathlib import Path

from kirigami_studio.cli.parser import build_parser
from kirigami_studio.foundation.errors import KirigamiError, UsageError

#: What a frozen program is started with to be a polishing worker, see ``pipeline.pool``.
WORKER_FLAG = "--worker"


def main(argv: Sequence[str] | None = None) -> int:
    """Run one command; returns the exit code (argparse itself exits with 2 on unknown words)."""
    words = list(sys.argv[1:] if argv is None else argv)
    if words == [WORKER_FLAG]:
        from kirigami_studio.pipeline.worker import serve

        return serve()
    # A file manager opens a file with the program by its name alone; no command has a dot.
    shown = words if len(words) == 1 and Path(words[0]).suffix and Path(words[0]).is_file() else []
    arguments = build_parser().parse_args([] if shown else words)
    arguments.shown = shown
    try:
        code = int(arguments.run(arguments))
        sys.stdout.flush()
        return code
    except UsageError as error:
        return _fail(error, 2)
    except KirigamiError as error:
        return _fail(error, 1)
    except KeyboardInterrupt:
        return _fail("Stopped; nothing was left half written.", 1)
    except MemoryError:
        return _fail("There is not enough memory for this request; ask for fewer or smaller inputs.", 1)
    except BrokenPipeError:
        # The reader of our output went away (``| head``): not an error, but nothing more may be printed.
        _drop_output()
        return 0
    except OSError as error:
        # Files that the rooms write answer with sentences of their own; what is left is mostly standard output.
        _drop_output()
        return _fail(f"Cannot read or write {error.filename or 'the output'}: {error.strerror or error}.", 1)


def _drop_output() -> None:
    """Send what is still buffered nowhere, so that the interpreter does not stumble over it when it ends."""
    os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())


def _fail(message: object, code: int) -> int:
    sys.stderr.write(f"kirigami-studio: {message}\n")
    return code
