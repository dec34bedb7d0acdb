"""Printing the cut sheet at true size: paper, pages with their marks as they come out, and the desktop's printers."""

from __future__ import annotations

from functools import partial
from typing import TYPE_CHECKING

from PySide6.QtCore import QMarginsF, QPointF, QSizeF, Qt, Signal
from PySide6.QtGui import QColor, QFont, QPageLayout, QPageSize, QPainter, QPen, QPolygonF
from PySide6.QtPrintSupport import QPrintDialog, QPrinter, QPrinterInfo, QPrintPreviewWidget
from PySide6.QtWidgets import QAbstractScrollArea, QDialog, QSizePolicy, QWidget

from kirigami_studio.export.paper import OVERLAP_MM, Paper
from kirigami_studio.foundation.units import MM_PER_INCH
from kirigami_studio.foundation.words import tr, tr_n
from kirigami_studio.gui.session.queue import JobCallbacks, JobQueue, LatestJob
from kirigami_studio.gui.widgets.form import Form
from kirigami_studio.gui.widgets.layouts import column, label, push_button, row
from kirigami_studio.settings.fabrication import FabricationSettings
from kirigami_studio.studio.making import MadePieces, Planned, laying_pages

if TYPE_CHECKING:
    from kirigami_studio.export.printed_pages import PrintedPage, PrintedPages

#: Pixels of the dialog, the least edge of the preview, and the width of the list of papers.
SIZE, LEAST_PREVIEW, PAPER_WIDTH = (760, 640), 280, 180
#: Thickness (mm) from which on lines are seen on pages as small as in the preview.
SEEN_MM = 0.4
#: Sizes of papers as Qt knows them; one page as large as the sheet has its own.
QT_PAPERS = {Paper.A4: QPageSize.PageSizeId.A4, Paper.LETTER: QPageSize.PageSizeId.Letter}


def page_layout(pages: PrintedPages) -> QPageLayout:
    """The pages' paper, upright or on its side, without margins: the pages have their own."""
    width, height = pages.size_mm
    known = QT_PAPERS.get(Paper(pages.paper))
    turned = width > height
    upright = QSizeF(min(width, height), max(width, height))
    size = QPageSize(known) if known is not None else QPageSize(upright, QPageSize.Unit.Millimeter)
    turn = QPageLayout.Orientation.Landscape if turned else QPageLayout.Orientation.Portrait
    return QPageLayout(size, turn, QMarginsF(), QPageLayout.Unit.Millimeter)


def print_pages(pages: PrintedPages, printer: QPrinter, thinnest_mm: float = 0.0) -> None:
    """Print pages at true size, those of the printer's range where it has one; thinner lines become as thick."""
    printer.setFullPage(True)
    printer.setPageLayout(page_layout(pages))
    first, last = printer.fromPage(), printer.toPage()
    if printer.printRange() is not QPrinter.PrintRange.PageRange or not first:
        first, last = 1, len(pages.pages)
    painter = QPainter(printer)
    for number, page in enumerate(pages.pages[first - 1 : last]):
        if number:
            printer.newPage()
        draw_page(page, painter, pages.size_mm[1], printer.resolution() / MM_PER_INCH, thinnest_mm)
    painter.end()


def draw_page(page: PrintedPage, painter: QPainter, height_mm: float, dots_per_mm: float, thinnest_mm: float) -> None:
    """Draw a page, y up from its lower left corner."""
    painter.save()
    painter.setRenderHint(QPainter.RenderHint.Antialiasing)
    painter.scale(dots_per_mm, dots_per_mm)
    for stroke in page.strokes:
        width = max(stroke.width_mm, thinnest_mm)
        pen = QPen(QColor.fromRgbF(*stroke.colour), width)
        pen.setCapStyle(Qt.PenCapStyle.RoundCap)
        if stroke.dash_mm:
            pen.setDashPattern([length / width for length in stroke.dash_mm])
        painter.setPen(pen)
        line = QPolygonF([QPointF(x, height_mm - y) for x, y in stroke.points.tolist()])
        if stroke.closed:
            painter.drawPolygon(line)
        else:
            painter.drawPolyline(line)
    painter.setPen(QColor("black"))
    font = QFont("Helvetica")
    font.setPixelSize(100)  # scaled: fonts of a few mm have no size in whole pixels
    painter.setFont(font)
    for text in page.texts:
        painter.save()
        painter.translate(text.place[0], height_mm - text.place[1])
        painter.scale(text.height_mm / 100, text.height_mm / 100)
        shift = -0.5 * painter.fontMetrics().horizontalAdvance(text.text) if text.centred else 0.0
        painter.drawText(QPointF(shift, 0.0), text.text)
        painter.restore()
    painter.restore()


def about_pages(pages: PrintedPages) -> str:
    """The number of pages, and how they are put together."""
    parts = len(pages.tiling.tiles)
    if parts == 1:
        return tr("One page, printed at true size. The ruler on it is 50 mm long.")
    return tr_n(
        "{count} page in {rows} rows of {columns}, and a map. They overlap by {overlap:g} mm: cut along the dashed "
        "lines, lay cross upon cross, and tape. Printed at true size; the ruler on each page is 50 mm long.",
        "{count} pages in {rows} rows of {columns}, and a map. They overlap by {overlap:g} mm: cut along the dashed "
        "lines, lay cross upon cross, and tape. Printed at true size; the ruler on each page is 50 mm long.",
        parts,
        rows=pages.tiling.rows,
        columns=pages.tiling.columns,
        overlap=OVERLAP_MM,
    )


