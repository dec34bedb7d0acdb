"""PDF pages become outlines: they agree with PDFium's own rendering of the page."""

from __future__ import annotations

import zlib
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pypdfium2
import pytest
from reportlab.pdfgen.canvas import Canvas

from kirigami_studio.foundation.errors import TargetError
from kirigami_studio.outlines.read import read_parts, read_target
from kirigami_studio.outlines.read_image import outline_of_mask

Draw = Callable[[Canvas], object]


@pytest.fixture
def pdf(tmp_path: Path) -> Callable[..., Path]:
    """Write a page of 300 x 200 points that a function fills."""

    def written(draw: Draw, name: str = "page.pdf", **settings: object) -> Path:
        canvas = Canvas(str(tmp_path / name), pagesize=(300, 200), **settings)
        draw(canvas)
        canvas.save()
        return tmp_path / name

    return written


def star(canvas: Canvas, x: float, y: float, radius: float, **how: int) -> None:
    path = canvas.beginPath()
    for index in range(10):
        length, angle = radius * (0.45, 1.0)[index % 2], index * np.pi / 5
        (path.lineTo if index else path.moveTo)(x + length * np.cos(angle), y + length * np.sin(angle))
    path.close()
    canvas.drawPath(path, **how)


def turned(canvas: Canvas) -> None:
    canvas.translate(150, 100)
    canvas.rotate(25)
    canvas.scale(1, 0.5)
    star(canvas, 0, 0, 80, fill=1, stroke=0)


def nested(canvas: Canvas) -> None:
    canvas.beginForm("inner", lowerx=-50, lowery=-50, upperx=50, uppery=50)
    star(canvas, 0, 0, 40, fill=1, stroke=0)
    canvas.endForm()
    canvas.beginForm("outer", lowerx=-100, lowery=-100, upperx=100, uppery=100)
    canvas.scale(2, 2)
    canvas.doForm("inner")
    canvas.endForm()
    canvas.translate(150, 100)
    canvas.doForm("outer")


def clipped(canvas: Canvas) -> None:
    path = canvas.beginPath()
    path.circle(150, 100, 60)
    canvas.clipPath(path, stroke=0)
    canvas.rect(0, 0, 170, 200, fill=1, stroke=0)


def gradient(canvas: Canvas) -> None:
    path = canvas.beginPath()
    path.circle(150, 100, 60)
    canvas.clipPath(path, stroke=0)
    canvas.linearGradient(0, 0, 300, 200, ((0.5, 0, 0), (0, 0, 0.5)))


def page_turned(canvas: Canvas) -> None:
    canvas.setPageRotation(90)
    star(canvas, 100, 100, 70, fill=1, stroke=0)
    canvas.rect(100, 95, 190, 10, fill=1, stroke=0)


def on_paper(canvas: Canvas) -> None:
    canvas.setFillColorRGB(1, 1, 1)
    canvas.rect(0, 0, 300, 200, fill=1, stroke=0)
    canvas.setFillColorRGB(0, 0.3, 0)
    star(canvas, 150, 100, 80, fill=1, stroke=0)


@pytest.mark.parametrize(
    "draw",
    [lambda canvas: canvas.ellipse(40, 40, 260, 160, fill=1, stroke=0), turned, nested, clipped, gradient, page_turned,
     on_paper],
)  # fmt: skip
def test_that_a_page_is_read_as_it_is_rendered(draw, pdf, iou) -> None:
    path = pdf(draw)
    document = pypdfium2.PdfDocument(path)
    seen = np.asarray(document[0].render(scale=3).to_pil().convert("L")) < 200
    document.close()
    outline, rendered = read_target(path), outline_of_mask(seen, "rendered")
    assert iou(outline, rendered) > 0.98
    assert outline.unit == "mm"
    assert outline.size == pytest.approx(np.array(rendered.size) / 3 * 25.4 / 72, rel=0.02)


def test_that_the_first_page_is_read_and_what_is_left_out_is_said(pdf) -> None:
    def draw(canvas: Canvas) -> None:
        star(canvas, 150, 100, 80, fill=1, stroke=0)
        canvas.drawString(3, 3, "i")
        canvas.showPage()
        canvas.drawString(3, 3, "x")

    notes = " ".join(read_target(pdf(draw, "logo.ai")).notes)
    assert "first of 2 pages" in notes and "Text was left out" in notes


