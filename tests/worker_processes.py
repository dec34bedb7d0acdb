"""The worker processes of a program, to be killed by tests."""

from __future__ import annotations

from pathlib import Path


def workers_of(program: int) -> list[int]:
    """Process numbers of the workers that polish designs for a process; none where there is no /proc."""
    found = []
    for entry in Path("/proc").iterdir() if Path("/proc").is_dir() else ():
        if entry.name.isdigit():
            try:
                parent = int((entry / "stat").read_text().rpartition(")")[2].split()[1])
                if parent == program and b"pipeline.worker" in (entry / "cmdline").read_bytes():
                    found.append(int(entry.name))
            except (OSError, IndexError, ValueError):
                continue
    return found
