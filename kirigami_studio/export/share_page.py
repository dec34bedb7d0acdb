"""A page to share: one HTML file with the exact motion and the project, without network.

Every part of the sheet is rigid and its corners move as ``A + B exp(-i phi)`` (Eq. 1): in the page a part has its own
corners, which turn one way, and one vector that carries it and turns the other way.  A policy in the page allows its
own style and script alone, by their SHA-256, and no connection.
"""

from __future__ import annotations

import base64
import hashlib
import html
import io
import json
import math
import string
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import shapely

from kirigami_studio import __version__
from kirigami_studio.evaluate.boundary import as_plane, as_points
from kirigami_studio.evaluate.posed_design import PosedDesign
from kirigami_studio.export.artwork import Artwork
from kirigami_studio.export.artwork_patches import PrintedSheet, printed_patches
from kirigami_studio.export.artwork_raster import BitmapFrame, paint
from kirigami_studio.export.exporter import ExportJob
from kirigami_studio.export.picture import PlacedLayout, spread
from kirigami_studio.foundation.arrays import ComplexArray, FloatArray, as_rings
from kirigami_studio.foundation.errors import ExportError
from kirigami_studio.foundation.files import write_atomically
from kirigami_studio.foundation.resources import resource
from kirigami_studio.foundation.words import language, tr, tr_n

#: Outlines (P, 2) of all parts at an angle (radians), world.
Outlines = Callable[[float], list[FloatArray]]
#: Decimals of coordinates in mm.
DECIMALS = 3
#: Angles at which the box around the motion is looked for, and room around it, share of its longer side.
LOOKS, MARGIN = 33, 0.03
#: Artwork is drawn with so many pixels along the longer side of the flat sheet.
PICTURE_SIDE, JPEG_QUALITY = 1400, 82
#: Share of the way that a page shows first: open enough to see that it moves.
FIRST_SHARE = 1.0


def write_page(job: ExportJob, path: str | Path) -> None:
    """Write the page of a design, and read it back.

    Raises
    ------
    ExportError
        An unwritable place, or a page that did not read back.
    """
    _write(page_of(job, Path(path).stem), path)


def write_parts_page(parts: Sequence[PlacedLayout], path: str | Path) -> None:
    """Write the page of the designs of all parts: their flat sheets come together as they open.

    The first has the project of all as its record.

    Raises
    ------
    ExportError
        An unwritable place, or a page that did not read back.
    """
    _write(page_of(parts[0].job, Path(path).stem, spread(parts)), path)


def _write(page: tuple[str, dict[str, Any]], path: str | Path) -> None:
    content, data = page

    def verify(written: Path) -> None:
        if read_page(written) != data:
            raise ExportError("page.not_as_written", name=Path(path).name)

    write_atomically(Path(path), content.encode("utf-8"), verify)


def read_page(path: Path) -> dict[str, Any]:
    """The motion that a page shows, as it stands in the page.

    Raises
    ------
    ExportError
        No page of this program.
    """
    text = path.read_text(encoding="utf-8")
    begin = '<script type="application/json" id="design">'
    if begin not in text:
        raise ExportError("page.not_as_written", name=path.name)
    found: dict[str, Any] = json.loads(text.split(begin, 1)[1].split("</script>", 1)[0])
    return found