def test_that_fills_and_lines_are_parts_with_colours(pdf) -> None:
    def draw(canvas: Canvas) -> None:
        canvas.setFillColorRGB(1, 0, 0)
        canvas.circle(80, 100, 40, fill=1, stroke=0)
        canvas.setStrokeColorRGB(0, 0, 1)
        canvas.circle(220, 100, 30, fill=0, stroke=1)

    parts = read_parts(pdf(draw)).parts
    assert [(part.colour, part.kind.value) for part in parts] == [("#ff0000", "filled"), ("#0000ff", "closed")]


def encrypted(folder: Path, path: Path) -> Path:
    import pypdf

    writer = pypdf.PdfWriter(clone_from=str(path))
    writer.encrypt("secret", algorithm="RC4-128")
    writer.write(folder / "locked.pdf")
    return folder / "locked.pdf"


def test_that_a_locked_a_postscript_and_an_unpacking_file_are_refused(pdf, tmp_path) -> None:
    def cause(path: Path) -> str:
        with pytest.raises(TargetError) as caught:
            read_target(path)
        assert isinstance(caught.value.__cause__, TargetError)
        return caught.value.__cause__.code

    whole = pdf(on_paper)
    assert cause(encrypted(tmp_path, whole)) == "pdf.locked"
    (tmp_path / "old.ai").write_bytes(b"%!PS-Adobe-3.0\n")
    assert cause(tmp_path / "old.ai") == "pdf.postscript"
    bomb = zlib.compress(bytes(300_000_000), 1)
    (tmp_path / "bomb.pdf").write_bytes(whole.read_bytes() + b"9 0 obj stream\n" + bomb + b"\nendstream")
    assert cause(tmp_path / "bomb.pdf") == "pdf.unpacks"


def layered(path: Path, marked: bool, on: bool) -> Path:
    """A page with a small square, and a large one on a layer: by marks in the page, or as a form that is on it."""
    import pypdf
    from pypdf.generic import (
        ArrayObject,
        DecodedStreamObject,
        DictionaryObject,
        FloatObject,
        NameObject,
        TextStringObject,
    )

    writer = pypdf.PdfWriter()
    page = writer.add_blank_page(300, 200)
    layer = writer._add_object(
        DictionaryObject({NameObject("/Type"): NameObject("/OCG"), NameObject("/Name"): TextStringObject("Guides")})
    )
    large, small = b"10 10 200 180 re f\n", b"250 50 30 30 re f\n"
    form = DecodedStreamObject()
    form.set_data(large)
    form.update({
        NameObject("/Type"): NameObject("/XObject"), NameObject("/Subtype"): NameObject("/Form"),
        NameObject("/BBox"): ArrayObject([FloatObject(value) for value in (0, 0, 300, 200)]),
        NameObject("/OC"): layer,
    })  # fmt: skip
    drawn = DecodedStreamObject()
    drawn.set_data((b"/OC /L BDC\n" + large + b"EMC\n" if marked else b"/F Do\n") + small)
    page[NameObject("/Contents")] = writer._add_object(drawn)
    page[NameObject("/Resources")] = DictionaryObject({
        NameObject("/Properties"): DictionaryObject({NameObject("/L"): layer}),
        NameObject("/XObject"): DictionaryObject({NameObject("/F"): writer._add_object(form)}),
    })  # fmt: skip
    off = ArrayObject([] if on else [layer])
    writer.root_object[NameObject("/OCProperties")] = DictionaryObject({
        NameObject("/OCGs"): ArrayObject([layer]), NameObject("/D"): DictionaryObject({NameObject("/OFF"): off})
    })  # fmt: skip
    writer.write(path)
    return path


@pytest.mark.parametrize("marked", [True, False])
@pytest.mark.parametrize(("on", "points"), [(True, (200, 180)), (False, (30, 30))])
def test_that_layers_that_are_off_are_not_read(marked, on, points, tmp_path) -> None:
    outline = read_target(layered(tmp_path / "layers.pdf", marked, on))
    assert outline.size == pytest.approx(np.array(points) * 25.4 / 72, rel=1e-3)
    assert any("Hidden layers" in note and "Guides" in note for note in outline.notes) is (marked and not on)
