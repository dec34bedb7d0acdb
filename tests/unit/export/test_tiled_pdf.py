"""PDFs spread over paper, put together again by another reader (pypdf)."""

from __future__ import annotations

import re
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
import shapely
from pypdf import PageObject, PdfReader
from pypdf.generic import ContentStream
from shapely.geometry import LineString

from kirigami_studio.export import pdf, picture
from kirigami_studio.export.exporter import ExportJob
from kirigami_studio.export.paper import PAPERS, page_notes, tile
from kirigami_studio.export.pdf import read_pages
from kirigami_studio.export.registry import export
from kirigami_studio.fabricate.cut_plan import CutPlan, Layer, plan_cuts
from kirigami_studio.foundation.errors import ExportError
from kirigami_studio.lattice.deployment import Deployment
from tests.refusals import refused

MakeDesign = Callable[..., Deployment]
MM = 25.4 / 72.0
WINDOW = re.compile(r"x (-?[\d.]+) to (-?[\d.]+) mm, y (-?[\d.]+) to (-?[\d.]+) mm")


def strokes(page: PageObject, reader: PdfReader) -> list[tuple[tuple[int, ...], LineString]]:
    """Colour and line (mm on the page) of everything that is stroked."""
    found, colour, points = [], (0, 0, 0), []
    for operands, operator in ContentStream(page.get_contents(), reader).operations:
        match operator:
            case b"RG":
                colour = tuple(round(255 * float(value)) for value in operands)
            case b"m":
                points = [[float(value) * MM for value in operands]]
            case b"l":
                points.append([float(value) * MM for value in operands])
            case b"h":
                points.append(points[0])
            case b"S":
                found.append((colour, LineString(points)))
    return found


def assembled(path: Path) -> dict[tuple[int, ...], float]:
    """Length of each colour when all pages are cut in the middle of their overlap and laid side by side."""
    reader = PdfReader(path)
    pages = [page for page in reader.pages if WINDOW.search(page.extract_text())]
    windows = np.array([[float(x) for x in WINDOW.search(page.extract_text()).groups()] for page in pages])  # type: ignore[union-attr]
    totals: dict[tuple[int, ...], float] = {}
    for page, window in zip(pages, windows, strict=True):
        low_x, high_x = joints(windows[:, 0], windows[:, 1], window[0])
        low_y, high_y = joints(windows[:, 2], windows[:, 3], window[2])
        cell = shapely.box(low_x, low_y, high_x, high_y)
        for colour, line in strokes(page, reader):
            placed = shapely.affinity.translate(line, window[0] - 10.0, window[2] - 24.0)
            totals[colour] = totals.get(colour, 0.0) + placed.intersection(cell).length
    return totals


def joints(lows: np.ndarray, highs: np.ndarray, low: float) -> tuple[float, float]:
    """Middle of the overlap with the neighbours on both sides, far away where there is none."""
    pairs = sorted(set(zip(lows.tolist(), highs.tolist(), strict=True)))
    number = [pair[0] for pair in pairs].index(low)
    before = 0.5 * (pairs[number - 1][1] + low) if number else -1e4
    after = 0.5 * (pairs[number + 1][0] + pairs[number][1]) if number < len(pairs) - 1 else 1e4
    return before, after


@pytest.mark.parametrize(("width", "pages"), [(450.0, 3), (330.0, 2)])
@pytest.mark.parametrize("paper", ["a4", "letter"])
def test_that_the_pages_together_hold_every_cut(
    paper: str, width: float, pages: int, make_design: MakeDesign, tmp_path: Path
) -> None:
    plan = plan_cuts(make_design(5, 6, seed=2), width)
    pdf.write_pdf(plan, tmp_path / "sheet.pdf", paper)
    reader = PdfReader(tmp_path / "sheet.pdf")
    assert len(reader.pages) > pages
    sides = sorted(float(side) * MM for side in reader.pages[0].mediabox[2:])
    assert sides == pytest.approx(sorted(PAPERS[paper]), abs=1e-3)  # type: ignore[arg-type]
    totals = assembled(tmp_path / "sheet.pdf")
    for layer in plan.layers:
        meant = sum(path.length for path in plan.on_layer(layer))
        assert totals[picture.LAYER_COLOUR[layer]] == pytest.approx(meant, rel=1e-3)


