"""Cut plan -> PDF at 1:1 for scissors, paper and checking by eye, with a ruler to see whether the printer scaled it."""

from __future__ import annotations

import re
from dataclasses import dataclass
from io import BytesIO
from pathlib import Path
from typing import Any

from reportlab.lib.units import mm
from reportlab.pdfgen.canvas import Canvas

from kirigami_studio.export import palette
from kirigami_studio.export.exporter import ExportJob
from kirigami_studio.export.palette import Colour
from kirigami_studio.export.verified import write_verified
from kirigami_studio.fabricate.cut_plan import CutPlan
from kirigami_studio.foundation.errors import ExportError

MARGIN_MM = 10.0
#: Room below the sheet for the ruler and its words.
FOOTER_MM = 14.0
RULER_MM = 50.0
CUT_LINE_MM = 0.1


@dataclass(frozen=True, slots=True)
class PdfExporter:
    """Cut plan as PDF."""

    extension: str = ".pdf"
    name: str = "PDF at 1:1"

    def write(self, job: ExportJob, path: Path) -> None:
        """Write the job's cut plan."""
        write_pdf(job.required_plan, path)


def write_pdf(plan: CutPlan, path: str | Path) -> None:
    """Write one page that is as large as the sheet; printed at 100 % it is 1:1.

    Raises
    ------
    ExportError
        The place cannot be written, or the file did not read back.
    """
    page = page_size_mm(plan)
    content = _pdf_bytes(plan, page)

    def verify(written: Path) -> None:
        read = written.read_bytes()
        box = re.search(rb"/MediaBox \[ 0 0 ([\d.]+) ([\d.]+) \]", read)
        size = tuple(float(side) / mm for side in box.groups()) if box else (0.0, 0.0)
        whole = read.startswith(b"%PDF-") and read.rstrip().endswith(b"%%EOF")
        if not whole or max(abs(a - b) for a, b in zip(size, page, strict=True)) > 1e-3:
            raise ExportError(f"The PDF did not read back: page {size} instead of {page} mm. Nothing was written.")

    write_verified(Path(path), content, verify)


def page_size_mm(plan: CutPlan) -> tuple[float, float]:
    """Width and height of the page: everything that is cut, a margin, and a footer with the ruler."""
    width, height = plan.bounds_mm
    return max(width, RULER_MM) + 2.0 * MARGIN_MM, height + 2.0 * MARGIN_MM + FOOTER_MM


def _pdf_bytes(plan: CutPlan, page: tuple[float, float]) -> bytes:
    stream = BytesIO()
    # reportlab carries no types; invariant: the same plan gives the same bytes.
    make_canvas: Any = Canvas
    canvas = make_canvas(stream, pagesize=(page[0] * mm, page[1] * mm), invariant=1, pageCompression=0)
    canvas.setTitle(f"Kirigami cut plan {plan.design_hash}")
    canvas.setCreator("Kirigami Studio")
    left, bottom = MARGIN_MM, MARGIN_MM + FOOTER_MM
    canvas.setLineWidth(CUT_LINE_MM * mm)
    canvas.setLineCap(1)
    for layer in plan.layers:
        _stroke_colour(canvas, palette.LAYER_COLOUR[layer])
        for cut in plan.on_layer(layer):
            line = canvas.beginPath()
            (x, y), *rest = cut.flattened.tolist()
            line.moveTo((left + x) * mm, (bottom + y) * mm)
            for x, y in rest:
                line.lineTo((left + x) * mm, (bottom + y) * mm)
            if cut.closed:
                line.close()
            canvas.drawPath(line)
    _draw_ruler(canvas, plan, left)
    canvas.showPage()
    canvas.save()
    return stream.getvalue()


def _draw_ruler(canvas: Any, plan: CutPlan, left: float) -> None:
    base = MARGIN_MM
    _stroke_colour(canvas, palette.INK)
    canvas.line(left * mm, base * mm, (left + RULER_MM) * mm, base * mm)
    for tick in range(0, int(RULER_MM) + 1, 10):
        canvas.line((left + tick) * mm, base * mm, (left + tick) * mm, (base + 2.0) * mm)
    canvas.setFont("Helvetica", 7)
    canvas.drawString(left * mm, (base + 7.0) * mm, f"Print at 100 %. This ruler is {RULER_MM:g} mm long.")
    sheet = f"Sheet {plan.size_mm[0]:.1f} x {plan.size_mm[1]:.1f} mm, connectors {plan.connector_mm:g} mm"
    canvas.drawString(left * mm, (base + 3.5) * mm, sheet)


def _stroke_colour(canvas: Any, colour: Colour) -> None:
    canvas.setStrokeColorRGB(*(channel / 255.0 for channel in colour))
