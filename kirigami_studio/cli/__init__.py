"""The command line: the engine that the window drives, for scripts, batches and checks.

``kirigami-studio`` without a sub-command opens the window.  Exit codes: 0 done, 1 the work failed (one sentence on
standard error), 2 wrong usage.  Hosts only: commands read inputs, call one stage or the pipeline, and print.
"""

from kirigami_studio.cli.entry import main

__all__ = ["main"]
