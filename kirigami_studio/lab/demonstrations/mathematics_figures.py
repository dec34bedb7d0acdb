"""The figures of ``docs/mathematics.md``, drawn from the program's own geometry: ``make figures``.

``python -m kirigami_studio.lab.demonstrations.mathematics_figures --out docs/pictures/mathematics`` writes them as SVG.
Blue is the sheet, orange the target, as in the window; the same program writes the same bytes.
"""

from __future__ import annotations

import argparse
import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from functools import cache
from pathlib import Path
from xml.sax.saxutils import escape

import numpy as np
import shapely

from kirigami_studio.evaluate.similarity import Similarity
from kirigami_studio.evaluate.siou import ShapeMatch, siou_near, siou_of_many
from kirigami_studio.foundation.arrays import FloatArray
from kirigami_studio.lab.baselines.marching import march, void_angle
from kirigami_studio.lab.benchmark.line_chart import Curve, LineChart
from kirigami_studio.lattice.compact import barycentric_stencil
from kirigami_studio.lattice.deployment import Deployment, deploy
from kirigami_studio.lattice.ratio_field import RatioField
from kirigami_studio.outlines import silhouettes
from kirigami_studio.outlines.outline import Outline
from kirigami_studio.polish.levenberg import polish

SHEET, SHEET_LINE, TARGET, EVEN, ODD, INK, FAINT = (
    "#cfe0f3", "#2f6fb5", "#e07b00", "#7fb2e5", "#f3c78f", "#1d2733", "#9aa7b5",
)  # fmt: skip
#: Pixels around a drawing, and of letters.
MARGIN, LETTERS = 14.0, 15
#: Seeds, ratios and grids of the figures.
SEED, SMALL, GRIDS, FIELDS = 3, 4, (4, 6, 8, 10, 12, 16, 20, 24), 20


@dataclass(slots=True)
class FigureDrawing:
    """Shapes in the plane (y up), collected and written at a scale.

    Attributes
    ----------
    scale : float
        Pixels of one unit.
    """

    scale: float
    _parts: list[Callable[[Callable[[FloatArray], FloatArray]], str]] = field(default_factory=list)
    _points: list[FloatArray] = field(default_factory=list)

    def shape(
        self, points: FloatArray, *, fill: str = "none", line: str = "none", width: float = 1.2, closed: bool = True,
        dashes: str = "", opacity: float = 1.0,
    ) -> None:  # fmt: skip
        """A polygon, or a line through points (K, 2)."""
        self._points.append(points)
        end = "Z" if closed else ""
        style = f'fill="{fill}" stroke="{line}" stroke-width="{width}" stroke-linejoin="round"'
        style += (f' stroke-dasharray="{dashes}"' if dashes else "") + (
            f' fill-opacity="{opacity}"' if opacity < 1 else ""
        )
        self._parts.append(lambda place: f'<path d="M{_pairs(place(points), " L")}{end}" {style}/>')

    def region(self, shape: shapely.Geometry, fill: str) -> None:
        """A filled region with its holes."""
        for polygon in shapely.get_parts(shape):
            if isinstance(polygon, shapely.Polygon) and polygon.area > 0:
                rings = [np.array(ring.coords)[:-1] for ring in (polygon.exterior, *polygon.interiors)]
                self._points.extend(rings)
                self._parts.append(
                    lambda place, rings=rings: (  # type: ignore[misc]
                        f'<path fill="{fill}" fill-rule="evenodd" d="'
                        + " ".join(f"M{_pairs(place(ring), ' L')}Z" for ring in rings)
                        + '"/>'
                    )
                )

    def dot(self, point: FloatArray, colour: str = INK, radius: float = 3.2) -> None:
        """A disc of so many pixels."""
        self._points.append(point[np.newaxis])

        def drawn(place: Callable[[FloatArray], FloatArray]) -> str:
            (x, y) = place(point[np.newaxis])[0]
            return f'<circle cx="{x:.2f}" cy="{y:.2f}" r="{radius}" fill="{colour}"/>'

        self._parts.append(drawn)

    def word(self, point: FloatArray, text: str, *, shift: tuple[float, float] = (0.0, 0.0), size: int = LETTERS,
             anchor: str = "middle", colour: str = INK) -> None:  # fmt: skip
        """Text at a point, shifted by pixels (right, down); ``_`` puts what follows below the line."""
        at = point[np.newaxis] + np.array([[shift[0], -shift[1]]]) / self.scale
        half = 0.3 * size * len(text.replace("_", "")) / self.scale
        sides = {"middle": (-half, half), "start": (0.0, 2 * half), "end": (-2 * half, 0.0)}[anchor]
        high = size / self.scale
        self._points.append(
            np.array([[at[0, 0] + side, at[0, 1] + up] for side in sides for up in (-0.3 * high, high)])
        )
        body, _, below = escape(text).partition("_")
        small = f'<tspan dy="{round(0.25 * size)}" font-size="{round(0.72 * size)}">{below}</tspan>' if below else ""

        def drawn(place: Callable[[FloatArray], FloatArray]) -> str:
            (x, y) = place(at)[0]
            return (
                f'<text x="{x:.2f}" y="{y:.2f}" font-family="sans-serif" font-size="{size}" fill="{colour}" '
                f'text-anchor="{anchor}">{body}{small}</text>'
            )

        self._parts.append(drawn)

    def svg(self) -> bytes:
        """The picture, as large as what is in it."""
        points = np.concatenate(self._points)
        low, high = points.min(axis=0), points.max(axis=0)
        width, height = self.scale * (high - low) + 2 * MARGIN

        def place(given: FloatArray) -> FloatArray:
            return np.stack(
                [MARGIN + self.scale * (given[:, 0] - low[0]), MARGIN + self.scale * (high[1] - given[:, 1])], axis=1
            )

        body = "\n".join(part(place) for part in self._parts)
        return (
            f'<svg xmlns="http://www.w3.org/2000/svg" width="{width:.0f}" height="{height:.0f}" '
            f'viewBox="0 0 {width:.1f} {height:.1f}">\n<rect width="100%" height="100%" fill="#fff"/>\n{body}\n</svg>\n'
        ).encode()


