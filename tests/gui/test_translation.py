"""Everything that the window says can be said in another language."""

from __future__ import annotations

import ast
import json
import os
import re
import subprocess
import sys
from pathlib import Path

from babel.messages.catalog import Catalog

from kirigami_studio.foundation.words import FOLDER_VARIABLE
from tests.catalogues import template, write_compiled

OPEN, CLOSE = "\N{LEFT WHITE SQUARE BRACKET}", "\N{RIGHT WHITE SQUARE BRACKET}"
#: Written in no language, or data: names of files and figures, units, abbreviations of the field, keys.
NEUTRAL = re.compile(
    r"\b(English|Deutsch|mm|min|sIoU|IoU|TV|DXF|SVG|PDF|PNG|GIF|R12|R2010|Kirigami Studio|heart|kiri|"
    r"Ctrl|Shift|Alt|Esc|Del|PgDown|PgUp|Space|Left|Right|Up|Down)\b"
)
#: Names of materials and machines are data, and what the rooms below the window say is English.
DATA = re.compile(r"(ComboBox material|ChoiceBox machineProfile)|QLabel warning")
#: Opens a window with designs and prints every text that a person could read or be read to.
PROGRAM = """
import json, sys
from pathlib import Path
from PySide6.QtGui import QAction
from PySide6.QtWidgets import (QAbstractButton, QAbstractSpinBox, QComboBox, QGroupBox, QLabel, QLineEdit, QWidget)
from PySide6.QtCore import QEventLoop, Qt
from kirigami_studio.gui.window.application import create_application, create_window
from kirigami_studio.gui.widgets.theme import LIGHT

application = create_application(["kirigami-studio"])
window = create_window(LIGHT)
window.show()
window.services.project.open(Path(sys.argv[1]))
while not window.fabrication.export.isEnabled():
    application.processEvents(QEventLoop.ProcessEventsFlag.WaitForMoreEvents, 50)
found = {}
def say(widget, text):
    found.setdefault(text, type(widget).__name__ + " " + widget.objectName())
for action in window.findChildren(QAction):
    for text in (action.text(), action.toolTip(), action.statusTip()):
        say(action, text)
for widget in window.findChildren(QWidget):
    say(widget, widget.toolTip())
    say(widget, widget.accessibleName())
    if isinstance(widget, (QLabel, QAbstractButton)):
        say(widget, widget.text())
    if isinstance(widget, QLineEdit):
        say(widget, widget.placeholderText())
    if isinstance(widget, QComboBox):
        for row in range(widget.count()):
            say(widget, widget.itemText(row))
model = window.gallery.view.model()
say(window.gallery, model.data(model.index(0, 0), Qt.ItemDataRole.ToolTipRole))
say(window, window.session.history.undo_label or "")
window.services.settings.change(k=5)
say(window, window.session.history.undo_label)
window.session.history.mark_saved()
window.close()
print(json.dumps(found))
"""


def test_that_no_sentence_is_said_before_the_language_is_chosen(repository: Path) -> None:
    """What is said while a module is imported would stay in the language of that moment: mark it, say it later."""
    said = []
    for path in sorted((repository / "kirigami_studio").rglob("*.py")):
        said += [f"{path.name}:{line}" for line in said_on_import(ast.parse(path.read_text(encoding="utf-8")))]
    assert said == [], "write mark(...) here and tr(...) where it is shown"
    assert said_on_import(ast.parse("A = {1: tr('now')}\ndef f():\n    tr('later')")) == [1]


def said_on_import(module: ast.AST) -> list[int]:
    """Lines with ``tr`` or ``tr_n`` outside functions."""
    found: list[int] = []
    for child in ast.iter_child_nodes(module):
        if isinstance(child, ast.FunctionDef | ast.AsyncFunctionDef | ast.Lambda):
            continue
        if isinstance(child, ast.Call) and isinstance(child.func, ast.Name) and child.func.id in ("tr", "tr_n"):
            found.append(child.lineno)
        found += said_on_import(child)
    return found


def test_that_nothing_in_the_window_is_said_in_english_only(
    repository: Path, tmp_path: Path, project_file: Path
) -> None:
    catalogue = Catalog("xx")
    for message in template():
        if isinstance(message.id, tuple | list):
            catalogue.add(tuple(message.id), tuple(f"{OPEN}{text}{CLOSE}" for text in message.id))
        elif message.id:
            catalogue.add(message.id, f"{OPEN}{message.id}{CLOSE}")
    write_compiled(catalogue, tmp_path, "xx")
    env = {**os.environ, "LANGUAGE": "xx", FOLDER_VARIABLE: str(tmp_path), "PYTHONIOENCODING": "utf-8"}
    done = subprocess.run(
        [sys.executable, "-c", PROGRAM, str(project_file)],
        cwd=repository,
        env=env,
        capture_output=True,
        encoding="utf-8",
        timeout=120,
        check=False,
    )
    assert done.returncode == 0, done.stderr
    found: dict[str, str] = json.loads(done.stdout.splitlines()[-1])
    assert sum(OPEN in text for text in found) > 200
    english = {
        text: place
        for text, place in found.items()
        if not DATA.fullmatch(place)
        and re.search(r"[A-Za-z]{3,}", outside_brackets(text.replace(str(project_file), "")))
    }
    assert english == {}, "\n".join(f"{place}: {text}" for text, place in english.items())


def outside_brackets(text: str) -> str:
    """What a catalogue did not say; sentences may stand inside sentences."""
    before, depth = [], 0
    for letter in text:
        depth += {OPEN: 1, CLOSE: -1}.get(letter, 0)
        if depth == 0:
            before.append(letter)
    return NEUTRAL.sub("", "".join(before))
