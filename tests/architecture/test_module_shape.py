"""A module is a topic that a newcomer would look up: it says what it is, and is no fragment of its only importer."""

from __future__ import annotations

import ast
from functools import cache
from pathlib import Path

import pytest

#: Below so many lines a module with a single importer belongs into it, unless there is a reason.
FRAGMENT_LINES = 60
#: Small modules with one importer (or none) that stand alone all the same, and why.
STANDS_ALONE = {
    "__main__.py": "python -m needs it",
    "generator/libraries.py": "it is read before torch is imported, by a thread that must not import it",
    "gui/window/help_commands.py": "every menu has its module",
}
SAYS_NOTHING = {"utils", "util", "helpers", "helper", "manager", "misc", "common", "tools"}


@pytest.fixture(scope="module")
def modules(repository: Path) -> dict[str, str]:
    """Source text of every module of the package, by its path."""
    package = repository / "kirigami_studio"
    found = {path.relative_to(package).as_posix(): path.read_text(encoding="utf-8") for path in package.rglob("*.py")}
    assert len(found) > 40
    return found


@cache
def imported_by(text: str) -> set[str]:
    """Dotted names that a module imports: modules, and names that may be modules; each text is parsed once."""
    found: set[str] = set()
    for node in ast.walk(ast.parse(text)):
        if isinstance(node, ast.Import):
            found |= {alias.name for alias in node.names}
        elif isinstance(node, ast.ImportFrom) and node.module is not None:
            found |= {node.module} | {f"{node.module}.{alias.name}" for alias in node.names}
    return found


def fragments(modules: dict[str, str]) -> list[str]:
    """Modules below 60 lines that at most one other module imports; packages' own files are none."""
    imports = {name: imported_by(text) for name, text in modules.items()}
    found = []
    for name, text in modules.items():
        dotted = "kirigami_studio." + name.removesuffix(".py").replace("/", ".")
        importers = [other for other, wanted in imports.items() if other != name and dotted in wanted]
        if not name.endswith("__init__.py") and len(text.splitlines()) < FRAGMENT_LINES and len(importers) <= 1:
            found.append(name)
    return sorted(found)


def test_that_no_module_is_a_fragment_of_its_only_importer(modules: dict[str, str]) -> None:
    assert fragments(modules) == sorted(STANDS_ALONE)


def test_that_a_planted_fragment_is_found(modules: dict[str, str]) -> None:
    planted = {
        "polish/scrap.py": "HALF = 0.5\n",
        "polish/user.py": "from kirigami_studio.polish.scrap import HALF\n" * 60,
    }
    assert set(fragments(modules | planted)) - set(fragments(modules)) == {"polish/scrap.py"}


def test_that_every_module_says_what_it_is(modules: dict[str, str]) -> None:
    assert [name for name, text in sorted(modules.items()) if not ast.get_docstring(ast.parse(text))] == []
    assert [name for name in modules if Path(name).stem in SAYS_NOTHING] == []


def test_that_every_folder_of_modules_is_a_package(modules: dict[str, str]) -> None:
    folders = {Path(name).parent for name in modules}
    assert [str(folder) for folder in sorted(folders) if (folder / "__init__.py").as_posix() not in modules] == []


def test_that_packaging_does_not_shadow_the_library_of_that_name(repository: Path) -> None:
    assert not (repository / "packaging" / "__init__.py").exists()
