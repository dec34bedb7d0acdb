"""What is pasted or dropped -> a file that can be read as a target."""

from __future__ import annotations

import json
import re
import tempfile
from pathlib import Path
from xml.sax.saxutils import quoteattr

from PySide6.QtCore import QMimeData, QObject, Signal
from PySide6.QtGui import QImage

from kirigami_studio.foundation.words import mark, tr
from kirigami_studio.gui.session.messages import Message, Tone
from kirigami_studio.gui.session.session import Session

#: How SVG path data begins: a move to a number.
PATH_BEGINS = re.compile(r"[Mm]\s*[-+.\d]")
#: How the names of the folders with pasted content begin.
PASTED = "kirigami-pasted-"
NOTHING = mark("Nothing to paste. Copy a picture, file, SVG or path first.")


class PasteReader(QObject):
    """Keeps pasted content in files of its own until the window closes: a picture's threshold can still be moved."""

    file_wanted = Signal(str)

    def __init__(self, session: Session, parent: QObject) -> None:
        super().__init__(parent)
        self._session = session
        self._folder = tempfile.TemporaryDirectory(prefix=PASTED)
        self._count = 0
        self.destroyed.connect(self._folder.cleanup)

    def take(self, content: QMimeData) -> None:
        """Open a file, a picture, an SVG document, SVG path data or a JSON list of points."""
        files = [url.toLocalFile() for url in content.urls() if url.isLocalFile()]
        if files:
            self.file_wanted.emit(files[0])
            return
        picture = content.imageData()
        if isinstance(picture, QImage) and not picture.isNull():
            path = self._place(".png")
            if picture.save(str(path)):
                self.file_wanted.emit(str(path))
            else:
                self._session.post(
                    Message(tr("Could not save the picture to {path}. Free some disk space.", path=path), Tone.ERROR)
                )
            return
        found = recognised(svg_of(content))
        if found is None:
            self._session.hint(tr(NOTHING))
            return
        extension, text = found
        path = self._place(extension)
        path.write_text(text, encoding="utf-8")
        self.file_wanted.emit(str(path))

    def _place(self, extension: str) -> Path:
        self._count += 1
        return Path(self._folder.name) / tr("pasted {count}{extension}", count=self._count, extension=extension)


def svg_of(content: QMimeData) -> str:
    """The text of some content; drawing programs put SVG under its own type."""
    if content.hasFormat("image/svg+xml"):
        return bytes(content.data("image/svg+xml").data()).decode("utf-8", errors="replace")
    return content.text()


def recognised(text: str) -> tuple[str, str] | None:
    """Extension and content of the file that a text would be: SVG, path data made SVG, or a JSON list of points."""
    text = text.strip()
    if text.startswith("<") and "<svg" in text[:4000]:
        return ".svg", text
    if PATH_BEGINS.match(text):
        return ".svg", f'<svg xmlns="http://www.w3.org/2000/svg"><path d={quoteattr(text)}/></svg>'
    try:
        points = json.loads(text)
    except (ValueError, RecursionError):
        return None
    return (".json", text) if isinstance(points, list | dict) else None
