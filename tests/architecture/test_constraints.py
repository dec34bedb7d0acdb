"""What the README tells pip to install is the CPU build of torch, and the index that has it is named."""

from __future__ import annotations

import re
import tomllib
from pathlib import Path

from packaging.requirements import Requirement

ROOT = Path(__file__).parents[2]


def constraints() -> dict[str, Requirement]:
    lines = (ROOT / "packaging" / "constraints-cpu.txt").read_text(encoding="utf-8").splitlines()
    found = [Requirement(line) for line in lines if line and not line.startswith("#")]
    return {one.name: one for one in found}


def test_that_only_the_cpu_build_of_torch_is_admitted_on_linux() -> None:
    torch = constraints()["torch"]
    assert torch.specifier.contains("2.13.0+cpu") and not torch.specifier.contains("2.13.0")
    assert torch.marker is not None and torch.marker.evaluate({"sys_platform": "linux"})
    assert not torch.marker.evaluate({"sys_platform": "darwin"}), "PyPI has no local versions, and no other build"


def test_that_torch_is_pinned_as_the_project_pins_it() -> None:
    needed = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]["dependencies"]
    (pinned,) = (one for one in map(Requirement, needed) if one.name == "torch")
    assert pinned.specifier.contains("2.13.0+cpu") and pinned.specifier.contains("2.13.0")


def test_that_the_readme_names_the_index_that_make_uses() -> None:
    index = re.search(r"^TORCH_INDEX := (\S+)$", (ROOT / "Makefile").read_text(encoding="utf-8"), re.M)
    (line,) = re.findall(r"`.*constraints-cpu\.txt.*`", (ROOT / "README.md").read_text(encoding="utf-8"))
    assert index is not None and f"--extra-index-url {index[1]} " in line
