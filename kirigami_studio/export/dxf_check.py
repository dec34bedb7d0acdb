"""Judge any cut file: units, layers, duplicates, gaps in the outline, pieces and the narrowest ligament.

:func:`check_file` reads a DXF of any origin.  A file written here says how many tabs its outline has and how many cuts
end on other cuts, and is held to that; in a foreign file the outline is the largest closed contour.
"""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import shapely
from shapely.geometry import LineString, Polygon
from shapely.geometry.base import BaseGeometry

from kirigami_studio.export.dxf_reading import DxfContent, FilePath, read_content
from kirigami_studio.fabricate.checks import OVERLAP_TOLERANCE_MM
from kirigami_studio.fabricate.cut_plan import LARGEST_SHEET_MM, SMALLEST_SHEET_MM, Layer
from kirigami_studio.fabricate.findings import Problem, Severity
from kirigami_studio.fabricate.finished_sheet import Overlap, overlap, remaining_pieces, smallest_ligament
from kirigami_studio.fabricate.joints import ending_on_others
from kirigami_studio.fabricate.tabs import joined_ring
from kirigami_studio.foundation.errors import ExportError

#: A tab may differ from the width that the file speaks of by this much (mm).
TAB_TOLERANCE_MM = 1e-3
#: Cuts may end this far (mm) beyond the outline: edge cuts run over it on purpose.
REACH_MM = 1.0
#: Contact with the outline below this (mm) is rounding.
TOUCH_MM = 1e-3
#: Machine programs choose the operation by these words in a layer's name (MeerK40t, K40 Whisperer).
TRAP_WORDS = ("CUT", "ENGRAVE")
#: Ends nearer than this (mm) count as the same point.
SAME_POINT_MM = 1e-4
#: Closed cuts that are wider than this (mm) are no slots.
WIDEST_SLOT_MM = 1.5
#: An outline whose ends miss each other by less than this (mm) was meant to be closed.
NEARLY_CLOSED_MM = 0.5


@dataclass(frozen=True, slots=True)
class FileReport:
    """What is in a cut file.

    Attributes
    ----------
    path : Path
    problems : tuple of Problem
    unit : str
        "mm", another unit's name, or "none".
    layers : tuple of str
        Layers that hold entities.
    path_count : int
        Curves that can be cut.
    cut_length_mm, overlap_mm : float
        Length of all curves, and how much of it lies on another curve.
    bounds_mm : (width, height)
        Extent of all curves.
    kerf_mm : float
        The kerf that pieces and ligaments were computed with.
    pieces : int or None
        Pieces of the sheet after cutting; None without a closed outline.
    min_ligament_mm : float or None
        Finished width of the narrowest place between two cuts.
    """

    path: Path
    problems: tuple[Problem, ...]
    unit: str
    layers: tuple[str, ...]
    path_count: int
    cut_length_mm: float
    overlap_mm: float
    bounds_mm: tuple[float, float]
    kerf_mm: float
    pieces: int | None
    min_ligament_mm: float | None

    @property
    def ok(self) -> bool:
        """No errors; there may be warnings."""
        return not any(problem.severity is Severity.ERROR for problem in self.problems)


def check_file(path: str | Path, kerf_mm: float | None = None) -> FileReport:
    """Read a DXF of any origin and list what would go wrong on the cutter.

    Parameters
    ----------
    path : str or Path
    kerf_mm : float, optional
        Full cut width; else what the file says of itself, else 0.

    Raises
    ------
    ExportError
        The file is missing or not a DXF, or the kerf makes no sense.
    """
    content = read_content(Path(path))
    kerf = _kerf(content, kerf_mm)
    problems = [*content.problems, *_layer_problems(content.layers)]
    if not content.paths:
        problems.append(Problem("The file holds nothing that can be cut."))
        return FileReport(Path(path), tuple(problems), content.unit, content.layers, 0, 0.0, 0.0, (0.0, 0.0), kerf,
                          None, None)  # fmt: skip
    lines = [LineString(drawn.points) for drawn in content.paths]
    size = np.ptp(np.concatenate([drawn.points for drawn in content.paths]), axis=0)
    bounds = (float(size[0]), float(size[1]))
    twice = overlap(lines)
    problems += [*_size_problems(bounds), *_double_problems(content.paths, twice)]
    if content.facts.get("TABS", "0") == "0":
        outline = _find_outline(content.paths, problems)
    else:
        outline = tabbed_outline(content, problems)
    problems += placement_problems(content.paths, outline)
    pieces, ligament = _physics(content, outline, kerf, problems)
    length = float(sum(line.length for line in lines))
    return FileReport(Path(path), tuple(problems), content.unit, content.layers, len(lines), length,
                      twice.length_mm, bounds, kerf, pieces, ligament)  # fmt: skip


