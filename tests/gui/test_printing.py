"""Printing the cut sheet: the pages of its PDF at true size, with their marks, on the paper of the project."""

from __future__ import annotations

import math
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pypdfium2
import pytest
from PySide6.QtGui import QDesktopServices
from PySide6.QtPrintSupport import QPrinter

from kirigami_studio.export.paper import OVERLAP_MM
from kirigami_studio.export.pdf import write_pdf
from kirigami_studio.export.printed_pages import PrintedPages, printed_pages
from kirigami_studio.fabricate.cut_plan import CutPlan
from kirigami_studio.gui.make.print_dialog import PrintDialog, print_pages
from kirigami_studio.gui.session.messages import Tone
from kirigami_studio.gui.window.main_window import MainWindow
from kirigami_studio.studio.making import Planned

Until = Callable[[Callable[[], bool]], None]
MM_PER_POINT = 25.4 / 72.0
#: Dots of a rendered page in a mm.
DOTS = 4.0


@pytest.fixture
def large(designed: MainWindow, until: Until) -> CutPlan:
    """The plan of a sheet that takes four pages of A4."""
    before = designed.services.cutting.made
    designed.services.fabrication.change(width_mm=340.0, paper="a4")
    until(lambda: designed.services.cutting.made not in (before, None))
    made = designed.services.cutting.made
    assert isinstance(made, Planned)
    return made.plan


def printed(pages: PrintedPages, path: Path, pages_from: int = 0, to: int = 0) -> Path:
    """The pages as a printer of this computer would get them."""
    printer = QPrinter(QPrinter.PrinterMode.HighResolution)
    printer.setOutputFormat(QPrinter.OutputFormat.PdfFormat)
    printer.setOutputFileName(str(path))
    if to:
        printer.setPrintRange(QPrinter.PrintRange.PageRange)
        printer.setFromTo(pages_from, to)
    print_pages(pages, printer)
    return path


def inked(path: Path) -> list[np.ndarray]:
    """Which dots of each page have ink: (height, width) of bool."""
    with pypdfium2.PdfDocument(path) as document:
        return [page.render(scale=DOTS * MM_PER_POINT).to_numpy().min(axis=2) < 200 for page in document]


def near(ink: np.ndarray, dots: int) -> np.ndarray:
    """The dots with ink within a few dots."""
    found = ink.copy()
    for _ in range(dots):
        grown = found.copy()
        grown[1:] |= found[:-1]
        grown[:-1] |= found[1:]
        grown[:, 1:] |= found[:, :-1]
        grown[:, :-1] |= found[:, 1:]
        found = grown
    return found


def test_that_printed_pages_are_those_of_the_pdf_at_true_size(large: CutPlan, tmp_path: Path) -> None:
    pages = printed_pages(large, "a4")
    assert len(pages.tiling.tiles) >= 4 and len(pages.pages) == len(pages.tiling.tiles) + 1
    write_pdf(large, tmp_path / "meant.pdf", "a4")
    meant, found = inked(tmp_path / "meant.pdf"), inked(printed(pages, tmp_path / "found.pdf"))
    assert len(found) == len(meant)
    above = round((pages.size_mm[1] - 22.0) * DOTS)  # fonts differ in the words below the drawing
    for want, got in zip(meant[1:], found[1:], strict=True):
        rows, columns = (min(a, b) for a, b in zip(want.shape, got.shape, strict=True))
        want, got = want[: min(rows, above), :columns], got[: min(rows, above), :columns]
        assert want.sum() > 1000
        assert (want & ~near(got, 2)).mean() < 1e-4 and (got & ~near(want, 2)).mean() < 1e-4


def test_that_every_page_has_its_ruler_and_neighbours_their_crosses(large: CutPlan) -> None:
    pages = printed_pages(large, "a4")
    for page in pages.pages:
        lengths = [float(np.ptp(stroke.points[:, 0])) for stroke in page.strokes if len(stroke.points) == 2]
        assert any(math.isclose(length, 50.0, abs_tol=1e-6) for length in lengths)
    dashed = [stroke for page in pages.pages[1:] for stroke in page.strokes if stroke.dash_mm]
    joints = sum((part.row > 0) + (part.row + 1 < pages.tiling.rows) for part in pages.tiling.tiles)
    joints += sum((part.column > 0) + (part.column + 1 < pages.tiling.columns) for part in pages.tiling.tiles)
    assert len(dashed) == joints > 0 and OVERLAP_MM > 0


