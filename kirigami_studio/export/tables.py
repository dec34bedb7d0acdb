"""Tables of parts and hinges, flat and at the target angle, as CSV."""

from __future__ import annotations

import csv
import io
import math
from collections.abc import Iterable
from pathlib import Path

from shapely.geometry import Polygon

from kirigami_studio.assembly.pieces import Assembly
from kirigami_studio.export.exporter import ExportJob
from kirigami_studio.export.linkage import linkage_of
from kirigami_studio.foundation.errors import ExportError
from kirigami_studio.foundation.files import write_atomically

#: Decimals of lengths (mm), areas (mm^2) and angles (degrees).
DECIMALS = 9
#: Columns; angles are those by which a part has turned since it lay flat.
PARTS = ("part", "layer", "row", "column", "area_mm2", "flat_x_mm", "flat_y_mm", "target_x_mm", "target_y_mm",
         "target_turn_deg", "corners")  # fmt: skip
HINGES = ("node", "part", "other_part", "flat_x_mm", "flat_y_mm", "target_x_mm", "target_y_mm")

Rows = list[list[str]]


def write_tables(job: ExportJob, path: Path) -> tuple[Path, Path]:
    """Write ``NAME.csv`` of the parts and ``NAME-hinges.csv``, and read them back; return both.

    Raises
    ------
    ExportError
        An unwritable place, or a file that did not read back.
    """
    linkage = linkage_of(job)
    hinges = path.with_name(f"{path.stem}-hinges{path.suffix}")
    for place, rows in ((path, part_rows(linkage)), (hinges, hinge_rows(linkage))):
        _write(place, rows)
    return path, hinges


def part_rows(linkage: Assembly) -> Rows:
    """A row for each part: places of its panel's middle, turn, outline in the flat sheet, mm."""
    flat, target = linkage.poses(math.pi), linkage.poses(linkage.phi_target)
    rows: Rows = [list(PARTS)]
    for piece, here, there in zip(linkage.pieces, flat.tolist(), target.tolist(), strict=True):
        area = Polygon(piece.outline, piece.openings).area
        corners = "; ".join(f"{x:.{DECIMALS}g} {y:.{DECIMALS}g}" for x, y in (piece.outline + here[:2]).tolist())
        figures = _numbers([area, *here[:2], *there[:2], math.degrees(there[2])])
        rows.append([piece.id, str(piece.layer), *(str(1 + at) for at in piece.panel), *figures, corners])
    return rows


def hinge_rows(linkage: Assembly) -> Rows:
    """A row for each hinge: its two parts, and where it is, mm."""
    rows: Rows = [list(HINGES)]
    for hinge in linkage.hinges:
        piece = linkage.by_id[hinge.pieces[0]]
        places = [linkage.placed(piece, hinge.at[0], phi).tolist() for phi in (math.pi, linkage.phi_target)]
        rows.append([str(hinge.node), *hinge.pieces, *_numbers([*places[0], *places[1]])])
    return rows


def _numbers(figures: Iterable[float]) -> list[str]:
    return [f"{round(figure, DECIMALS) + 0.0:.12g}" for figure in figures]


def _write(path: Path, rows: Rows) -> None:
    text = io.StringIO(newline="")
    csv.writer(text, lineterminator="\r\n").writerows(rows)

    def verify(written: Path) -> None:
        with written.open(encoding="utf-8", newline="") as stream:
            if list(csv.reader(stream)) != rows:
                raise ExportError("linkage.not_as_written", name=path.name)

    write_atomically(path, text.getvalue().encode("utf-8"), verify)
