"""A module is a topic that a newcomer would look up: it says what it is, is no fragment of its only importer, and
stands in no circle of imports.
"""

from __future__ import annotations

import ast
from functools import cache
from graphlib import CycleError, TopologicalSorter
from pathlib import Path

import pytest

pytestmark = pytest.mark.rule

#: Below so many lines a module with a single importer belongs into it, unless there is a reason.
FRAGMENT_LINES = 60
#: Small modules with one importer (or none) that stand alone all the same, and why.
STANDS_ALONE = {
    "__main__.py": "python -m needs it",
    "generator/libraries.py": "it is read before torch is imported, by a thread that must not import it",
    "gui/window/help_commands.py": "every menu has its module",
}
#: The composition root, and who may import it; research plays sessions in the real window.
ROOT, ABOVE_ROOT = "gui/window/main_window.py", ("gui/window/application.py", "lab/")
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


def dotted(name: str) -> str:
    """Dotted name of a module by its path."""
    return "kirigami_studio." + name.removesuffix(".py").removesuffix("/__init__").replace("/", ".")


def circle(modules: dict[str, str]) -> list[str]:
    """Modules that import each other, also in functions and for type checkers; the first circle found, if any."""
    names = {dotted(name): name for name in modules}
    graph = {name: {names[one] for one in imported_by(text) & set(names)} - {name} for name, text in modules.items()}
    try:
        TopologicalSorter(graph).prepare()
    except CycleError as error:
        found: list[str] = error.args[1]
        return sorted(set(found))
    return []


def importers_of_root(modules: dict[str, str]) -> list[str]:
    """Modules below the composition root that import it."""
    importing = [name for name, text in modules.items() if dotted(ROOT) in imported_by(text)]
    return sorted(name for name in importing if not name.startswith(ABOVE_ROOT))


def fragments(modules: dict[str, str]) -> list[str]:
    """Modules below 60 lines that at most one other module imports; packages' own files are none."""
    imports = {name: imported_by(text) for name, text in modules.items()}
    found = []
    for name, text in modules.items():
        importers = [other for other, wanted in imports.items() if other != name and dotted(name) in wanted]
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


def test_that_no_modules_import_each_other(modules: dict[str, str]) -> None:
    assert circle(modules) == []


@pytest.mark.parametrize(
    "planted",
    [
        "from kirigami_studio.gui.window.presenters import Presenters\n",
        "def show():\n    from kirigami_studio.gui.window.presenters import Presenters\n",
        "if TYPE_CHECKING:\n    from kirigami_studio.gui.window import presenters\n",
    ],
    ids=["at the top", "in a function", "for type checkers"],
)
def test_that_a_planted_circle_is_found(modules: dict[str, str], planted: str) -> None:
    name = "gui/window/open_dialogs.py"
    assert circle(modules | {name: f"{modules[name]}\n{planted}"}) == [name, "gui/window/presenters.py"]


def test_that_no_module_below_the_composition_root_knows_the_window(modules: dict[str, str]) -> None:
    assert importers_of_root(modules) == []


@pytest.mark.parametrize("name", ["gui/window/view_commands.py", "gui/window/tour.py", "gui/stage/layout_view.py"])
def test_that_a_planted_use_of_the_window_is_found(modules: dict[str, str], name: str) -> None:
    planted = "if TYPE_CHECKING:\n    from kirigami_studio.gui.window.main_window import MainWindow\n"
    assert importers_of_root(modules | {name: f"{modules.get(name, '')}\n{planted}"}) == [name]


def test_that_every_module_says_what_it_is(modules: dict[str, str]) -> None:
    assert [name for name, text in sorted(modules.items()) if not ast.get_docstring(ast.parse(text))] == []
    assert [name for name in modules if Path(name).stem in SAYS_NOTHING] == []


def test_that_every_folder_of_modules_is_a_package(modules: dict[str, str]) -> None:
    folders = {Path(name).parent for name in modules}
    assert [str(folder) for folder in sorted(folders) if (folder / "__init__.py").as_posix() not in modules] == []


def test_that_packaging_does_not_shadow_the_library_of_that_name(repository: Path) -> None:
    assert not (repository / "packaging" / "__init__.py").exists()