def test_that_every_page_has_a_ruler_of_its_length_and_its_number(make_design: MakeDesign, tmp_path: Path) -> None:
    plan = plan_cuts(make_design(5, 6, seed=2), 450.0)
    pdf.write_pdf(plan, tmp_path / "sheet.pdf", "a4")
    reader = PdfReader(tmp_path / "sheet.pdf")
    count = len(reader.pages) - 1
    assert f"Map of {count} pages" in reader.pages[0].extract_text()
    for number, page in enumerate(reader.pages):
        assert "This ruler is 50 mm long" in page.extract_text()
        assert number == 0 or f"Page {number} of {count}" in page.extract_text()
        ruler = [line for _, line in strokes(page, reader) if line.bounds[1] == line.bounds[3] == pytest.approx(10.0)]
        assert max(line.length for line in ruler) == pytest.approx(50.0, abs=1e-3)


def test_that_crosses_of_neighbours_lie_upon_each_other(make_design: MakeDesign, tmp_path: Path) -> None:
    plan = plan_cuts(make_design(5, 6, seed=2), 450.0)
    pdf.write_pdf(plan, tmp_path / "sheet.pdf", "a4")
    reader = PdfReader(tmp_path / "sheet.pdf")
    centres: dict[tuple[float, float], int] = {}
    for page in reader.pages[1:]:
        x, _, y, _ = (float(value) for value in WINDOW.search(page.extract_text()).groups())  # type: ignore[union-attr]
        crosses = [line for _, line in strokes(page, reader) if line.length == pytest.approx(72**0.5, abs=1e-3)]
        for place in {(round(c.centroid.x + x - 10.0, 2), round(c.centroid.y + y - 24.0, 2)) for c in crosses}:
            centres[place] = centres.get(place, 0) + 1
    assert centres and set(centres.values()) <= {2, 4}


def test_that_a_sheet_that_fits_takes_one_page_of_the_paper(make_design: MakeDesign, tmp_path: Path) -> None:
    design = make_design(4, 5, seed=1)
    job = ExportJob(design, plan=plan_cuts(design), paper="a4")
    export(job, tmp_path / "sheet.pdf")
    (page,) = read_pages(tmp_path / "sheet.pdf")
    assert sorted(page.size_mm) == pytest.approx([210.0, 297.0], abs=1e-3)


@pytest.mark.parametrize("size", [(100.0, 80.0), (190.0, 263.0), (190.1, 80.0), (263.5, 190.5), (1000.0, 700.0)])
def test_that_cells_fill_the_sheet_and_windows_hold_their_cells(size: tuple[float, float]) -> None:
    tiling = tile(size, "a4")
    sheet = shapely.box(0, 0, *size)
    cells = [shapely.box(*np.clip(part.cell, -2e3, 2e3)).intersection(sheet) for part in tiling.tiles]
    assert sum(cell.area for cell in cells) == pytest.approx(sheet.area)
    assert shapely.union_all(cells).area == pytest.approx(sheet.area)
    for part, cell in zip(tiling.tiles, cells, strict=True):
        assert cell.within(shapely.box(*part.window).buffer(1e-9))


def test_that_unknown_paper_and_too_many_pages_are_refused(make_design: MakeDesign, tmp_path: Path) -> None:
    plan: CutPlan = plan_cuts(make_design(2, 3))
    with refused(ExportError, "paper.unknown", known="none, a4, letter", name="a9"):
        pdf.write_pdf(plan, tmp_path / "sheet.pdf", "a9")
    with refused(ExportError, "paper.too_many_pages"):
        tile((10_000.0, 10_000.0), "letter")


def test_that_a_missing_cut_is_noticed(
    make_design: MakeDesign, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    plan = plan_cuts(make_design(5, 6, seed=2), 330.0)
    draw, drawn = pdf.draw_line, []

    def forgetful(canvas: object, points: np.ndarray, closed: bool) -> None:
        drawn.append(points)
        if len(drawn) % 7:
            draw(canvas, points, closed)

    monkeypatch.setattr(pdf, "draw_line", forgetful)
    with refused(ExportError, "pdf.other_length"):
        pdf.write_pdf(plan, tmp_path / "sheet.pdf", "a4")
    assert sum(path.layer is Layer.SLITS for path in plan.paths) == 30


def test_that_a_pdf_of_many_pages_is_told() -> None:
    assert page_notes((3000.0, 2900.0), "none") == page_notes((300.0, 200.0), "a4") == ()
    (note,) = page_notes((1500.0, 1500.0), "a4")
    assert note.code == "paper.many_pages"
    assert note.fields["pages"] == len(tile((1500.0, 1500.0), "a4").tiles)
