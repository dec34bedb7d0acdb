"""A new choice costs three files: the settings, what makes use of it, and a test or document.

The rest is made of the setting: its check, its option, its keyword, its entry in project files, its place in the Undo
menu and its field in the window.
"""

from __future__ import annotations

import json
import os
import shutil
import subprocess
import sys
from dataclasses import dataclass
from pathlib import Path
from typing import Any, get_type_hints

import pytest

from kirigami_studio.fabricate.options import CutOptions
from kirigami_studio.foundation.sentences import SENTENCES
from kirigami_studio.foundation.settings import settings_of
from kirigami_studio.project.edits import SettingsChange
from kirigami_studio.settings.design import DesignChange, DesignChoices, DesignSettings
from kirigami_studio.settings.fabrication import FabricationChange, FabricationSettings, OptionsChange

pytestmark = pytest.mark.rule


@dataclass(frozen=True)
class Planted:
    """A choice that is planted: the command that has its option, and where its setting and its use are written."""

    command: str
    settings: str
    before: str  #: the setting is written before this line
    use: str
    used: tuple[str, str]  #: a line of what makes use of it, before and after


#: The setting; in half of the faults its field says nothing of itself.
SETTING = """    rings: int = field(
        default=0,
        metadata=Setting(
            about="Rings around the sheet ({least} to {most}).", most=9, least=0, label="Rin&gs", option="--rings"
        ).metadata,
    )
"""
SILENT = "    rings: int = 0\n"
SEARCH = Planted(
    "design",
    "settings/design.py",
    "    start: StartShape = field(",
    "pipeline/request.py",
    ("    if request.grid_chosen:\n", '    known["rings"] = str(request.rings)\n    if request.grid_chosen:\n'),
)
SHEET = Planted(
    "export",
    "settings/fabrication.py",
    "    own: Material | None = field(",
    "studio/making.py",
    ("markers=request.settings.markers", "markers=request.settings.markers or request.settings.rings > 0"),
)
#: Prints what a user of the copy finds of the choice.
PROGRAM = """
import contextlib, inspect, io, json, sys
from dataclasses import replace
from PySide6.QtWidgets import QApplication, QSpinBox
import kirigami_studio as ks
from kirigami_studio.cli import main
from kirigami_studio.foundation.errors import KirigamiError
from kirigami_studio.gui.make.more_options import MoreOptions
from kirigami_studio.gui.run.settings_panel import SettingsPanel
from kirigami_studio.project import codec, edits
from kirigami_studio.project.document import Document

command, found, said = sys.argv[1], {}, io.StringIO()
with contextlib.redirect_stdout(said), contextlib.suppress(SystemExit):
    main([command, "--help"])
found["option"] = " ".join(said.getvalue().split())
empty = Document()
part = "settings" if command == "design" else "fabrication"
change = edits.set_settings if command == "design" else edits.set_fabrication
edit = change(empty, CHANGED=3)
stored = json.loads(codec.encode(edit.document)[codec.DESIGN])[part]
found["file"] = stored.get("rings")
found["file without"] = "rings" in json.loads(codec.encode(empty)[codec.DESIGN])[part]
found["read back"] = codec.decode(codec.encode(edit.document)) == edit.document
found["undo"] = edit.label
call = ks.design if command == "design" else ks.Design.plan_cuts
parameter = inspect.signature(call).parameters.get("rings")
found["keyword"] = parameter is not None and parameter.default in (0, None)
found["told"] = "\\nrings : int" in call.__doc__
try:
    replace(getattr(empty, part), rings=10)
except KirigamiError as error:
    found["refusal"] = str(error)
application = QApplication([])
form = SettingsPanel() if command == "design" else MoreOptions()
box, reported = form.findChild(QSpinBox, "rings"), []
form.changed.connect(reported.append)
if box is not None:
    form.show_settings(getattr(edit.document, part))
    shown = box.value()
    box.setValue(5)
    found["field"] = [shown, box.maximum(), box.toolTip(), box.accessibleName(), *reported]
print(json.dumps(found))
"""