def _kerf(content: DxfContent, kerf_mm: float | None) -> float:
    text = content.facts.get("KERF_MM", "0") if kerf_mm is None else kerf_mm
    try:
        kerf = float(text)
    except (TypeError, ValueError):
        kerf = float("nan")
    if not 0.0 <= kerf <= LARGEST_SHEET_MM:
        raise ExportError(f"The kerf must be a width in mm of 0 or more, got {text!r}; give the cut's full width.")
    return kerf


def _layer_problems(layers: Sequence[str]) -> list[Problem]:
    trapped = [name for name in layers if any(word in name.upper() for word in TRAP_WORDS)]
    if not trapped:
        return []
    return [
        Problem(
            f"Layer names with CUT or ENGRAVE in them ({', '.join(trapped)}) choose an operation by themselves in "
            f"MeerK40t and K40 Whisperer, so that lines are cut twice or engraved; rename them."
        )
    ]


def _size_problems(bounds: tuple[float, float]) -> list[Problem]:
    if max(bounds) <= LARGEST_SHEET_MM and max(bounds) >= SMALLEST_SHEET_MM:
        return []
    return [
        Problem(
            f"The drawing is {bounds[0]:g} x {bounds[1]:g} mm, outside {SMALLEST_SHEET_MM:g} to "
            f"{LARGEST_SHEET_MM:g} mm; its unit is probably wrong."
        )
    ]


def _double_problems(paths: Sequence[FilePath], twice: Overlap) -> list[Problem]:
    seen: Counter[tuple[tuple[float, float], ...]] = Counter()
    for drawn in paths:
        points = np.round(drawn.points / SAME_POINT_MM).astype(np.int64)
        for start, stop in zip(points[:-1].tolist(), points[1:].tolist(), strict=True):
            seen[tuple(sorted((tuple(start), tuple(stop))))] += 1
    doubles = [(ends, count) for ends, count in seen.items() if count > 1 and ends[0] != ends[1]]
    problems = []
    if doubles:
        (x, y), _ = doubles[0][0]
        where = (x * SAME_POINT_MM, y * SAME_POINT_MM)
        problems.append(
            Problem(
                f"{sum(count - 1 for _, count in doubles)} lines are drawn more than once, the first at "
                f"x = {where[0]:.2f}, y = {where[1]:.2f}; they would be cut twice, so delete the duplicates.",
                Severity.ERROR,
                where,
            )
        )
    if twice.length_mm > OVERLAP_TOLERANCE_MM:
        text = f"{twice.length_mm:.3f} mm of the cuts overlap other cuts; join or trim them."
        problems.append(Problem(text, Severity.ERROR, twice.where))
    return problems


def _find_outline(paths: Sequence[FilePath], problems: list[Problem]) -> Polygon | None:
    """Return the area inside the outline; note when it is open, crosses itself or is missing.

    The outline is what the OUTLINE layer holds; in a foreign file, the largest closed contour, be it one path or a
    chain of lines that meet.
    """
    own = [drawn for drawn in paths if drawn.layer == Layer.OUTLINE.value]
    rings = [Polygon(drawn.points) for drawn in own or paths if drawn.closed and len(drawn.points) > 3]
    if not rings:
        chains = _chains(own or paths)
        rings = [Polygon(chain.coords) for chain in chains if chain.is_closed and len(chain.coords) > 3]
        if not rings:
            problems.append(_open_outline(chains))
            return None
        text = "The outline consists of lines that meet but is no closed polyline; some machines see it as open."
        problems.append(Problem(text, Severity.WARNING))
    outline = max(rings, key=lambda ring: float(ring.area))
    if not outline.is_valid:
        where = shapely.get_coordinates(outline)[0]
        problems.append(
            Problem("The outline crosses itself; redraw it.", Severity.ERROR, (float(where[0]), float(where[1])))
        )
        return None
    return outline


def _chains(paths: Sequence[FilePath]) -> list[LineString]:
    """Join lines whose ends meet, each piece of line used once."""
    snapped = shapely.set_precision(shapely.multilinestrings([LineString(drawn.points) for drawn in paths]), 1e-6)
    merged = shapely.line_merge(shapely.union_all(snapped))
    return [part for part in shapely.get_parts(merged) if isinstance(part, LineString)]


