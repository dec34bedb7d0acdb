"""Programs of other people that read our files; ``make consumers`` installs them into an environment of their own."""

from __future__ import annotations

import json
import subprocess
from collections.abc import Callable, Sequence
from importlib.util import find_spec
from pathlib import Path
from sys import executable
from typing import Any

import pytest

Planner = Callable[[Sequence[Path]], list[dict[str, Any]]]


@pytest.fixture(scope="session")
def meerk40t_plans(repository: Path) -> Planner:
    """Return a function: files -> what MeerK40t found and planned for each."""
    own = repository / ".venv-consumers" / "bin" / "python"
    python = executable if find_spec("meerk40t") else own
    if not Path(python).exists():
        pytest.skip("MeerK40t is not installed: make consumers")
    script = Path(__file__).with_name("meerk40t_plan.py")

    def plans(paths: Sequence[Path]) -> list[dict[str, Any]]:
        done = subprocess.run(
            [str(python), str(script), *map(str, paths)], capture_output=True, text=True, check=True, timeout=300
        )
        found = json.loads(done.stdout.splitlines()[-1])
        return [found[str(path)] for path in paths]

    return plans