def page_of(job: ExportJob, stem: str, sheets: Sequence[PlacedLayout] = ()) -> tuple[str, dict[str, Any]]:
    """The page as text, and its motion: lengths in mm, y up, the middle of all nodes at (0, 0).

    ``stem`` is the name, without extension, of the project that a reader saves from it.  Where there are ``sheets``,
    these are shown in their places, in the frame of the drawing.
    """
    pieces = None if job.pieces is None else job.pieces.small
    posed = job.posed if pieces is None else pieces.design
    scale = posed.mm_per_world(job.width_mm) if pieces is None else pieces.mm_per_world
    known = (job.provenance.get("target"), job.provenance.get("name"))
    name = " \N{MIDDLE DOT} ".join(text for text in known if text) or tr("Kirigami design")
    moving = [_MovingSheet.of(sheet) for sheet in sheets] or [_MovingSheet.of(_alone(job, scale, _middle(posed)))]
    box = _with_room(np.concatenate([sheet.ends() for sheet in moving]))
    data: dict[str, Any] = {
        "phi": posed.phi_target,
        "turn": _turn(posed),
        "shown": FIRST_SHARE,
        "size": [round(float(side), DECIMALS) for side in np.ptp(box, axis=0)],
        "file": f"{stem}.kiri",
        "parts": [
            [odd, _numbers(np.array([carried])), _numbers(own), *([number] if sheets else [])]
            for number, sheet in enumerate(moving)
            for odd, carried, own in sheet.parts
        ],
    }
    if sheets:
        # Angle over the target, turn, and place over the target and while flat of each.
        data["sheets"] = [
            [one.posed.phi_target, one.turn, *_numbers(np.array([one.place(0.0), one.place(1.0)]))] for one in moving
        ]
    picture = ""
    if job.artwork is not None and pieces is None and not sheets:
        picture, data["print"] = _print_of(job.artwork, posed, job, scale)
    target = [ring for sheet in moving for ring in sheet.target]
    (left, bottom), (right, top) = box.tolist()
    style, script = (resource("share", f"page.{kind}").read_text(encoding="utf-8") for kind in ("css", "js"))
    template = string.Template(resource("share", "page.html").read_text(encoding="utf-8"))
    said = {
        "language": language(),
        "generator": f"Kirigami Studio {__version__}",
        "title": name,
        "subtitle": _subtitle(job, posed)
        if not sheets
        else tr_n("{count} sheet, to one scale", "{count} sheets, to one scale", len(sheets)),
        "noscript": tr("This page moves by its own script. Allow scripts to see it."),
        "play": tr("Play"),
        "pause": tr("Pause"),
        "angle": tr("Opening"),
        "flat": tr("Flat"),
        "half": tr("Half open"),
        "opened": tr("Closed over the target") if posed.phi_target == 0.0 else tr("At the target angle"),
        "outline": tr("Target outline"),
        "colour": tr("Colours"),
        "print": tr("Print at true size"),
        "save": tr("Save the project"),
        "made": tr("How it was made"),
        "footer": tr("Made with Kirigami Studio. The page needs no network and sends nothing."),
    }
    fields = {key: html.escape(text) for key, text in said.items()} | {
        "policy": "default-src 'none'; img-src data:; base-uri 'none'; form-action 'none'; "
        f"style-src '{_digest(style)}'; script-src '{_digest(script)}'",
        "box": f"{left:.3f} {-top:.3f} {right - left:.3f} {top - bottom:.3f}",
        "target": " ".join(map(_path, target)),
        "outlined": "" if target else " hidden",
        "unsaved": "" if job.record else " hidden",
        "facts": "".join(
            f"<tr><td>{html.escape(key.replace('_', ' '))}</td><td>{html.escape(text)}</td></tr>"
            for key, text in sorted(job.provenance.items())
        ),
        "design": json.dumps(data, separators=(",", ":"), allow_nan=False).replace("<", "\\u003c"),
        "project": base64.b64encode(job.record).decode("ascii"),
        "picture": picture,
        "style": style,
        "script": script,
    }
    return template.substitute(fields), data


def _digest(text: str) -> str:
    return "sha256-" + base64.b64encode(hashlib.sha256(text.encode("utf-8")).digest()).decode("ascii")


def _subtitle(job: ExportJob, posed: PosedDesign) -> str:
    """Match, grid and width."""
    rows, columns = job.deployment.sheet.grid
    grid = tr("{rows} \N{MULTIPLICATION SIGN} {columns} voids", rows=rows, columns=columns)
    size = tr("{width:g} mm wide when flat", width=job.width_mm)
    match = job.match if job.trim is None or job.match is not None else job.trim.iou
    if match is None and job.target is not None:
        shape = shapely.make_valid(shapely.Polygon(posed.outline(posed.nodes(posed.phi_target), posed.phi_target)))
        outer, *holes = as_rings(job.target)
        target = shapely.Polygon(outer, holes)
        match = shape.intersection(target).area / shape.union(target).area
    shown = [] if match is None else [tr("Match {percent:.1f} %", percent=100.0 * match)]
    return " \N{MIDDLE DOT} ".join([*shown, grid, size])


def _middle(posed: PosedDesign) -> complex:
    """The middle of all nodes, which stays where it is at all angles."""
    return complex(as_plane(posed.nodes(posed.phi_target)).mean())


def _turn(posed: PosedDesign) -> float:
    """By what the sheet turns on its way from the target angle to the flat sheet, radians."""
    return posed.turn if posed.phi_target < math.pi else 0.0


def _moving_parts(posed: PosedDesign, outlines: Outlines, scale: float) -> list[tuple[int, complex, ComplexArray]]:
    """For every part, mm: whether it turns by +a, the vector that carries it, its own corners.

    Two angles tell both: without the pose's turn a corner is ``exp(-i a) U + exp(i a) V`` with 2 a = pi - phi, and one
    of U and V is the same for all corners of a part, that of its neighbours.
    """
    middle, back = _middle(posed), np.exp(-1j * _turn(posed))
    flat = [(as_plane(part) - middle) * back for part in outlines(math.pi)]
    shut = [as_plane(part) - middle for part in outlines(0.0)]
    found = []
    for z_flat, z_shut in zip(flat, shut, strict=True):
        both = 0.5 * (z_flat + 1j * z_shut) * scale, 0.5 * (z_flat - 1j * z_shut) * scale
        odd = int(np.ptp(both[0].real) + np.ptp(both[0].imag) < np.ptp(both[1].real) + np.ptp(both[1].imag))
        found.append((odd, complex(both[1 - odd].mean()), both[odd]))
    return found