def _pairs(points: FloatArray, between: str) -> str:
    return between.join(f"{x:.2f},{y:.2f}" for x, y in points)


def _small_sheet() -> Deployment:
    """A sheet of 4 x 4 uneven voids."""
    z = np.random.default_rng(SEED).uniform(-0.35, 0.35, (SMALL, SMALL))
    return deploy(RatioField.from_log10(z))


def parity() -> bytes:
    """Half open, even and odd voids in two colours, with their row and column."""
    sheet, drawing, phi = _small_sheet(), FigureDrawing(58.0), math.radians(62.0)
    for panel in sheet.panels(phi).reshape(-1, 4, 2):
        drawing.shape(panel, fill=SHEET, line=SHEET_LINE)
    voids = sheet.voids(phi)
    for i in range(SMALL):
        for j in range(SMALL):
            even = (i + j) % 2 == 0
            drawing.shape(voids[i, j], fill=EVEN if even else ODD, line=SHEET_LINE)
            drawing.word(voids[i, j].mean(axis=0), f"{i},{j}", shift=(0, 4), size=12)
    return drawing.svg()


def void() -> bytes:
    """An even void and its right neighbour, with corners, angle and sides."""
    sheet, drawing, phi = _small_sheet(), FigureDrawing(125.0), math.radians(62.0)
    voids, panels = sheet.voids(phi), sheet.panels(phi)
    for panel in (panels[1, 1], panels[1, 2], panels[2, 1], panels[2, 2], panels[1, 3], panels[2, 3]):
        drawing.shape(panel, fill=SHEET, line=SHEET_LINE)
    for column, name in ((1, "even"), (2, "odd")):
        corners = voids[1, column]
        drawing.shape(corners, fill=EVEN if name == "even" else ODD, line=INK, width=1.8)
        middle = corners.mean(axis=0)
        drawing.word(middle, name, shift=(8, 12), size=14)
        angle = void_angle(1, column, phi)
        first, second = corners[1] - corners[0], corners[3] - corners[0]
        begin = math.atan2(first[1], first[0])
        turns = begin + np.linspace(0.0, angle, 24)
        arc = corners[0] + 0.13 * np.stack([np.cos(turns), np.sin(turns)], axis=1)
        drawing.shape(arc, line=INK, closed=False)
        way = begin + 0.5 * angle
        drawing.word(
            corners[0] + 0.23 * np.array([math.cos(way), math.sin(way)]),
            "\u03c6" if name == "even" else "\u03c0\u2212\u03c6", shift=(4, 5), size=14,
        )  # fmt: skip
        for number, corner in enumerate(corners):
            out = (corner - middle) / np.linalg.norm(corner - middle)
            drawing.dot(corner)
            if not (column == 2 and number == 0):
                drawing.word(corner, f"p_{number}", shift=(16 * out[0], 6 - 16 * out[1]))
        if name == "even":
            for side, what in ((second, "s"), (first, "x s")):
                across = np.array([-side[1], side[0]]) / np.linalg.norm(side)
                across = across if np.dot(across, corners[0] + 0.5 * side - middle) > 0 else -across
                drawing.word(
                    corners[0] + 0.5 * side, what, shift=(15 * across[0], 5 - 15 * across[1]), colour=SHEET_LINE
                )
    return drawing.svg()