def copy_with(planted: Planted, setting: str, repository: Path, folder: Path) -> list[str]:
    """Copy the package with a choice planted; returns the names of the files that it takes."""
    package = folder / "kirigami_studio"
    shutil.copytree(repository / "kirigami_studio", package, ignore=shutil.ignore_patterns("__pycache__"))
    (folder / "resources").symlink_to(repository / "resources")
    for name, before, after in (
        (planted.settings, planted.before, setting + planted.before),
        (planted.use, *planted.used),
    ):
        text = (package / name).read_text(encoding="utf-8")
        assert text.count(before) == 1, f"{before!r} in {name}"
        (package / name).write_text(text.replace(before, after), encoding="utf-8")
    original = repository / "kirigami_studio"
    files = [path.relative_to(package) for path in package.rglob("*.py")]
    return sorted(path.as_posix() for path in files if (package / path).read_bytes() != (original / path).read_bytes())


def found_in(folder: Path, command: str, changed: str = "rings") -> dict[str, Any]:
    """What a user of the copied package finds of the planted choice, once a setting was ``changed``."""
    done = subprocess.run(
        [sys.executable, "-c", PROGRAM.replace("CHANGED", changed), command],
        cwd=folder,
        env=os.environ | {"PYTHONPATH": str(folder), "COLUMNS": "200", "LANGUAGE": "en"},
        capture_output=True,
        encoding="utf-8",
        timeout=300,
        check=False,
    )
    assert done.returncode == 0, done.stderr
    found: dict[str, Any] = json.loads(done.stdout.splitlines()[-1])
    return found


@pytest.mark.qt
@pytest.mark.parametrize("planted", [SEARCH, SHEET], ids=lambda planted: planted.command)
def test_that_a_new_choice_costs_its_setting_its_use_and_a_test(
    planted: Planted, repository: Path, tmp_path: Path
) -> None:
    assert copy_with(planted, SETTING, repository, tmp_path) == sorted([planted.settings, planted.use])
    found = found_in(tmp_path, planted.command)
    usual = "default 0" if planted.command == "design" else "default: the project's, or 0"
    assert f"--rings RINGS rings around the sheet (0 to 9; {usual})" in found["option"]
    assert (
        found["keyword"] and found["told"] and found["file"] == 3 and not found["file without"] and found["read back"]
    )
    assert found["undo"] == "Change a setting"
    assert found["refusal"].startswith("rings cannot be 10")
    assert found["field"] == [3, 9, "Rings around the sheet (0 to 9).", "Rings", {"rings": 5}]


@pytest.mark.qt
def test_that_a_field_that_says_nothing_of_itself_appears_nowhere(repository: Path, tmp_path: Path) -> None:
    copy_with(SEARCH, SILENT, repository, tmp_path)
    found = found_in(tmp_path, "design", changed="seed")
    assert "--rings" not in found["option"] and not found["keyword"] and not found["told"]
    assert found["file"] is None
    assert "refusal" not in found and "field" not in found


@pytest.mark.parametrize("kind", [DesignSettings, FabricationSettings, CutOptions])
def test_that_every_setting_has_a_problem_with_a_sentence_and_words_for_undo(kind: type) -> None:
    for name, one in settings_of(kind).items():
        assert one.setting.code in SENTENCES, name
        assert one.setting.undo, name
        if one.setting.label:
            assert one.setting.about or one.setting.choices, name


@pytest.mark.parametrize(
    ("change", "kind", "without"),
    [
        (DesignChange, DesignChoices, {"start", "second"}),
        (SettingsChange, DesignSettings, set()),
        (FabricationChange, FabricationSettings, set()),
        (OptionsChange, CutOptions, set()),
    ],
)
def test_that_changes_name_every_setting_and_no_other(change: type, kind: type, without: set[str]) -> None:
    assert set(get_type_hints(change)) == set(settings_of(kind)) - without


@pytest.mark.parametrize("kind", [DesignSettings, FabricationSettings, CutOptions])
def test_that_the_file_format_tells_of_every_setting(kind: type, repository: Path) -> None:
    told = (repository / "docs" / "file-format.md").read_text(encoding="utf-8")
    assert [name for name in settings_of(kind) if f"`{name}`" not in told] == []
