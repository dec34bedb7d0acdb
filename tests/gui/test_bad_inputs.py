"""Files that are dropped on the window and are no good: one clear sentence each with what to try; nothing is lost."""

from __future__ import annotations

import io
import json
import os
import re
import zipfile
from collections.abc import Callable
from pathlib import Path

from PIL import Image
from PySide6.QtCore import QMimeData, QPointF, Qt, QUrl
from PySide6.QtGui import QDragEnterEvent, QDropEvent
from PySide6.QtWidgets import QApplication

from kirigami_studio.gui.session.messages import Tone
from kirigami_studio.gui.window.main_window import MainWindow
from kirigami_studio.project import store
from kirigami_studio.project.document import Document

Until = Callable[[Callable[[], bool]], None]
Maker = Callable[[Path], object]

LAUGHS = """<?xml version="1.0"?><!DOCTYPE svg [<!ENTITY a "ha"><!ENTITY b "&a;&a;&a;&a;&a;&a;&a;&a;&a;&a;">
<!ENTITY c "&b;&b;&b;&b;&b;&b;&b;&b;&b;&b;"><!ENTITY d "&c;&c;&c;&c;&c;&c;&c;&c;&c;&c;">]>
<svg xmlns="http://www.w3.org/2000/svg"><text>&d;&d;&d;&d;</text></svg>"""


def text(content: str) -> Maker:
    return lambda path: path.write_text(content, encoding="utf-8")


def bytes_(content: bytes) -> Maker:
    return lambda path: path.write_bytes(content)


def sparse(size: int) -> Maker:
    """A file that claims to be large and takes no room."""

    def make(path: Path) -> None:
        with path.open("wb") as stream:
            stream.truncate(size)

    return make


def plain_picture(path: Path) -> None:
    Image.new("L", (200, 200), 255).save(path)


def bomb(path: Path) -> None:
    """A zip of half a megabyte that unpacks to half a gigabyte."""
    with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED) as archive, archive.open("manifest.json", "w") as stream:
        for _ in range(512):
            stream.write(bytes(2**20))


def newer(path: Path) -> None:
    """A project of a version to come."""
    stream = io.BytesIO(store.pack(Document()))
    with zipfile.ZipFile(stream) as old, zipfile.ZipFile(path, "w") as new:
        for name in old.namelist():
            content = old.read(name)
            if name == "manifest.json":
                content = json.dumps(json.loads(content) | {"version": 99}).encode()
            new.writestr(name, content)


def cut_short(path: Path) -> None:
    path.write_bytes(store.pack(Document())[:200])


def locked(path: Path) -> None:
    path.write_text("[[0, 0], [1, 0], [0, 1]]", encoding="utf-8")
    path.chmod(0)