def test_that_a_range_of_pages_is_printed_alone(large: CutPlan, tmp_path: Path) -> None:
    pages = printed_pages(large, "a4")
    assert len(inked(printed(pages, tmp_path / "some.pdf", 2, 3))) == 2


def open_dialog(window: MainWindow, until: Until) -> PrintDialog:
    window.commands["print"].trigger()
    dialog = window.dialogs.printing
    assert dialog is not None
    until(lambda: dialog.pages is not None)
    return dialog


def test_that_the_dialog_shows_the_pages_and_its_paper_is_the_projects(
    designed: MainWindow, until: Until, monkeypatch: pytest.MonkeyPatch
) -> None:
    dialog = open_dialog(designed, until)
    assert dialog.isVisible() and "One page" in dialog.about.text() and dialog.preview.pageCount() == 1
    assert not dialog.print_.isEnabled() and "No printer" in dialog.printers.text() and dialog.pdf.isEnabled()
    designed.services.fabrication.change(width_mm=300.0)
    dialog.paper.setCurrentIndex(dialog.paper.row_of("a4"))
    dialog.paper.activated.emit(dialog.paper.currentIndex())
    assert designed.session.document.fabrication.paper == "a4"
    assert designed.session.history.undo_label == "Change the paper of PDFs"
    until(lambda: dialog.pages is not None and len(dialog.pages.tiling.tiles) > 1)
    assert "cross upon cross" in dialog.about.text()
    until(lambda: dialog.preview.pageCount() == len(dialog.pages.pages))  # type: ignore[union-attr]
    monkeypatch.setattr(
        "kirigami_studio.gui.make.print_dialog.QPrinterInfo.availablePrinterNames", staticmethod(lambda: ["Office"])
    )
    designed.dialogs.show_print()
    until(dialog.print_.isEnabled)
    assert dialog.printers.text() == ""


def test_that_the_dialog_says_so_while_the_pages_are_laid_out(designed: MainWindow, until: Until) -> None:
    designed.commands["print"].trigger()
    dialog = designed.dialogs.printing
    assert dialog is not None and dialog.pages is None
    assert "Laying out" in dialog.about.text() and not (dialog.pdf.isEnabled() or dialog.print_.isEnabled())
    until(lambda: dialog.pages is not None)
    assert dialog.pdf.isEnabled() and "Laying out" not in dialog.about.text()
    dialog.close()


def test_that_without_a_printer_the_pages_become_a_pdf(
    designed: MainWindow, until: Until, files: object, tmp_path: Path
) -> None:
    files.answer = tmp_path / "pages.pdf"  # type: ignore[attr-defined]
    dialog = open_dialog(designed, until)
    dialog.pdf.click()
    until((tmp_path / "pages.pdf").exists)
    assert len(inked(tmp_path / "pages.pdf")) == 1
    dialog.close()


def test_that_the_page_make_prints_and_says_what_pieces_have_instead(designed: MainWindow, until: Until) -> None:
    dialog = open_dialog(designed, until)
    dialog.close()
    designed.fabrication.exports.print_.click()
    assert dialog.isVisible()
    dialog.show_plan(None, designed.session.document.fabrication)
    assert not dialog.pdf.isEnabled() and dialog.about.text() == "Choose a design to print its cut sheet."


def test_that_a_file_opens_in_lightburn_or_it_is_said_that_no_program_is_set_up(
    designed: MainWindow, files: object, until: Until, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    opened: list[str] = []
    works = [False]

    def open_url(url: object) -> bool:
        opened.append(url.toLocalFile())  # type: ignore[attr-defined]
        return works[0]

    monkeypatch.setattr(QDesktopServices, "openUrl", staticmethod(open_url))
    files.answer = tmp_path / "cut.lbrn2"  # type: ignore[attr-defined]
    designed.files.export(".lbrn2")
    until(lambda: bool(designed.messages.messages))
    (message,) = designed.messages.messages
    ((words, open_it),) = message.actions
    assert words == "O&pen in LightBurn" and message.tone is Tone.DONE
    open_it()
    assert opened == [str(tmp_path / "cut.lbrn2")]
    assert "No program is set up for .lbrn2 files" in designed.messages.messages[-1].sentence
    designed.messages.dismiss(*Tone)
    works[0] = True
    open_it()
    assert designed.messages.messages == ()