def _open_outline(chains: Sequence[LineString]) -> Problem:
    gaps = [(chain.length, shapely.Point(chain.coords[0]).distance(shapely.Point(chain.coords[-1])), chain)
            for chain in chains]  # fmt: skip
    nearly = [entry for entry in gaps if entry[1] < NEARLY_CLOSED_MM and entry[0] > SMALLEST_SHEET_MM]
    if not nearly:
        return Problem("The file has no closed outline, so the sheet would not come free; add one closed contour.")
    _, gap, chain = max(nearly, key=lambda entry: entry[0])
    x, y = chain.coords[0]
    text = f"The outline is open by {gap:.3f} mm at x = {x:.2f}, y = {y:.2f}; close it."
    return Problem(text, Severity.ERROR, (float(x), float(y)))


def tabbed_outline(content: DxfContent, problems: list[Problem]) -> Polygon | None:
    """Return the area inside the outline with its tabs closed; note gaps that are no tabs.

    Parameters
    ----------
    content : DxfContent
        Its facts hold ``TABS``, ``TAB_MM`` and ``KERF_MM``.
    problems : list of Problem
        Findings are added to it.
    """
    parts = [drawn for drawn in content.paths if drawn.layer == Layer.OUTLINE.value]
    if not parts and content.facts["TABS"].isdecimal():
        # A file with everything on one layer: its outline comes last.
        parts = content.paths[-int(content.facts["TABS"]) :]
    closed = sum(drawn.closed for drawn in parts)
    if closed or f"{len(parts)}" != content.facts["TABS"]:
        text = (
            f"The file speaks of {content.facts['TABS']} tabs, but its outline consists of {len(parts)} paths, "
            f"{closed} of them closed; write the file again."
        )
        x, y = parts[0].points[-1] if parts else (0.0, 0.0)
        problems.append(Problem(text, Severity.ERROR, (float(x), float(y))))
        return None
    wanted = _number(content, "TAB_MM") + _number(content, "KERF_MM")
    ends = np.array([drawn.points[[0, -1]] for drawn in parts]).reshape(-1, 2)
    away = np.linalg.norm(ends[:, None] - ends, axis=2)
    np.fill_diagonal(away, np.inf)
    gaps = away.min(axis=1)
    # Not above, so that a fact that is no number counts as a fault.
    if not np.all(np.abs(gaps - wanted) <= TAB_TOLERANCE_MM):
        worst = int(np.argmax(np.abs(gaps - wanted)))
        x, y = ends[worst]
        text = (
            f"The outline is open by {gaps[worst]:.3f} mm at x = {x:.2f}, y = {y:.2f}, where the file speaks of tabs "
            f"with gaps of {wanted:.3f} mm; write the file again."
        )
        problems.append(Problem(text, Severity.ERROR, (float(x), float(y))))
        return None
    return Polygon(joined_ring([drawn.points for drawn in parts]))


def _number(content: DxfContent, key: str) -> float:
    try:
        return float(content.facts.get(key, "nan"))
    except ValueError:
        return math.nan


def placement_problems(paths: Sequence[FilePath], outline: Polygon | None) -> list[Problem]:
    """List cuts outside the outline, slits that cross it, coordinates below the origin, and cuts after the outline."""
    problems: list[Problem] = []
    low = np.concatenate([drawn.points for drawn in paths]).min(axis=0)
    if low.min() < -TOUCH_MM:
        text = f"Coordinates go down to ({low[0]:.2f}, {low[1]:.2f}); some machines cut off what lies below the origin."
        problems.append(Problem(text, Severity.WARNING))
    if outline is None:
        return problems
    inside, reach = outline.buffer(-TOUCH_MM), outline.buffer(REACH_MM)
    lines = [LineString(drawn.points) for drawn in paths]
    for drawn, line in zip(paths, lines, strict=True):
        x, y = drawn.points[0]
        if not line.within(reach):
            text = f"The cut at x = {x:.2f}, y = {y:.2f} leaves the sheet; move it inside the outline or delete it."
            problems.append(Problem(text, Severity.ERROR, (float(x), float(y))))
        elif drawn.layer == Layer.SLITS.value and not line.within(inside):
            text = f"The slit at x = {x:.2f}, y = {y:.2f} reaches the outline; no connector is left at its end."
            problems.append(Problem(text, Severity.ERROR, (float(x), float(y))))
    ring = outline.exterior.buffer(TOUCH_MM)
    on_ring = np.array([bool(shapely.within(line, ring)) for line in lines])
    if on_ring.any() and not on_ring[-1]:
        text = "Cuts come after the outline in the file; the sheet may move once it is free, so cut the outline last."
        problems.append(Problem(text, Severity.WARNING))
    return problems