#: File name, what makes it, a word that the sentence must have so that its reader knows what is wrong.
INPUTS: tuple[tuple[str, Maker, str], ...] = (
    ("nothing.png", bytes_(b""), "nothing.png"),
    ("nothing.svg", text(""), "nothing.svg"),
    ("nothing.dxf", text(""), "nothing.dxf"),
    ("nothing.json", text(""), "nothing.json"),
    ("nothing.kiri", bytes_(b""), "nothing.kiri"),
    ("white.png", plain_picture, "white.png"),
    ("no picture.jpg", bytes_(b"\xff\xd8\xff\xe0 not a picture after all"), "no picture.jpg"),
    ("no numbers.json", text("[[0, 0], [NaN, 1], [1, 1]]"), "finite"),
    ("too far.json", text("[[0, 0], [1e400, 1], [1, 1]]"), "finite"),
    ("words.json", text('{"points": "many"}'), "pairs"),
    ("line.json", text("[[0, 0], [1, 1], [2, 2]]"), "area"),
    ("crossing.json", text("[[0, 0], [2, 2], [2, 0], [0, 2]]"), "cross"),
    ("laughs.svg", text(LAUGHS), "laughs.svg"),
    ("half.svg", text('<svg xmlns="http://www.w3.org/2000/svg"><path d="M0 0 L1'), "half.svg"),
    ("no drawing.dxf", bytes_(bytes(range(256)) * 40), "no drawing.dxf"),
    ("film.mp4", bytes_(b"\0\0\0\x18ftypmp42"), "mp4"),
    ("folder", lambda path: path.mkdir(), "folder"),
    ("folder.kiri", lambda path: path.mkdir(), "folder.kiri"),
    ("huge.json", sparse(3 * 2**30), "huge.json"),
    ("huge.png", sparse(3 * 2**30), "huge.png"),
    ("huge.svg", sparse(3 * 2**30), "huge.svg"),
    ("huge.dxf", sparse(3 * 2**30), "huge.dxf"),
    ("huge.kiri", sparse(3 * 2**30), "too large"),
    ("bomb.kiri", bomb, "unpacks"),
    ("later.kiri", newer, "newer"),
    ("cut short.kiri", cut_short, "cut short.kiri"),
    ("locked.json", locked, "locked.json"),
    ("gone.svg", lambda path: None, "gone.svg"),
)

#: How a sentence goes on that says what to do.
TRIES = (
    r"[;,.:] (choose|try|check|open|save|export|separate|draw|use|give|free|correct|make|move|join|name|update|copy)"
    r"|must (be|have|lie)"
)


def drop(window: MainWindow, path: Path) -> None:
    """Let go of a file over the window."""
    content = QMimeData()
    content.setUrls([QUrl.fromLocalFile(str(path))])
    copy, left, none = Qt.DropAction.CopyAction, Qt.MouseButton.LeftButton, Qt.KeyboardModifier.NoModifier
    middle = window.rect().center()
    entered = QDragEnterEvent(middle, copy, content, left, none)
    event = QDropEvent(QPointF(middle), copy, content, left, none)
    QApplication.sendEvent(window, entered)
    QApplication.sendEvent(window, event)
    assert entered.isAccepted() and event.isAccepted()


def test_that_each_bad_file_gets_one_clear_sentence_and_loses_nothing(
    designed: MainWindow, tmp_path: Path, until: Until
) -> None:
    before, stage, place = designed.session.document, designed.session.stage, designed.session.path
    for name, make, word in INPUTS:
        path = tmp_path / "dropped" / name
        path.parent.mkdir(exist_ok=True)
        make(path)
        if name == "locked.json" and os.access(path, os.R_OK):
            continue  # whoever runs this may read every file
        drop(designed, path)
        until(lambda: bool(designed.messages.messages) and not designed.session.queue.busy)
        (message,) = designed.messages.messages
        assert message.tone is Tone.ERROR and word in message.sentence, f"{name}: {message.sentence}"
        judge(message.sentence.replace(str(path), name))
        assert designed.session.document is before and designed.session.stage is stage, name
        assert designed.session.path == place and not designed.isWindowModified(), name
        assert "nothing changed" in designed.status_text.text(), name
        designed.messages.close_message()
    designed.services.targeting.open("star")
    until(lambda: designed.target.view.outline is not None and designed.target.view.outline.name == "star")
    designed.commands["undo"].trigger()
    until(lambda: designed.fabrication.export.isEnabled())


def judge(sentence: str) -> None:
    """One sentence that a person can act on, not a library's words."""
    assert 20 < len(sentence) < 260, sentence
    assert sentence.endswith("."), sentence
    assert "unexpected" not in sentence and "Traceback" not in sentence and "Error" not in sentence, sentence
    assert not re.search(r"0x[0-9a-f]{6}|<class|\bNone\b|\\n|Errno|\\\\x", sentence), sentence
    assert sentence.isprintable(), sentence
    assert re.search(TRIES, sentence, re.IGNORECASE), f"says nothing to try: {sentence}"