def compact() -> bytes:
    """The flat sheet with its slits, and one node between the ends of the slit that it lies on."""
    sheet, drawing = _small_sheet(), FigureDrawing(74.0)
    nodes, tables = sheet.compact, sheet.topology
    drawing.shape(np.array([[0, 0], [SMALL + 1, 0], [SMALL + 1, -SMALL - 1], [0, -SMALL - 1.0]]), fill=SHEET)
    for panel in nodes[tables.panel_nodes].reshape(-1, 4, 2):
        drawing.shape(panel, line=SHEET_LINE, width=1.6)
    for point in nodes[tables.fixed]:
        drawing.dot(point, INK, 3.0)
    node, ends, voids = barycentric_stencil(SMALL, SMALL)
    which = next(k for k in range(len(node)) if voids[k] == SMALL + 1 and not tables.fixed[ends[k]].any())
    first, second = nodes[ends[which]]
    drawing.shape(np.stack([first, second]), line=TARGET, width=4.0, closed=False)
    for point in (first, second):
        drawing.dot(point, TARGET, 4.5)
    drawing.dot(nodes[node[which]], INK, 5.0)
    drawing.word(first, "p_3", shift=(14, -4), colour="#a85c00")
    drawing.word(second, "p_1", shift=(14, 14), colour="#a85c00")
    drawing.word(nodes[node[which]], "p_0", shift=(-14, -6))
    return drawing.svg()


def motion() -> bytes:
    """Four states side by side, even panels darker than odd ones."""
    sheet, drawing, left = _small_sheet(), FigureDrawing(36.0), 0.0
    for degrees in (180.0, 110.0, 50.0, 0.0):
        panels = sheet.panels(math.radians(degrees))
        corners = panels.reshape(-1, 2)
        move = np.array([left - corners[:, 0].min(), -0.5 * (corners[:, 1].min() + corners[:, 1].max())])
        for i, j in np.ndindex(*panels.shape[:2]):
            even = (i + j) % 2 == 0
            drawing.shape(panels[i, j] + move, fill="#b5d0ee" if even else "#dfeaf7", line=SHEET_LINE)
        width = float(np.ptp(corners[:, 0]))
        drawing.word(np.array([left + 0.5 * width, -4.3]), f"\u03c6 = {degrees:.0f}\u00b0", size=14)
        left += width + 0.6
    return drawing.svg()


def paths() -> bytes:
    """Ways of all nodes about their middle, from the flat sheet to the closed one."""
    sheet, drawing = _small_sheet(), FigureDrawing(66.0)
    middles = [sheet.nodes(phi).mean(axis=0) for phi in (math.pi, 0.0)]
    for phi, middle, line in zip((math.pi, 0.0), middles, (SHEET_LINE, TARGET), strict=True):
        drawing.shape(sheet.outline(phi) - middle, line=line, width=1.6)
    angles = np.linspace(math.pi, 0.0, 61)
    ways = np.stack([sheet.nodes(phi) for phi in angles])
    ways = ways - ways.mean(axis=1, keepdims=True)
    for node in range(ways.shape[1]):
        drawing.shape(ways[:, node], line=FAINT, width=1.1, closed=False)
        drawing.dot(ways[0, node], SHEET_LINE, 2.6)
        drawing.dot(ways[-1, node], TARGET, 2.6)
    return drawing.svg()


@cache
def errors() -> tuple[Curve, Curve]:
    """Largest error of solving and of marching, as log10 of unit cells, for each grid."""
    solved, marched = [], []
    for size in GRIDS:
        missed, off = [], []
        for seed in range(FIELDS):
            ratios = RatioField.from_log10(np.random.default_rng(seed).uniform(-1.0, 1.0, (size, size)))
            voids = deploy(ratios).voids(math.pi)
            missed.append(_miss(ratios, voids))
            off.append(float(np.abs(march(ratios, voids[:, 0, 0], voids[0, :, 3], math.pi) - voids).max()))
        solved.append((float(size), math.log10(max(missed))))
        marched.append((float(size), math.log10(max(off))))
    return Curve("marched", tuple(marched)), Curve("solved", tuple(solved))