def _physics(
    content: DxfContent, outline: Polygon | None, kerf: float, problems: list[Problem]
) -> tuple[int | None, float | None]:
    """Cut the sheet: number of pieces and narrowest ligament."""
    if outline is None:
        return None, None
    ring = outline.exterior
    near_ring = ring.buffer(SAME_POINT_MM)
    inner = [drawn for drawn in content.paths if not LineString(drawn.points).within(near_ring)]
    holes = [Polygon(drawn.points) for drawn in inner if drawn.closed and len(drawn.points) > 3]
    problems += _loose_discs(inner)
    sheet: BaseGeometry = outline.difference(shapely.union_all([hole for hole in holes if hole.is_valid]))
    cuts, joined = _inner_cuts(inner, content.facts, problems)
    left = remaining_pieces(sheet, cuts, kerf)
    pieces = len(left)
    if pieces != 1:
        loose = left[1].representative_point() if left else outline.centroid
        text = f"The sheet falls into {pieces} pieces with a kerf of {kerf:g} mm; leave wider connectors."
        problems.append(Problem(text, Severity.ERROR, (float(loose.x), float(loose.y))))
    ligament = smallest_ligament(cuts, ring, kerf, joined)
    if ligament is None:
        return pieces, None
    if ligament.width_mm <= 0 and pieces == 1:
        # In a foreign drawing cuts may cross on purpose; in ours a connector is lost.
        ours = any(drawn.layer in (Layer.SLITS.value, Layer.EDGE_SLITS.value) for drawn in content.paths)
        x, y = ligament.where
        text = f"Cuts run into each other at x = {x:.2f}, y = {y:.2f}; no connector is left there."
        problems.append(Problem(text, Severity.ERROR if ours else Severity.WARNING, ligament.where))
    return pieces, ligament.width_mm


def _loose_discs(inner: Sequence[FilePath]) -> list[Problem]:
    """Closed cuts inside the outline, beside relief holes and slots: what they enclose falls out."""
    closed = [Polygon(drawn.points) for drawn in inner if drawn.closed and drawn.layer != Layer.RELIEF.value
              and len(drawn.points) > 3]  # fmt: skip
    # Twice the area over half the length: about the width of a slot, the radius of a disc.
    wide = [ring for ring in closed if 4.0 * ring.area > WIDEST_SLOT_MM * 2.0 * ring.length]
    if not wide:
        return []
    largest = max(wide, key=lambda ring: float(ring.area))
    x, y = largest.centroid.coords[0]
    size = math.sqrt(4.0 * largest.area / math.pi)
    return [
        Problem(
            f"{len(wide)} closed cuts inside the outline let a part fall out, the largest one, about {size:.1f} mm "
            f"across, at x = {x:.2f}, y = {y:.2f}; make sure that it is meant.",
            Severity.WARNING,
            (float(x), float(y)),
        )
    ]


def _inner_cuts(
    inner: Sequence[FilePath], facts: Mapping[str, str], problems: list[Problem]
) -> tuple[list[LineString], set[tuple[int, int]]]:
    """All cuts but the outline, and which of them meet on purpose.

    Lines of a foreign file are joined to chains.  A file of ours says how many cuts end on another one (slits on their
    relief holes, arcs and bars, and on each other where a connector was removed).
    """
    if "JOINS" not in facts:
        return (_chains(inner) if inner else []), set()
    lines = [LineString(drawn.points) for drawn in inner]
    ends = ending_on_others(lines)
    if f"{len(ends)}" == facts["JOINS"]:
        return lines, set(ends)
    x, y = shapely.get_coordinates(lines[ends[0][0]])[0] if ends else inner[0].points[0]
    text = (
        f"{len(ends)} cuts end on another cut where the file speaks of {facts['JOINS']}: a connector is lost or a slit "
        f"misses its end; write the file again."
    )
    problems.append(Problem(text, Severity.ERROR, (float(x), float(y))))
    return lines, set()