def _alone(job: ExportJob, scale: float, middle: complex) -> PlacedLayout:
    """A design by itself, the middle of its nodes at (0, 0)."""
    shift = -scale * as_points(np.array([middle]))[0]
    return PlacedLayout(job, scale, shift, shift)


@dataclass(frozen=True, slots=True, eq=False)
class _MovingSheet:
    """The parts of a sheet, or its pieces, and where it is."""

    layout: PlacedLayout
    posed: PosedDesign
    parts: list[tuple[int, complex, ComplexArray]]  #: seen from the middle of all nodes, mm

    @classmethod
    def of(cls, layout: PlacedLayout) -> _MovingSheet:
        job = layout.job
        pieces = None if job.pieces is None else job.pieces.small
        posed = job.posed if pieces is None else pieces.design
        outlines = posed.parts if pieces is None else pieces.outlines
        return cls(layout, posed, _moving_parts(posed, outlines, layout.mm))

    @property
    def turn(self) -> float:
        return _turn(self.posed)

    def place(self, left: float) -> complex:
        """The middle of all nodes, mm, at a share of the way from the target."""
        shift: complex = as_plane(self.layout.place(left)[None])[0]
        return shift + self.layout.mm * _middle(self.posed)

    @property
    def target(self) -> list[ComplexArray]:
        """Rings of the target where it is opened to, mm."""
        return [as_plane(self.layout.put(ring)) for ring in as_rings(self.layout.job.target)]

    def ends(self) -> Any:
        """Corners (2 LOOKS, 2), mm, of the boxes around it on its way."""
        ends, end = [], self.posed.phi_target
        for left in np.linspace(0.0, 1.0, LOOKS).tolist():
            phi = end + left * (math.pi - end)
            at = as_points(np.array([self.place(left)]))[0]
            points = at + np.concatenate([corners_at(part, end, self.turn, phi) for part in self.parts])
            ends += [points.min(axis=0), points.max(axis=0)]
        return np.stack(ends)


def _with_room(points: Any) -> Any:
    """Lower left and upper right corner (2, 2) of the box around points (P, 2), with room."""
    low, high = points.min(axis=0), points.max(axis=0)
    room = MARGIN * float((high - low).max())
    return np.stack([low - room, high + room])


def corners_at(part: tuple[int, complex, ComplexArray], target_phi: float, turn: float, phi: float) -> Any:
    """Corners (P, 2) of a part at an angle, by the page's own formula."""
    odd, carried, own = part
    half = 0.5 * (math.pi - phi)
    back = turn * max((phi - target_phi) / (math.pi - target_phi), 0.0) if target_phi < math.pi else 0.0
    ways = back - half, back + half
    return as_points(np.exp(1j * ways[odd]) * own + np.exp(1j * ways[1 - odd]) * carried)


def _print_of(artwork: Artwork, posed: PosedDesign, job: ExportJob, scale: float) -> tuple[str, dict[str, object]]:
    """The print of the flat sheet as a data address, and where it lies in the page."""
    sheet = PrintedSheet.uncut(posed, job.target, job.width_mm)
    low, high = sheet.corners.min(axis=(0, 1)), sheet.corners.max(axis=(0, 1))
    dpi = 25.4 * PICTURE_SIDE / float((high - low).max())
    frame = BitmapFrame((float(low[0]), float(low[1])), (float(high[0]), float(high[1])), dpi)
    stream = io.BytesIO()
    painted = paint(printed_patches(artwork, sheet, 0.0, 0.0), frame, (255, 255, 255, 255)).convert("RGB")
    painted.save(stream, format="JPEG", quality=JPEG_QUALITY)
    # From the flat sheet's own frame to the page's: both know the same nodes.
    here = (as_plane(posed.nodes(math.pi)) - _middle(posed)) * scale
    there = as_plane(posed.deployment.compact - posed.deployment.compact.min(axis=0))
    there *= job.width_mm / float(np.ptp(posed.deployment.compact[:, 0]))
    factor = (here[-1] - here[0]) / (there[-1] - there[0])
    shift = here[0] - factor * there[0]
    corner = factor * complex(float(low[0]), float(high[1])) + shift
    address = "data:image/jpeg;base64," + base64.b64encode(stream.getvalue()).decode("ascii")
    turned = f"translate({corner.real:.3f} {-corner.imag:.3f}) rotate({-math.degrees(np.angle(factor)):.4f})"
    width, height = frame.pixels
    return address, {
        "width": round(width / frame.dots_per_mm, DECIMALS),
        "height": round(height / frame.dots_per_mm, DECIMALS),
        "transform": turned,
    }


def _numbers(points: ComplexArray) -> list[float]:
    """x and y of points, one after the other, rounded."""
    return [round(float(value), DECIMALS) for value in as_points(points).ravel()]


def _path(points: ComplexArray) -> str:
    """An SVG path around points, y down."""
    return "M" + "L".join(f"{point.real:.3f} {-point.imag:.3f}" for point in points) + "Z"
