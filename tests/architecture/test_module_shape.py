"""A module does one nameable thing and fits in a reader's head."""

from __future__ import annotations

import ast
from pathlib import Path

import pytest

SAYS_NOTHING = {"utils", "util", "helpers", "helper", "manager", "misc", "common", "tools"}


@pytest.fixture(scope="module")
def modules(repository: Path) -> dict[str, str]:
    """Source text of every module of the package, by its path."""
    package = repository / "kirigami_studio"
    found = {path.relative_to(package).as_posix(): path.read_text(encoding="utf-8") for path in package.rglob("*.py")}
    assert len(found) > 40
    return found


def test_that_every_module_says_what_it_is(modules: dict[str, str]) -> None:
    assert [name for name, text in sorted(modules.items()) if not ast.get_docstring(ast.parse(text))] == []
    assert [name for name in modules if Path(name).stem in SAYS_NOTHING] == []


def test_that_every_folder_of_modules_is_a_package(modules: dict[str, str]) -> None:
    folders = {Path(name).parent for name in modules}
    assert [str(folder) for folder in sorted(folders) if (folder / "__init__.py").as_posix() not in modules] == []


def test_that_packaging_does_not_shadow_the_library_of_that_name(repository: Path) -> None:
    assert not (repository / "packaging" / "__init__.py").exists()