def _miss(ratios: RatioField, voids: FloatArray) -> float:
    """How far corners (m, n, 4, 2) of the flat sheet miss Eq. 2 at most, unit cells."""
    s = voids[..., 3, :] - voids[..., 0, :]
    even = np.add.outer(np.arange(ratios.rows), np.arange(ratios.columns)) % 2 == 0
    # R(-pi) turns s back on itself, R(0) leaves it.
    side = ratios.ratio[..., np.newaxis] * np.where(even[..., np.newaxis], -s, s)
    at_p1 = np.abs(voids[..., 0, :] + side - voids[..., 1, :]).max()
    at_p2 = np.abs(voids[..., 3, :] + side - voids[..., 2, :]).max()
    return float(max(at_p1, at_p2))


def exactness() -> bytes:
    """Errors against the size of the grid."""
    return LineChart("rows and columns", "log10 of the largest error, unit cells", errors()).svg()


def _matched(points: FloatArray, target: Outline) -> ShapeMatch:
    return siou_of_many([points], target)[0]


def siou() -> bytes:
    """The uniform sheet of 10 x 10 voids over the heart after three steps of a fit: common, missing, extra."""
    target, drawing = silhouettes.load("heart"), FigureDrawing(300.0)
    fitted = polish(RatioField.uniform(10, 10), target, steps=2)
    outline = deploy(fitted.sheet).outline(0.0)
    match = siou_near(outline, target, fitted.pose)
    laid = shapely.Polygon(match.transform.apply(outline)).buffer(0)
    drawing.region(target.polygon.intersection(laid), SHEET)
    drawing.region(target.polygon.difference(laid), "#f7b267")
    drawing.region(laid.difference(target.polygon), "#5f6f80")
    drawing.shape(match.transform.apply(outline), line=SHEET_LINE, width=1.5)
    drawing.shape(target.points, line=TARGET, width=1.8)
    right, top = target.points.max(axis=0)
    for row, (colour, text) in enumerate(((SHEET, "common"), ("#f7b267", "missing"), ("#5f6f80", "extra"))):
        corner = np.array([right + 0.14, top - 0.1 - 0.1 * row])
        square = np.array([[0, 0], [0.05, 0], [0.05, 0.05], [0, 0.05]])
        drawing.shape(corner + square, fill=colour, line=FAINT)
        drawing.word(corner + np.array([0.08, 0.005]), text, anchor="start")
    below = np.array([right + 0.14, top - 0.46])
    drawing.word(below, f"sIoU {match.siou:.4f}", anchor="start")
    drawing.word(below - np.array([0.0, 0.08]), f"exact IoU {match.iou_exact:.4f}", anchor="start")
    return drawing.svg()


def fit() -> bytes:
    """A uniform sheet of 10 x 10 voids after some steps of the fit to the heart."""
    target, drawing = silhouettes.load("heart"), FigureDrawing(150.0)
    uniform = RatioField.uniform(10, 10)
    width = float(np.ptp(target.points[:, 0])) + 0.16
    for column, steps in enumerate((0, 1, 3, 15)):
        fitted = polish(uniform, target, steps=steps, free_rim=True)
        outline = deploy(fitted.sheet).outline(0.0)
        match = siou_near(outline, target, fitted.pose)
        pose: Similarity = match.transform
        move = np.array([column * width, 0.0])
        for panel in deploy(fitted.sheet).panels(0.0).reshape(-1, 4, 2):
            drawing.shape(pose.apply(panel) + move, fill=SHEET, line=SHEET_LINE, width=0.7)
        drawing.shape(target.points + move, line=TARGET, width=2.0)
        low = float(target.points[:, 1].min())
        words = f"{steps} step{'' if steps == 1 else 's'}: {match.iou_exact:.3f}"
        drawing.word(np.array([move[0], low - 0.17]), words, size=14)
    return drawing.svg()


FIGURES: dict[str, Callable[[], bytes]] = {
    "parity": parity,
    "void": void,
    "compact": compact,
    "motion": motion,
    "paths": paths,
    "exactness": exactness,
    "siou": siou,
    "fit": fit,
}


def main(argv: Sequence[str] | None = None) -> int:
    """Write all figures into a folder."""
    parser = argparse.ArgumentParser(description="Draw the figures of docs/mathematics.md.")
    parser.add_argument("--out", type=Path, required=True)
    folder = parser.parse_args(argv).out
    folder.mkdir(parents=True, exist_ok=True)
    for name, draw in FIGURES.items():
        (folder / f"{name}.svg").write_bytes(draw())
    return 0


if __name__ == "__main__":
    raise SystemExit(main())
