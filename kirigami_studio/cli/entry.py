"""Parse, dispatch, and turn every expected failure into one sentence and an exit code."""

from __future__ import annotations

import os
import sys
from collections.abc import Sequence

from kirigami_studio.cli.parser import build_parser
from kirigami_studio.foundation.errors import KirigamiError, UsageError


def main(argv: Sequence[str] | None = None) -> int:
    """Run one command; returns the exit code (argparse itself exits with 2 on unknown words)."""
    arguments = build_parser().parse_args(argv)
    try:
        return int(arguments.run(arguments))
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
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        return 0


def _fail(message: object, code: int) -> int:
    sys.stderr.write(f"kirigami-studio: {message}\n")
    return code
