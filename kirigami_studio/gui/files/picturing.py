"""Pictures of any view: as a file, PNG or SVG, or on the clipboard, as large as wanted and as it is seen."""

from __future__ import annotations

from collections.abc import Mapping
from contextlib import nullcontext
from functools import partial
from pathlib import Path

from PySide6.QtCore import QBuffer, QIODevice, QMimeData, QObject, QPoint, QRect, Signal
from PySide6.QtGui import QGuiApplication, QImage, QPainter, QPicture
from PySide6.QtWidgets import QGraphicsView, QWidget

from kirigami_studio.foundation.words import tr
from kirigami_studio.gui.files import picture_jobs
from kirigami_studio.gui.files.picture_jobs import Recording
from kirigami_studio.gui.gallery.gallery_view import GalleryView
from kirigami_studio.gui.make.cutting import CutPlanner
from kirigami_studio.gui.session.messages import Message, Tone
from kirigami_studio.gui.session.queue import JobCallbacks
from kirigami_studio.gui.session.session import Session
from kirigami_studio.gui.widgets.canvas import Canvas

#: Pixels of the picture for each pixel of the view.
SCALES = (1, 2, 4)
#: What shows designs; plots are graphics views.
VIEWS = (Canvas, QGraphicsView, GalleryView)
SVG_TYPE = "image/svg+xml"


class PictureMaker(QObject):
    """Draws views anew in any size; what takes long, encoding and writing, is the worker's."""

    written = Signal(Path)
    copied = Signal()

    def __init__(self, window: QWidget, session: Session, cutting: CutPlanner) -> None:
        super().__init__(window)
        self._window, self._session, self._cutting = window, session, cutting
        self.scale = 2
        self.overlays = True

    def views(self) -> dict[str, QWidget]:
        """All views in sight by the name that a screen reader says; the whole window comes last."""
        found = [view for view in self._window.findChildren(QWidget) if isinstance(view, VIEWS) and view.isVisible()]
        named = {view.accessibleName(): view for view in found if view.accessibleName()}
        return {**named, tr("Whole window"): self._window}

    def view_at_work(self) -> QWidget:
        """The view that has the keyboard, else the largest drawing in sight, before lists."""
        focused: QWidget | None = self._window.focusWidget()
        while focused is not None and focused is not self._window:
            if isinstance(focused, VIEWS) and focused.isVisible():
                return focused
            focused = focused.parentWidget()
        views = [view for view in self.views().values() if view is not self._window]
        return max(
            views, key=lambda view: (isinstance(view, Canvas), view.width() * view.height()), default=self._window
        )

    def write(self, view: QWidget, path: Path) -> None:
        """Write a picture of a view; ``.svg`` is drawn in lines, everything else in pixels."""
        self._session.set_status(tr("Exporting {name} …", name=path.name))
        if path.suffix.lower() == ".svg":
            steps = partial(picture_jobs.writing_svg, self.svg(view), path)
        else:
            steps = partial(picture_jobs.writing_png, self.record(view), self.scale, path)
        callbacks = JobCallbacks(self._report_written, on_failed=self._report_failure)
        self._session.queue.start(tr("exporting {name}", name=path.name), steps, callbacks)

    def copy(self, view: QWidget) -> None:
        """Put a picture of a view on the clipboard."""
        steps = partial(picture_jobs.drawing, self.record(view), self.scale)
        self._session.queue.start(
            tr("copying a picture"), steps, JobCallbacks(self._on_image, on_failed=self._report_failure)
        )

    def copy_cuts(self) -> None:
        """Put the cut plan on the clipboard as SVG in mm, for a drawing program or a laser program."""
        request = self._cutting.request
        if request is None:
            self._session.hint(tr("No design to copy yet. Generate one first."))
            return
        self._session.set_status(tr("Planning the cuts …"))
        callbacks = JobCallbacks(self._on_cuts, on_failed=self._report_failure)
        self._session.queue.start(tr("copying the cuts"), partial(picture_jobs.drawing_cuts, request), callbacks)

    # drawing -------------------------------------------------------------------------------------------------------

    def record(self, view: QWidget) -> Recording:
        """How a view is painted, for the worker to paint it again."""
        strokes = QPicture()
        painter = QPainter(strokes)
        self._paint(painter, view)
        painter.end()
        return Recording(strokes, view.size(), view.palette().window().color(), self._facts())

    def svg(self, view: QWidget) -> bytes:
        """A view in lines; what is kept as a picture in it stays one."""
        from PySide6.QtSvg import QSvgGenerator

        buffer = QBuffer()
        buffer.open(QIODevice.OpenModeFlag.WriteOnly)
        generator = QSvgGenerator()
        generator.setOutputDevice(buffer)
        generator.setResolution(view.logicalDpiX())
        generator.setSize(view.size())
        generator.setViewBox(QRect(QPoint(0, 0), view.size()))
        generator.setTitle(view.accessibleName() or view.windowTitle())
        generator.setDescription("; ".join(f"{name} {text}" for name, text in self._facts().items()))
        painter = QPainter(generator)
        self._paint(painter, view)
        painter.end()
        return bytes(buffer.data().data())

    def _paint(self, painter: QPainter, view: QWidget) -> None:
        if isinstance(view, Canvas):
            with nullcontext() if self.overlays else view.without_overlays():
                view.render_to(painter, view.size())
        else:
            canvases = view.findChildren(Canvas)
            for canvas in canvases:
                canvas.rendering = True
            try:
                view.render(painter, QPoint(0, 0))
            finally:
                for canvas in canvases:
                    canvas.rendering = False

    def _facts(self) -> Mapping[str, str]:
        """Where the design on the stage comes from."""
        request = self._cutting.request
        return {} if request is None else request.facts

    # results --------------------------------------------------------------------------------------------------------

    def _report_failure(self, sentence: str, trace: str) -> None:
        self._session.post(Message(sentence, Tone.ERROR, trace))

    def _report_written(self, path: Path) -> None:
        self._session.set_status(tr("Exported picture: {path}.", path=path))
        self.written.emit(path)

    def _on_image(self, image: QImage) -> None:
        QGuiApplication.clipboard().setImage(image)
        self._session.set_status(
            tr(
                "Copied a {width} \N{MULTIPLICATION SIGN} {height} px picture.",
                width=image.width(),
                height=image.height(),
            )
        )
        self.copied.emit()

    def _on_cuts(self, content: bytes) -> None:
        data = QMimeData()
        data.setData(SVG_TYPE, content)
        data.setText(content.decode("utf-8"))
        QGuiApplication.clipboard().setMimeData(data)
        self._session.set_status(tr("Copied the cuts as SVG in mm."))
        self.copied.emit()
