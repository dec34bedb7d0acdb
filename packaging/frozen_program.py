"""Start of a frozen program: the command line, a polishing worker, or a script.

``kirigami-studio -m session.py --out out`` runs a script as the interpreter does; ``packaging/smoke.py`` plays a
session of the window so where no Python is installed.
"""

from __future__ import annotations

import multiprocessing
import os
import runpy
import sys
import warnings


def main() -> int:
    """Run what the words ask for; return the exit code."""
    # The libraries of the bundle are for this process; xdg-open and its like must find those of the system.
    # Loaders read the variable when a process starts, so ours are still found.
    if sys.platform.startswith("linux"):
        own = os.environ.pop("LD_LIBRARY_PATH_ORIG", None)
        os.environ.pop("LD_LIBRARY_PATH", None)
        if own is not None:
            os.environ["LD_LIBRARY_PATH"] = own
    # A bundle has no sources, and torch would say so of each of its functions for TorchScript, which nobody uses here.
    warnings.filterwarnings("ignore", message="Unable to retrieve source for @torch.jit._overload")
    multiprocessing.freeze_support()  # processes that share work
    if sys.argv[1:2] == ["-m"] and sys.argv[2:] and sys.argv[2].endswith(".py"):
        del sys.argv[:2]
        runpy.run_path(sys.argv[0], run_name="__main__")
        return 0
    from kirigami_studio.cli import main as command_line

    return command_line()


if __name__ == "__main__":
    sys.exit(main())