class PrintDialog(QDialog):
    """Shows the pages on the paper of the project, and hands them to a printer or to a PDF."""

    changed = Signal(dict)  #: field of FabricationSettings -> value
    pdf_wanted = Signal()

    def __init__(self, parent: QWidget, queue: JobQueue) -> None:
        super().__init__(parent)
        self.setObjectName("printDialog")
        self.setWindowTitle(tr("Print the cut sheet"))
        self.setModal(False)
        self.resize(*SIZE)
        self.pages: PrintedPages | None = None
        self.asking: QPrintDialog | None = None  #: the desktop's own, while it is open
        self._made: Planned | MadePieces | None = None
        self._job = LatestJob["PrintedPages"](queue)
        self.form = Form(FabricationSettings, prefix="print-", parent=self)
        self.form.changed.connect(self.changed)
        self.paper = self.form.choice("paper")
        self.paper.setFixedWidth(PAPER_WIDTH)
        self.paper.setSizePolicy(QSizePolicy.Policy.Fixed, QSizePolicy.Policy.Fixed)
        self.printer = QPrinter(QPrinter.PrinterMode.HighResolution)
        self.preview = QPrintPreviewWidget(self.printer)
        areas = self.preview.findChildren(QAbstractScrollArea)
        for part in (self.preview, *areas, *(area.viewport() for area in areas)):
            part.setAccessibleName(tr("Pages as they are printed"))
        self.preview.setMinimumSize(LEAST_PREVIEW, LEAST_PREVIEW)
        self.preview.paintRequested.connect(self._paint)
        self.about, self.printers = label(wraps=True), label(wraps=True)
        self.print_ = push_button(tr("&Print …"), tr("Choose a printer and print at true size."), name="primary")
        self.pdf = push_button(tr("Save as P&DF …"), tr("Save these pages as a PDF, read back and checked."), name="")
        self.shut = push_button(tr("Cl&ose"), name="")
        above = row(label(tr("Pape&r"), self.paper), self.paper, 8, (self.about, 1), spacing=8)
        below = row((self.printers, 1), self.shut, self.pdf, self.print_, spacing=8)
        column(above, (self.preview, 1), below, on=self, spacing=10, margins=(14, 14, 14, 14))
        self.print_.clicked.connect(self._ask)
        self.pdf.clicked.connect(self.pdf_wanted)
        self.shut.clicked.connect(self.close)
        self.finished.connect(lambda _: self._job.stop())

    def show_plan(self, made: Planned | MadePieces | None, settings: FabricationSettings) -> None:
        """Lay the plan of the chosen design over the paper of the project."""
        self._made = made
        self.paper.choose(settings.paper)
        self._job.stop()
        has_printers = bool(QPrinterInfo.availablePrinterNames())
        self.printers.setText(
            "" if has_printers else tr("No printer is set up here: save a PDF, and print it at 100 %.")
        )
        if not isinstance(made, Planned):
            self._show(None)
            self.about.setText(
                tr("Choose a design to print its cut sheet.")
                if made is None
                else tr("Pieces on pins lie on several sheets: Export writes them with assembly.pdf, at true size.")
            )
            return
        if self.pages is None:
            self._show(None)
            self.about.setText(tr("Laying out the pages …"))
        callbacks: JobCallbacks[PrintedPages] = JobCallbacks(
            self._show, on_failed=lambda sentence, _: self._refuse(sentence)
        )
        self._job.start(tr("laying out pages"), partial(laying_pages, made.plan, settings.paper), callbacks)

    def _show(self, pages: PrintedPages | None) -> None:
        self.pages = pages
        self.print_.setEnabled(pages is not None and bool(QPrinterInfo.availablePrinterNames()))
        self.pdf.setEnabled(pages is not None)
        self.preview.setEnabled(pages is not None)
        if pages is not None:
            self.about.setText(about_pages(pages))
            self.printer.setPageLayout(page_layout(pages))
            self.preview.updatePreview()
            self.preview.setAllPagesViewMode()  # fits all pages into the view, however many there are now

    def _refuse(self, sentence: str) -> None:
        self._show(None)
        self.about.setText(sentence)

    def _paint(self, printer: QPrinter) -> None:
        if self.pages is not None:
            print_pages(self.pages, printer, SEEN_MM)

    def _ask(self) -> None:
        """Open the desktop's own dialog for printer, copies and range."""
        if self.pages is None:
            return
        self.asking = QPrintDialog(self.printer, self)
        self.asking.setOption(QPrintDialog.PrintDialogOption.PrintPageRange)
        self.asking.setMinMax(1, len(self.pages.pages))
        self.asking.accepted.connect(self.print_now)
        QDialog.open(self.asking)  # QPrintDialog hides it behind an older one

    def print_now(self) -> None:
        """Print on the chosen printer."""
        if self.pages is not None:
            print_pages(self.pages, self.printer)
