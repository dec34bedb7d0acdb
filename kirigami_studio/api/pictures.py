"""Pictures of targets, sheets, designs, cuts and curves as SVG, which notebooks show.

They are drawn in pixels on nothing, in colours that are seen on white and on black alike.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING
from xml.etree import ElementTree

import numpy as np

from kirigami_studio.api.values import optional_package
from kirigami_studio.assembly.posed_pieces import PosedPieces
from kirigami_studio.evaluate.posed_design import PosedDesign
from kirigami_studio.export.picture import PANEL, PANEL_EDGE, TARGET_EDGE, hexadecimal
from kirigami_studio.export.svg import NAMESPACE, decimals, path_data
from kirigami_studio.fabricate.cut_plan import CutPlan, Layer
from kirigami_studio.foundation.arrays import FloatArray, ShapeRings, as_rings

if TYPE_CHECKING:
    from matplotlib.axes import Axes

#: Letters and lines on white or black paper; the curve; where something is too much.
GREY, LINE, ALARM = "#7a7f87", "#3b82c4", "#e5484d"
#: Layers of cuts as they are seen on both; files have the colours that machines know.
LAYERS = {
    Layer.RELIEF: "#d9730d",
    Layer.SLITS: ALARM,
    Layer.EDGE_SLITS: "#30a46c",
    Layer.HOLES: LINE,
    Layer.OUTLINE: LINE,
}
PANEL_FILL, PANEL_LINE = hexadecimal(PANEL), hexadecimal(PANEL_EDGE)
TARGET = hexadecimal(TARGET_EDGE)
FONT = "system-ui, -apple-system, 'Segoe UI', Roboto, sans-serif"
#: Sizes in pixels: of letters, of what is drawn beside each other, between these, and of a picture's margin.
SMALL, LETTERS, STATE, CARD, GAP, MARGIN = 11, 13, 210, 132, 22, 8
#: Cards in a row, most and least of all, and panels on them: pictures stay below half a megabyte.
COLUMNS, MOST_CARDS, LEAST_CARDS, MOST_PANELS = 6, 24, 3, 9000
#: Width and height of the field of a curve, and the room for its numbers.
FIELD, NUMBERS = (250, 150), 44


@dataclass(frozen=True, slots=True)
class SvgPicture:
    """A drawing in pixels, y down.

    Attributes
    ----------
    root : Element
    """

    root: ElementTree.Element

    @classmethod
    def of(cls, width: float, height: float, title: str) -> SvgPicture:
        """An empty one; the title is what screen readers say."""
        size = {"width": decimals(width), "height": decimals(height)}
        view = {"viewBox": f"0 0 {decimals(width)} {decimals(height)}", "role": "img"}
        look = {"style": "max-width:100%;height:auto", "font-family": FONT}
        root = ElementTree.Element("svg", {"xmlns": NAMESPACE, **size, **view, **look})
        ElementTree.SubElement(root, "title").text = title
        return cls(root)

    def rings(self, rings: Sequence[FloatArray], closed: bool = True, **look: str) -> None:
        """All rings, (P, 2) each, as one path, to a tenth of a pixel."""
        drawn = [path_data(ring.round(1), 0.0, closed) for ring in rings if len(ring)]
        names = {name.replace("_", "-"): value for name, value in look.items()}
        if drawn:
            data = " ".join(drawn)
            ElementTree.SubElement(self.root, "path", {"d": data, "stroke-linejoin": "round", **names})

    def text(
        self, x: float, y: float, words: str, anchor: str = "start", size: int = SMALL, bold: bool = False
    ) -> None:
        """Letters that begin, stand over or end at a point."""
        look = {"font-size": str(size), "fill": GREY, "text-anchor": anchor} | ({"font-weight": "600"} if bold else {})
        ElementTree.SubElement(self.root, "text", {"x": decimals(x), "y": decimals(y), **look}).text = words

    def dot(self, x: float, y: float, radius: float, colour: str) -> None:
        place = {"cx": decimals(x), "cy": decimals(y), "r": decimals(radius)}
        ElementTree.SubElement(self.root, "circle", {**place, "fill": colour})

    @property
    def svg(self) -> str:
        """The drawing as text."""
        return ElementTree.tostring(self.root, encoding="unicode")


@dataclass(frozen=True, slots=True)
class Placing:
    """Where points of a drawing, y up, go on a canvas.

    Attributes
    ----------
    scale : float, pixels per unit
    middle : (x, y), in the drawing
    place : (x, y), pixels
        Of that middle on the canvas; :meth:`SvgPicture.rings` turns y over.
    """

    scale: float
    middle: tuple[float, float]
    place: tuple[float, float]

    @classmethod
    def of(cls, points: FloatArray, scale: float, place: tuple[float, float]) -> Placing:
        """The box around points (P, 2), centred at a place."""
        low, high = points.min(axis=0), points.max(axis=0)
        x, y = 0.5 * (low + high)
        return cls(scale, (float(x), float(y)), place)

    def __call__(self, ring: FloatArray) -> FloatArray:
        x, y = self.place
        placed: FloatArray = (ring - self.middle) * self.scale + (x, -y)
        return placed


def target_picture(shape: ShapeRings, name: str) -> str:
    """A filled outline with its holes and its name."""
    points = as_rings(shape)[0]
    extent = np.ptp(points, axis=0)
    scale = CARD / float(extent.max())
    height = float(extent[1]) * scale
    canvas = SvgPicture.of(CARD + 2 * MARGIN, height + 2 * MARGIN + GAP, name)
    placing = Placing.of(points, scale, (CARD / 2 + MARGIN, height / 2 + MARGIN))
    _target(canvas, [placing(ring) for ring in as_rings(shape)], 2.0, filled="0.28")
    canvas.text(CARD / 2 + MARGIN, height + MARGIN + 17, _short(name, 22), "middle")
    return canvas.svg


def states_picture(
    design: PosedDesign,
    target: ShapeRings,
    heading: str,
    details: str = "",
    pieces: PosedPieces | None = None,
) -> str:
    """A sheet, or its pieces, flat, half open and at its angle over its target, in one scale."""
    end = design.phi_target
    angles = (math.pi, 0.5 * (math.pi + end), end)
    parts = [design.parts(phi) if pieces is None else pieces.outlines(phi) for phi in angles]
    clouds = [np.concatenate(rings) for rings in parts]
    clouds[-1] = np.concatenate([clouds[-1], *as_rings(target)])
    sizes = np.array([np.ptp(cloud, axis=0) for cloud in clouds])
    scale = STATE / float(sizes.max())
    widths, height = sizes[:, 0] * scale, float(sizes[:, 1].max()) * scale
    total = max(float(widths.sum()) + 2 * (GAP + MARGIN), _room(heading) + 6.2 * len(details))
    canvas = SvgPicture.of(total, height + 2 * MARGIN + 2 * GAP, f"{heading} {details}".strip())
    canvas.text(MARGIN, MARGIN + LETTERS, heading, size=LETTERS, bold=True)
    if details:
        canvas.text(total - MARGIN, MARGIN + LETTERS, details, "end")
    left = float(MARGIN)
    for number, (phi, rings, cloud, width) in enumerate(zip(angles, parts, clouds, widths.tolist(), strict=True)):
        placing = Placing.of(cloud, scale, (left + width / 2, MARGIN + GAP + height / 2))
        wanted = target if number == 2 else None
        if pieces is None:
            _sheet(canvas, placing, rings, wanted)
        else:
            _pieces(canvas, placing, pieces, rings, wanted)
        words = "flat" if number == 0 else f"{math.degrees(phi):.0f}°"
        canvas.text(left + width / 2, height + MARGIN + GAP + 16, words, "middle")
        left += width + GAP
    return canvas.svg


@dataclass(frozen=True, slots=True)
class Thumbnail:
    """One design on a contact sheet: its motion, the target, and two lines of text."""

    design: PosedDesign
    target: ShapeRings
    title: str
    details: str


def contact_sheet(cards: Sequence[Thumbnail], heading: str) -> str:
    """Designs at their angles in rows; of many the first, and how many more there are."""
    panels = len(cards[0].design.parts(cards[0].design.phi_target)) if cards else 1
    shown = cards[: max(min(MOST_CARDS, MOST_PANELS // panels), LEAST_CARDS)]
    columns = min(COLUMNS, max(len(shown), 1))
    rows = -(-len(shown) // columns)
    cell, tall = CARD + GAP, CARD + 2 * GAP
    width = max(columns * cell - GAP + 2 * MARGIN, _room(heading))
    rest = len(cards) - len(shown)
    canvas = SvgPicture.of(width, rows * tall + GAP + MARGIN + (GAP if rest else 0), heading)
    canvas.text(MARGIN, MARGIN + LETTERS, heading, size=LETTERS, bold=True)
    for number, card in enumerate(shown):
        row, column = divmod(number, columns)
        rings = card.design.parts(card.design.phi_target)
        cloud = np.concatenate([*rings, *as_rings(card.target)])
        x, y = MARGIN + column * cell + CARD / 2, MARGIN + GAP + row * tall + CARD / 2
        placing = Placing.of(cloud, CARD / float(np.ptp(cloud, axis=0).max()), (x, y))
        _sheet(canvas, placing, rings, card.target)
        below = y + CARD / 2 + 16
        canvas.text(x - CARD / 2, below, _short(card.title, 10), bold=True)
        canvas.text(x + CARD / 2, below, card.details, "end")
    if rest:
        canvas.text(MARGIN, rows * tall + GAP + MARGIN + 10, f"and {rest} more")
    return canvas.svg


def cuts_picture(plan: CutPlan, heading: str) -> str:
    """All cuts of one sheet, by layer, with the size and what the colours mean."""
    width, height = plan.bounds_mm
    scale = 1.5 * STATE / max(width, height)
    w, h = width * scale, height * scale
    canvas = SvgPicture.of(max(w + 2 * MARGIN, _room(heading)), h + 3 * GAP, heading)
    canvas.text(MARGIN, MARGIN + LETTERS, heading, size=LETTERS, bold=True)
    placing = Placing(scale, (0.0, 0.0), (MARGIN, MARGIN + GAP + h))
    left = float(MARGIN)
    for layer in plan.layers:
        paths = plan.on_layer(layer)
        for closed in (False, True):
            rings = [placing(path.flattened) for path in paths if path.closed is closed]
            canvas.rings(rings, closed, fill="none", stroke=LAYERS[layer], stroke_width="1")
        name = layer.value.replace("_", " ").lower()
        canvas.dot(left + 4, h + 2 * GAP + 8, 4, LAYERS[layer])
        canvas.text(left + 12, h + 2 * GAP + 12, name)
        left += 24 + 6.2 * len(name)
    return canvas.svg


@dataclass(frozen=True, slots=True, eq=False)
class AngleCurve:
    """Values against the angle.

    Attributes
    ----------
    phi : (S,) float, radians
    values : (S,) float
    name : str
        With its unit.
    limit : float or None
        A value that should not be exceeded.
    """

    phi: FloatArray
    values: FloatArray
    name: str
    limit: float | None = None


def curves_picture(curves: Sequence[AngleCurve], heading: str, jam_phi: float | None = None) -> str:
    """Curves beside each other, from flat to closed; the angle of a jam is marked."""
    wide, tall = FIELD
    step = wide + NUMBERS + GAP
    canvas = SvgPicture.of(len(curves) * step + MARGIN, tall + 3 * GAP + LETTERS, heading)
    canvas.text(MARGIN, MARGIN + LETTERS, heading, size=LETTERS, bold=True)
    for number, curve in enumerate(curves):
        left, top = MARGIN + number * step + NUMBERS, MARGIN + 2 * GAP
        _curve(canvas, curve, (left, top), jam_phi)
    return canvas.svg


def plot_sheet(ax: Axes | None, rings: Sequence[FloatArray], target: ShapeRings, title: str) -> Axes:
    """Panels or pieces over a target on the axes of Matplotlib, in one scale, and no numbers.

    Raises
    ------
    UsageError
        Matplotlib is not installed.
    """
    collections = optional_package("matplotlib.collections", "plot")
    axes: Axes = optional_package("matplotlib.pyplot", "plot").gca() if ax is None else ax
    look = {"facecolors": PANEL_FILL, "edgecolors": PANEL_LINE, "linewidths": 0.5}
    axes.add_collection(collections.PolyCollection(list(rings), **look), autolim=True)
    closed = [np.concatenate([ring, ring[:1]]) for ring in as_rings(target)]
    axes.add_collection(collections.LineCollection(closed, colors=TARGET, linewidths=1.5), autolim=True)
    axes.set_aspect("equal")
    axes.autoscale_view()
    axes.set_axis_off()
    axes.set_title(title)
    return axes


def _curve(canvas: SvgPicture, curve: AngleCurve, corner: tuple[float, float], jam_phi: float | None) -> None:
    (left, top), (wide, tall) = corner, FIELD
    ticks = _ticks(curve.values if curve.limit is None else np.append(curve.values, curve.limit))
    low, high = ticks[0], ticks[-1]

    def place(phi: FloatArray | float, value: FloatArray | float) -> FloatArray:
        x = left + wide * (1.0 - np.asarray(phi) / math.pi)
        y = top + tall * (1.0 - (np.asarray(value) - low) / (high - low))
        return np.stack(np.broadcast_arrays(x, -y), axis=-1)

    for value in ticks:
        line = place(np.array([math.pi, 0.0]), value)
        canvas.rings([line], False, stroke=GREY, stroke_width="1", stroke_opacity="0.25", fill="none")
        canvas.text(left - 6, -float(line[0, 1]) + 4, f"{value + 0.0:g}", "end")
    for degrees in (180, 135, 90, 45, 0):
        x, y = place(math.radians(degrees), low).tolist()
        canvas.text(x, -y + 15, "flat" if degrees == 180 else f"{degrees}°", "middle")
    canvas.text(left, top - 8, curve.name)
    if curve.limit is not None:
        line = place(np.array([math.pi, 0.0]), curve.limit)
        canvas.rings([line], False, stroke=ALARM, stroke_width="1", stroke_dasharray="4 3", fill="none")
    if jam_phi is not None:
        line = place(jam_phi, np.array([low, high]))
        canvas.rings([line], False, stroke=ALARM, stroke_width="1.2", fill="none")
    canvas.rings([place(curve.phi, curve.values)], False, stroke=LINE, stroke_width="2", fill="none")


def _ticks(values: FloatArray) -> list[float]:
    """Three to six round values around all that there are, zero among them."""
    low, high = min(float(values.min()), 0.0), max(float(values.max()), 0.0)
    span = (high - low) or 1.0
    step = 10.0 ** math.floor(math.log10(span / 3.0))
    step *= next(factor for factor in (1.0, 2.0, 5.0, 10.0) if span / (step * factor) <= 5.0)
    first, last = math.floor(low / step + 1e-9), max(math.ceil(high / step - 1e-9), 1)
    return [round(number * step, 12) for number in range(first, last + 1)]


def _sheet(canvas: SvgPicture, placing: Placing, rings: Sequence[FloatArray], target: ShapeRings) -> None:
    """Panels over a target, whose outline is repeated on top."""
    wanted = [placing(ring) for ring in as_rings(target)]
    canvas.rings(wanted, fill=TARGET, fill_opacity="0.22", fill_rule="evenodd")
    drawn = [placing(ring) for ring in rings]
    extent = np.ptp(np.concatenate(drawn), axis=0)
    # A twentieth of a panel: fine grids stay blue.
    line = min(max(0.05 * math.sqrt(float(extent.prod()) / len(drawn)), 0.3), 0.9)
    canvas.rings(drawn, fill=PANEL_FILL, stroke=PANEL_LINE, stroke_width=f"{line:.2f}")
    _target(canvas, wanted, 1.6)


def _pieces(
    canvas: SvgPicture, placing: Placing, pieces: PosedPieces, rings: Sequence[FloatArray], target: ShapeRings
) -> None:
    """Pieces layer by layer, and the outline of their target on top."""
    for place, layer in enumerate(pieces.layers):
        face = hexadecimal(pieces.look.layer(place, len(pieces.layers)))
        drawn = [placing(rings[number]) for number in layer]
        canvas.rings(drawn, fill=face, stroke=hexadecimal(pieces.look.line), stroke_width="0.4")
    _target(canvas, [placing(ring) for ring in as_rings(target)], 1.6)


def _target(canvas: SvgPicture, rings: Sequence[FloatArray], width: float, filled: str = "0") -> None:
    pen = {"stroke": TARGET, "stroke_width": f"{width:g}"}
    canvas.rings(rings, True, fill=TARGET, fill_opacity=filled, fill_rule="evenodd", **pen)


def _room(heading: str) -> float:
    """Width of a picture in which a heading has room, pixels."""
    return 7.6 * len(heading) + GAP + 2 * MARGIN


def _short(words: str, most: int) -> str:
    return words if len(words) <= most else words[: most - 1] + "…"
