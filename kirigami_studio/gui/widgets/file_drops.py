"""Files that fall on a widget, and where it says so: also pictures and texts that are dragged out of other programs."""

from __future__ import annotations

from PySide6.QtCore import QEvent, QMimeData, QObject, Signal
from PySide6.QtGui import QDragLeaveEvent, QDropEvent
from PySide6.QtWidgets import QWidget


class FileDrops(QObject):
    """Takes what falls on a widget, which is painted again when something is held over it or no longer.

    Parameters
    ----------
    with_content : bool
        Whether pictures and texts are taken, too.
    """

    file_dropped = Signal(str)
    content_dropped = Signal(QMimeData)  #: a picture or a text

    def __init__(self, widget: QWidget, *, with_content: bool = False) -> None:
        super().__init__(widget)
        self.here = False  #: whether something that would be taken is held over the widget
        self._widget, self._with_content = widget, with_content
        widget.setAcceptDrops(True)
        widget.installEventFilter(self)

    def eventFilter(self, watched: QObject, event: QEvent) -> bool:  # noqa: N802 - Qt's name
        if not isinstance(event, (QDropEvent, QDragLeaveEvent)) or event.type() == QEvent.Type.DragMove:
            return False
        taken = isinstance(event, QDropEvent) and self._takes(event)  # Qt's events of entering are of its kind
        self.here = taken and event.type() == QEvent.Type.DragEnter
        self._widget.update()
        return taken

    def _takes(self, event: QDropEvent) -> bool:
        """Take what is dropped, or say that it would be taken."""
        content = event.mimeData()
        files = [url.toLocalFile() for url in content.urls() if url.isLocalFile()]
        if not files and not (self._with_content and (content.hasImage() or content.hasText())):
            return False
        event.acceptProposedAction()
        if event.type() == QEvent.Type.Drop:
            if files:
                self.file_dropped.emit(files[0])
            else:
                self.content_dropped.emit(content)
        return True
