"""The sheet at any angle over its target, and the tour from fault to fault."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import lru_cache
from typing import TYPE_CHECKING

import numpy as np
from PySide6.QtCore import QEvent, QObject, QPointF, QRectF, Qt, Signal
from PySide6.QtGui import QFontMetrics, QMouseEvent, QPaintEngine, QPainter, QPainterPath
from PySide6.QtWidgets import QWidget

from kirigami_studio.assembly.posed_pieces import LINE, PieceLook, PosedPieces, Shade, face_of, shaded
from kirigami_studio.evaluate.posed_design import PosedDesign
from kirigami_studio.evaluate.score import Score
from kirigami_studio.evaluate.second_target import SecondMatch
from kirigami_studio.foundation.arrays import BoolArray, FloatArray
from kirigami_studio.foundation.words import mark, tr, tr_n
from kirigami_studio.gui.session.overlays import USUAL, Overlay
from kirigami_studio.gui.stage.artwork_painting import ShownArtwork, ShownPrint, paint_artwork
from kirigami_studio.gui.stage.connector_items import STRETCH_TITLE, paint_stretch, stretch_scale
from kirigami_studio.gui.stage.fault_items import (
    Fault,
    FaultKind,
    contact_place,
    crossing_place,
    faults,
    inverted_panels,
    paint_fault,
)
from kirigami_studio.gui.stage.gripping import UNKNOWN as GRIPS_UNKNOWN
from kirigami_studio.gui.stage.gripping import GripState, grip_places, paint_grips
from kirigami_studio.gui.stage.layout_items import paint_cut_panels, paint_panels, turning_left
from kirigami_studio.gui.stage.layout_labels import (
    SmallPart,
    heat_tiles,
    paint_dimension,
    paint_heat,
    paint_numbers,
    paint_shaded,
    quad_areas,
    room_in,
    smallest_parts,
)
from kirigami_studio.gui.stage.piece_items import colour_of, paint_pieces
from kirigami_studio.gui.stage.void_gestures import VoidGestures
from kirigami_studio.gui.stage.void_items import VoidShapes, steady
from kirigami_studio.gui.widgets.canvas import Canvas
from kirigami_studio.gui.widgets.colour_scale import (
    OPENING_TITLE,
    RATIO_TITLE,
    ColourScale,
    bar_boxes,
    opening_scale,
    paint_colour_bars,
    ratio_scale,
)
from kirigami_studio.gui.widgets.fitted_text import fitted
from kirigami_studio.gui.widgets.legends import Chip, clear_box, legend_boxes, paint_caption, paint_legend
from kirigami_studio.gui.widgets.mismatch_items import (
    VERSIONS,
    Mismatch,
    design_mismatch,
    difference_chips,
    mismatch_of_area,
    mismatch_of_pieces,
    paint_mismatch,
    usual_chips,
)
from kirigami_studio.gui.widgets.paths import line_path
from kirigami_studio.gui.widgets.readable import readable_width
from kirigami_studio.gui.widgets.target_items import paint_target_line, paint_target_shape
from kirigami_studio.gui.widgets.view_transform import Bounds, ViewTransform
from kirigami_studio.outlines.outline import Outline

if TYPE_CHECKING:
    from kirigami_studio.export.assembly_files import AssemblyJob
    from kirigami_studio.export.cut_motion import CutPose
    from kirigami_studio.mechanics.gripping import Gripping
    from kirigami_studio.studio.as_cut import SimulatedSheet

#: Radians around the target angle within which sheet and target are compared; elsewhere a difference means nothing.
COMPARED_WITHIN = math.radians(12.0)
#: Angles (radians) that differ by less are one.
SAME_ANGLE = 1e-6
#: Opacity of the target's outline there.
FAINT = 0.4
#: Width (mm) of the flat sheet until it is known.
USUAL_WIDTH_MM = 100.0
#: Pixels around a fault's middle that belong to its sign.
FAULT_REACH = 12.0
#: Radians past the first contact from which the place of the overlap at that angle is marked as well.
NEAR_CONTACT = math.radians(0.5)
#: The greatest distance between sheet and target is marked from this length (pixels) on.
SHORTEST_GAP = 6.0
#: Narrower than this (pixels) the legend says less.
NARROW = 440
#: Pixels from the top that the caption takes.
CAPTION_HEIGHT = 44.0
#: Share of the height from the top that bars below each other may take.
BARS_SHARE = 0.35
#: What panels look like below artwork that does not cover them.
PAPER = "#ffffff"
#: How much a fault is enlarged over the fitted picture.
CLOSE_UP = 5.0
#: Designs whose facts are kept: a step back in the history shows one of them again.
KEPT_FACTS = 64
#: A mouse that moves less than this (pixels) between press and release has clicked.
STILL = 4.0


#: What the status line says of a fault that was clicked.
FAULT_SENTENCES = {
    FaultKind.INVERTED: mark("Inverted or collapsed panel."),
    FaultKind.CONTACT: mark("First contact during deployment."),
    FaultKind.CROSSING: mark("The sheet overlaps itself here."),
}
#: Overlays that a colour bar explains.
BAR_TITLES = {Overlay.RATIOS: RATIO_TITLE, Overlay.OPENINGS: OPENING_TITLE, Overlay.STRETCH: STRETCH_TITLE}


@dataclass(frozen=True, slots=True, eq=False)
class RigidFacts:
    """What is the same of a design at every angle, because its panels are rigid."""

    inverted: BoolArray  #: (K,); panels that are inverted or collapsed
    small: tuple[SmallPart, ...]  #: its smallest parts; panels that were trimmed are left out
    largest_opening: float  #: world; area of the void that opens widest

    @classmethod
    @lru_cache(maxsize=KEPT_FACTS)
    def of(cls, design: PosedDesign) -> RigidFacts:
        """Measure a design, once."""
        panels, trim = design.panels(design.nodes(design.phi_target)), design.trim
        trimmed = () if trim is None else (row for row, part in enumerate(trim.kept) if part is not None)
        small = tuple(smallest_parts(panels, frozenset(trimmed)))
        opened = quad_areas(design.voids(design.nodes(0.5 * math.pi)))
        return cls(inverted_panels(panels), small, float(opened.max()))


@lru_cache(maxsize=KEPT_FACTS)
def _extent(design: PosedDesign) -> FloatArray:
    """The box around the motion of a design: 2 ms for 24 x 24 voids."""
    return design.extent()


class LayoutView(Canvas):
    """Draws one design at the current angle; all is computed while painting, so slider storms cost nothing."""

    def __init__(self, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self.design: PosedDesign | None = None
        self._rigid = RigidFacts(np.zeros(0, dtype=np.bool_), (), 0.0)
        self._contact: FloatArray | None = None
        self._contact_phi: float | None = None
        self._target: Outline | None = None
        self.second: tuple[float, FloatArray] | None = None  #: angle of the second target, its outline (P, 2) there
        self._bounds: Bounds | None = None
        self.phi = math.pi  #: angle that is shown, radians
        self.overlays: frozenset[Overlay] = USUAL
        self._wanted = USUAL  #: what was asked for, also while a plain picture is taken
        self._width_mm = USUAL_WIDTH_MM
        self.scales: list[ColourScale] = []  #: colour bars of the last painted picture
        self._cut: SimulatedSheet | None = None
        self._as_cut, self._ideal = True, False
        self._made: tuple[SimulatedSheet, PosedDesign] | None = None  #: the sheet as cut over its target
        self.artwork: ShownArtwork | ShownPrint | None = None
        self._pieces: PosedPieces | None = None
        self._tiles: PosedPieces | None = None  #: on the panels of a hinge layer
        self._cloth: Shade | None = None  #: face of that layer
        self._grips = GRIPS_UNKNOWN
        self.overstretched = 0  #: connectors of the last painted picture stretched by more than they tolerate
        self.areas: Mismatch | None = None  #: missing and extra area of the last painted picture
        self._ideal_areas: tuple[float, Mismatch] | None = None  #: angle, and areas of the ideal motion there
        #: the same of a sheet as cut, and of pieces
        self._made_areas: tuple[tuple[object, float], Mismatch] | None = None
        self._cut_mm = 0.0  #: millimetres of one world unit as the sheet as cut lies there; 0 for the ideal motion
        self.faults: tuple[Fault, ...] = ()  #: marked places of the last painted picture
        self._hint = ("generate", tr("No design yet"), tr("Choose a target on the left, then press Generate (Ctrl+G)."))
        self.caption = ""  #: text of the upper left corner
        self._box: tuple[tuple[object, ...], QRectF] | None = None  #: what it depends on, and the scene's box
        self.voids = VoidGestures(self, self._void_shapes)
        self.setObjectName("layoutView")
        self.setAccessibleName(tr("Layout of the chosen design"))
        self.setToolTip(tr("Wheel: zoom. Drag: pan. Double-click: fit view."))

    def show_design(
        self,
        design: PosedDesign | None,
        score: Score | None,
        target: Outline | None,
        second: SecondMatch | None = None,
    ) -> None:
        """Show another design; without one the target, without that the empty state.

        ``second`` is how this very sheet shows a second target.
        """
        self.design, self._target, self._cut, self.second = design, target, None, None
        self.areas, self._ideal_areas, self._made_areas, self._cut_mm, self.faults = None, None, None, 0.0, ()
        self._pieces = self._tiles = None
        before, self._bounds = self._bounds, None
        if design is not None:
            self._rigid = RigidFacts.of(design)
            self._bounds = Bounds.of(_extent(design))
            self._contact = None if score is None else contact_place(design, score)
            self._contact_phi = None if score is None or score.contact is None else score.contact.phi
            if target is not None:
                self._bounds = self._bounds.united(Bounds.of(target.points))
            if second is not None:
                line = second.match.transform.inverse().apply(second.target.outline.points)
                self.second = second.target.phi, design.to_world(line, second.target.phi)
                self._bounds = self._bounds.united(Bounds.of(self.second[1]))
            if self.voids.on and before is not None:
                self._bounds = steady(before, self._bounds)
        elif target is not None:
            self._bounds = Bounds.of(target.points)
        self.voids.follow()
        self.update()

    def show_draft(self, design: PosedDesign) -> None:
        """Show a design that is being edited by hand, without fitting the view again."""
        self.design, self._cut, self.second = design, None, None
        self._pieces = self._tiles = None
        self.areas, self._ideal_areas, self._made_areas, self._cut_mm = None, None, None, 0.0
        self.faults, self._contact = (), None
        self._rigid = RigidFacts.of(design)
        self.update()

    def show_as_cut(self, sheet: SimulatedSheet | None) -> None:
        """Show how much the connectors of the design are stretched; None where that is not known."""
        if sheet is not self._cut:
            self._cut = sheet
            self.update()

    def show_pieces(self, pieces: PosedPieces | None) -> None:
        """Draw pieces of the design in the place of its panels, or panels again."""
        self._pieces = None if self.design is None else pieces
        if self._pieces is not None and self._bounds is not None:
            self._bounds = self._bounds.united(Bounds.of(self._pieces.extent))
        self.update()

    def show_tiles(self, layers: AssemblyJob | None) -> None:
        """Draw the tiles of a backed design on its panels, or panels alone again."""
        self._tiles = None
        if layers is not None and self.design is not None:
            made, design = layers.assembly.deployment, self.design
            look = PieceLook.of(layers.material, layers.fastener, in_one_plane=False)
            self._cloth = None if layers.glued is None else face_of(layers.glued.plan.material)
            posed = design if made is design.deployment else design.laid_over(made)
            self._tiles = PosedPieces(layers.assembly, posed, look, 0.0, ())
        self.update()

    def set_as_cut(self, on: bool) -> None:
        """Draw the panels as the cuts leave them, as far as the sheet comes, or those of the ideal motion."""
        self._as_cut = on
        self.update()

    def set_ideal(self, on: bool) -> None:
        """Go on as the ideal motion does where the sheet as cut jams, or stay there."""
        self._ideal = on
        self.update()

    @property
    def shown_as_cut(self) -> CutPose | None:
        """The pose that is drawn, at the jam for angles beyond it; None where the ideal motion is drawn."""
        sheet, design = self._cut, self.design
        if not self._as_cut or sheet is None or design is None:
            return None
        if self._ideal and self.phi < sheet.as_cut.reached - SAME_ANGLE:
            return None
        if self._made is None or self._made[0] is not sheet:
            self._made = (sheet, design if sheet.made is None else design.laid_over(sheet.made))
        return sheet.motion.pose(self._made[1], self.phi)

    def show_artwork(self, shown: ShownArtwork | ShownPrint | None) -> None:
        """Show the print of a design on its panels or pieces; None where nothing is printed."""
        self.artwork = shown
        self.update()

    def show_grips(self, state: GripState) -> None:
        """Show where to hold and to pull the design as cut."""
        self._grips = state
        self.update()

    def _void_shapes(self) -> VoidShapes | None:
        transform = self.transform()
        return None if self.design is None or transform is None else VoidShapes.of(self.design, self.phi, transform)

    def set_phi(self, phi: float) -> None:
        """Show another angle, radians."""
        self.phi = phi
        self.voids.follow()
        self.update()

    def set_overlays(self, overlays: frozenset[Overlay]) -> None:
        """Choose what is drawn over the panels."""
        self.overlays = self._wanted = overlays
        self.update()

    def set_sheet_width(self, width_mm: float) -> None:
        """Set the width of the flat sheet, mm: all lengths on the drawing follow from it."""
        if width_mm != self._width_mm:
            self._width_mm = width_mm
            self.update()

    @property
    def mm_per_unit(self) -> float:
        """Millimetres of one world unit; 0 while there is no design."""
        if self._pieces is not None:
            return self._pieces.mm_per_world
        return 0.0 if self.design is None else self._cut_mm or self.design.mm_per_world(self._width_mm)

    def find_faults(self) -> tuple[Fault, ...]:
        """All faults of the design at the angle that is shown, whether they are marked or not."""
        design = self.design
        if design is None:
            return ()
        found = list(faults(design.panels(design.nodes(self.phi)), self._rigid.inverted, self._contact))
        found = [replace(one, phi=self._contact_phi) if one.kind is FaultKind.CONTACT else one for one in found]
        beyond = self._contact_phi if self._contact_phi is not None else design.phi_target
        if self.phi < beyond - NEAR_CONTACT:  # the way there is known to be free
            place = crossing_place(design, self.phi)
            if place is not None:
                found.append(Fault(FaultKind.CROSSING, (float(place[0]), float(place[1]))))
        return tuple(found)

    def fault_at(self, pixel: QPointF) -> Fault | None:
        """The marked fault under a pixel, if any."""
        transform = self.transform()
        if transform is None:
            return None
        for fault in self.faults:
            x, y = transform.to_pixels(np.array(fault.where)).tolist()
            if math.hypot(x - pixel.x(), y - pixel.y()) <= FAULT_REACH:
                return fault
        return None

    def set_hint(self, icon: str, headline: str, hint: str) -> None:
        """Say in the empty view what to do next."""
        self._hint = (icon, headline, hint)
        self.update()

    def set_caption(self, text: str) -> None:
        """Show in the upper left corner what does not fit into the header."""
        self.caption = text
        self.update()

    def empty_state(self) -> tuple[str, str, str]:
        return self._hint

    def scene_bounds(self) -> Bounds | None:
        return self._bounds

    def scene_box(self) -> QRectF:
        """Beside the legends that are on, at every angle alike, so that the picture rests while the sheet moves."""
        legend = Overlay.MISMATCH in self._wanted and self._target is not None
        size, font = (self.width(), self.height()), self.font().key()
        key = (self.scene_bounds(), size, font, self._wanted, legend, self._bars_top(), self.design is None)
        if self._box is None or self._box[0] != key:  # asked for several times in every paint event
            self._box = (key, self._find_box(legend))
        return self._box[1]

    def _find_box(self, legend: bool) -> QRectF:
        view, bounds = QRectF(self.rect()), self.scene_bounds()
        if bounds is None:
            return view
        if self.design is None:  # the target alone, below what is said of it
            return view.adjusted(0, CAPTION_HEIGHT, 0, 0)
        metrics = self.fontMetrics()
        titles = [tr(title) for overlay, title in BAR_TITLES.items() if overlay in self._wanted]
        legends = self.bar_boxes(titles)
        if legend:
            chips = self._fitting([usual_chips(self.palette_, brevity) for brevity in range(VERSIONS)], metrics)
            legends += legend_boxes(chips, metrics, self.width(), self.height())
        return clear_box(bounds, view, self.margin(), legends)

    def bar_boxes(self, titles: Sequence[str]) -> list[QRectF]:
        """Where the bars of scales are; a low view has them beside each other."""
        lowest = BARS_SHARE * self.height()
        return bar_boxes(titles, self.fontMetrics(), self.width() - 10.0, self._bars_top(), lowest)

    def _bars_top(self) -> float:
        return CAPTION_HEIGHT if self.caption else 10.0

    def _fitting(self, versions: list[list[Chip]], metrics: QFontMetrics) -> list[Chip]:
        """The first of these legends where it fits into one row, else the next one that fits into two, or the last."""
        size = self.width(), self.height()
        rows = [len({box.top() for box in legend_boxes(chips, metrics, *size)}) for chips in versions]
        if rows[0] <= 1 and self.width() >= NARROW:
            return versions[0]
        return next((chips for chips, used in zip(versions[1:], rows[1:], strict=True) if used <= 2), versions[-1])

    def legend(self, metrics: QFontMetrics) -> list[tuple[Chip, QRectF]]:
        """What the labels at the bottom say, and where (pixels)."""
        found = []
        if self.faults:
            count = len(self.faults)
            found = [Chip((self.palette_.fault,), tr_n("{count} fault", "{count} faults", count))]
        if self.overstretched:
            words = tr_n(
                "{count} connector stretched too far", "{count} connectors stretched too far", self.overstretched
            )
            found.append(Chip((self.palette_.fault,), words))
        found += [*self._jam_chips(), *self._grip_chips()]
        chips = found
        if self.areas is not None:
            areas, mm = self.areas, self.mm_per_unit
            versions = [difference_chips(areas, mm, self.palette_, brevity) + found for brevity in range(VERSIONS)]
            chips = self._fitting(versions, metrics)
        return list(zip(chips, legend_boxes(chips, metrics, self.width(), self.height()), strict=True))

    def paint_scene(self, painter: QPainter, transform: ViewTransform) -> None:
        if self.design is None:
            if self._target is not None:
                paint_target_shape(painter, transform.rings_to_pixels(self._target.rings), self.palette_)
            return
        if self._pieces is not None:
            self._paint_pieces(painter, transform, self._pieces)
            return
        pose = self.shown_as_cut
        self._cut_mm = 0.0 if pose is None else pose.mm_per_world
        nodes = self.design.nodes(self.phi) if pose is None else pose.nodes
        field = self.design.deployment.field
        panels = transform.to_pixels(self.design.panels(nodes))
        trimmed = {row: transform.to_pixels(part) for row, part in self.design.kept(nodes, self.phi).items()}
        palette = self.palette_
        if Overlay.RATIOS in self.overlays:  # blue means a ratio there, not a panel
            palette = replace(palette, panel_even=palette.border, panel_odd=palette.grid, panel_line=palette.muted)
        artwork = self._painted_artwork(painter)
        if artwork is not None:
            palette = replace(palette, panel_even=PAPER, panel_odd=PAPER, panel_line=palette.muted)
        elif self._tiles is not None and self._cloth is not None:
            face, line = (colour_of(one, palette).name() for one in (self._cloth, shaded(self._cloth, LINE)))
            palette = replace(palette, panel_even=face, panel_odd=face, panel_line=line)
        turning = turning_left(field.rows, field.columns)
        if pose is None:
            paint_panels(painter, panels, turning, palette, trimmed)
        else:
            paint_cut_panels(painter, pose, transform, panels, turning, palette)
        if self._tiles is not None:
            phi = self.phi if pose is None else pose.phi
            paint_pieces(painter, self._tiles, phi, transform, self.palette_, self._print_on(painter, self._tiles))
        if artwork is not None:
            paint_artwork(painter, artwork, self.phi, panels, trimmed, transform)
        self._paint_voids(painter, transform, nodes)
        if self._target is not None:
            self._paint_comparison(painter, transform, pose)
        self._paint_stretch(painter, transform, nodes)
        self._paint_labels(painter, transform, nodes)
        self._paint_grips(painter, transform)
        self._paint_faults(painter, transform)
        self.voids.paint(painter, self.palette_)

    def _paint_pieces(self, painter: QPainter, transform: ViewTransform, pieces: PosedPieces) -> None:
        self.areas, self.faults = None, ()
        paint_pieces(painter, pieces, self.phi, transform, self.palette_, self._print_on(painter, pieces))
        if pieces.grips is not None and Overlay.GRIPS in self.overlays:
            held, pulled = pieces.grips
            places = grip_places(pieces.design, (held,), (pulled,), self.phi, pieces.design.phi_target)
            paint_grips(painter, places, transform, self.palette_)
        nearness, target = self._nearness, self._target
        if target is not None and Overlay.MISMATCH in self.overlays and nearness > 0.0 and pieces.head_mm:
            self.areas = self._compared((pieces, self.phi), lambda: mismatch_of_pieces(target.rings, pieces, self.phi))
            painter.setOpacity(min(1.0, 2.0 * nearness))
            paint_mismatch(painter, self.areas, transform, self.palette_)
            painter.setOpacity(1.0)
        if self._target is not None and Overlay.TARGET in self.overlays:
            painter.setOpacity(min(1.0, max(FAINT, 2.0 * nearness)))
            paint_target_line(painter, transform.rings_to_pixels(self._target.rings), self.palette_)
            painter.setOpacity(1.0)

    def _painted_artwork(self, painter: QPainter) -> ShownArtwork | None:
        """The artwork, unless it belongs to another design, hides an overlay, or cannot be drawn as lines."""
        shown = self.artwork
        if (
            not isinstance(shown, ShownArtwork)
            or shown.sheet.design is not self.design
            or Overlay.RATIOS in self.overlays
        ):
            return None
        return None if painter.paintEngine().type() is QPaintEngine.Type.SVG else shown

    def _print_on(self, painter: QPainter, pieces: PosedPieces) -> ShownPrint | None:
        """The print on pieces, unless it belongs to others, or cannot be drawn as lines."""
        shown = self.artwork
        if not isinstance(shown, ShownPrint) or shown.deployment is not pieces.assembly.deployment:
            return None
        return None if painter.paintEngine().type() is QPaintEngine.Type.SVG else shown

    def _paint_voids(self, painter: QPainter, transform: ViewTransform, nodes: FloatArray) -> None:
        """Colours of voids: by their ratio, by their area."""
        self.scales = []
        design = self.design
        if design is None:
            return
        field = design.deployment.field
        if Overlay.RATIOS in self.overlays:
            self.scales.append(ratio_scale(field.ratio, self.palette_))
            paint_heat(painter, transform.to_pixels(design.panels(nodes)), field.ratio, self.scales[-1], self.palette_)
        if Overlay.OPENINGS in self.overlays:
            voids, mm2 = design.voids(nodes), self.mm_per_unit**2
            self.scales.append(opening_scale(self._rigid.largest_opening * mm2, self.palette_))
            areas = quad_areas(voids).ravel() * mm2
            paint_shaded(painter, transform.to_pixels(voids).reshape(-1, 4, 2), areas, self.scales[-1])

    def _paint_stretch(self, painter: QPainter, transform: ViewTransform, nodes: FloatArray) -> None:
        """Connectors by how much they are stretched at this angle."""
        self.overstretched = 0
        if Overlay.STRETCH not in self.overlays or self._cut is None or self.design is None:
            return
        from kirigami_studio.mechanics.closing import TOLERATED_STRETCH

        self.scales.append(stretch_scale(TOLERATED_STRETCH, self.palette_))
        pixels = transform.to_pixels(nodes[self._cut.node])
        stretch = self._cut.stretch_at(self.phi)
        self.overstretched = int(np.sum(stretch > TOLERATED_STRETCH))
        paint_stretch(painter, pixels, stretch, TOLERATED_STRETCH, self.scales[-1], self.palette_)

    @property
    def grips(self) -> Gripping | None:
        """The grips that are drawn, if any: those of the design as cut that is shown."""
        state = self._grips
        shown = Overlay.GRIPS in self.overlays and self._cut is not None and state.sheet is self._cut
        return state.found if shown else None

    def _jam_chips(self) -> list[Chip]:
        """Where the sheet as cut stays, at angles that it does not come to."""
        sheet = self._cut
        if not self._as_cut or self._ideal or sheet is None or self.phi >= sheet.as_cut.reached - SAME_ANGLE:
            return []
        words = tr("as cut, stopped at {angle:.0f}°", angle=math.degrees(sheet.as_cut.reached))
        return [Chip((self.palette_.fault,), words)]

    def _grip_chips(self) -> list[Chip]:
        """What the legend says of grips: how many panels to hold and to pull, or why none are marked."""
        state, palette, found = self._grips, self.palette_, self.grips
        if Overlay.GRIPS not in self.overlays:
            return []
        if self._pieces is not None and self._pieces.grips is not None:
            held, pulled = (self._pieces.assembly.piece_on(panel).id for panel in self._pieces.grips)
            return [
                Chip((palette.text,), tr("hold {piece}", piece=held)),
                Chip((palette.good,), tr("pull {piece}", piece=pulled)),
            ]
        if found is None:
            if state.busy:
                return [Chip((), tr("Looking for where to hold and pull …"))]
            return [Chip((palette.fault,), state.problem)] if state.problem else []
        chips = [
            Chip((palette.text,), tr_n("hold {count} panel", "hold {count} panels", len(found.held))),
            Chip((palette.good,), tr_n("pull {count} panel", "pull {count} panels", len(found.moved))),
        ]
        return chips if found.follows else [*chips, Chip((palette.fault,), tr("does not follow all the way"))]

    def _paint_grips(self, painter: QPainter, transform: ViewTransform) -> None:
        """Pins on the panels to hold and to pull, and the way that the latter go next."""
        found, design, cut = self.grips, self.design, self._cut
        if found is None or design is None or cut is None:
            return
        places = grip_places(design, found.held, found.moved, self.phi, cut.as_cut.reached)
        paint_grips(painter, places, transform, self.palette_)

    def _paint_labels(self, painter: QPainter, transform: ViewTransform, nodes: FloatArray) -> None:
        """Numbers of panels and voids where they fit, and sizes of the smallest parts."""
        design = self.design
        if design is None:
            return
        field, panels, voids = design.deployment.field, design.panels(nodes), design.voids(nodes)
        rows, columns = field.rows, field.columns
        if Overlay.PANEL_NUMBERS in self.overlays:
            grid = transform.to_pixels(panels).reshape(rows + 1, columns + 1, 4, 2)
            paint_numbers(painter, grid.mean(axis=2), room_in(grid), self.palette_, framed=False)
        if Overlay.VOID_NUMBERS in self.overlays:
            tiles = transform.to_pixels(heat_tiles(panels, rows, columns))
            paint_numbers(painter, transform.to_pixels(voids).mean(axis=2), room_in(tiles), self.palette_, framed=True)
        lengths: list[tuple[float, FloatArray, QPainterPath | None]] = []
        if self.areas is not None:
            gap = transform.to_pixels(self.areas.gap.ends)
            if np.linalg.norm(gap[1] - gap[0]) >= SHORTEST_GAP:
                outer = None if self._target is None else transform.rings_to_pixels(self._target.rings)[0]
                silhouette = None if outer is None else line_path(outer, closed=True)
                lengths.append((self.areas.gap.greatest, gap, silhouette))
        if Overlay.SMALL_PARTS in self.overlays:
            lengths += [(part.size, transform.to_pixels(part.ends(panels)), None) for part in self._rigid.small]
        occupied: list[QRectF] = []
        for length, ends, shape in lengths:
            paint_dimension(
                painter,
                ends,
                readable_width(length * self.mm_per_unit),
                self.palette_,
                occupied,
                shape,
            )

    @property
    def _nearness(self) -> float:
        """Opacity of the comparison with the target: 1 at the target's angle, none far from it."""
        return 0.0 if self.design is None else 1.0 - abs(self.phi - self.design.phi_target) / COMPARED_WITHIN

    def compare_ideal(self) -> Mismatch | None:
        """Find the areas of the ideal motion at this angle, once for a design and an angle."""
        if self.design is None or self._target is None or Overlay.MISMATCH not in self.overlays:
            return None
        if self._nearness <= 0.0:
            return None
        if self._ideal_areas is None or self._ideal_areas[0] != self.phi:
            self._ideal_areas = self.phi, design_mismatch(self.design, self._target, self.phi)
        return self._ideal_areas[1]

    def _paint_comparison(self, painter: QPainter, transform: ViewTransform, pose: CutPose | None) -> None:
        """Sheet against target, as it is cut or in its ideal motion."""
        self.areas = None
        if self.design is None or self._target is None:
            return
        nearness = self._nearness
        if Overlay.MISMATCH in self.overlays and nearness > 0.0:
            if pose is None:
                self.areas = self.compare_ideal()
            else:
                self.areas = self._compare_cut(self._target)
            if self.areas is not None:
                painter.setOpacity(min(1.0, 2.0 * nearness))
                paint_mismatch(painter, self.areas, transform, self.palette_)
            painter.setOpacity(1.0)
        if Overlay.TARGET in self.overlays:
            painter.setOpacity(min(1.0, max(FAINT, 2.0 * nearness)))
            paint_target_line(painter, transform.rings_to_pixels(self._target.rings), self.palette_)
            painter.setOpacity(1.0)
            self._paint_second(painter, transform)

    def _compare_cut(self, target: Outline) -> Mismatch | None:
        """Find the areas of the sheet as cut, in the pose of its match."""
        sheet, made = self._cut, self._made
        if sheet is None or made is None:
            return None
        return self._compared(
            (sheet, self.phi), lambda: mismatch_of_area(target.rings, sheet.motion.area(made[1], self.phi))
        )

    def _compared(self, key: tuple[object, float], compare: Callable[[], Mismatch]) -> Mismatch:
        """The areas of a made design at an angle, found once."""
        if self._made_areas is None or self._made_areas[0] != key:
            self._made_areas = key, compare()
        return self._made_areas[1]

    def _paint_second(self, painter: QPainter, transform: ViewTransform) -> None:
        """The second target near its angle."""
        nearness = 0.0 if self.second is None else 1.0 - abs(self.phi - self.second[0]) / COMPARED_WITHIN
        if self.second is not None and nearness > 0.0:
            painter.setOpacity(min(1.0, 2.0 * nearness))
            paint_target_line(painter, transform.to_pixels(self.second[1]), self.palette_, dashed=True)
            painter.setOpacity(1.0)

    def _paint_faults(self, painter: QPainter, transform: ViewTransform) -> None:
        self.faults = ()
        if Overlay.FAULTS not in self.overlays:
            return
        self.faults = self.find_faults()
        for fault in self.faults:
            paint_fault(painter, transform.to_pixels(np.array(fault.where)), fault.kind, self.palette_)

    def paint_notes(self, painter: QPainter) -> None:
        if self.design is None:
            if self._target is not None:
                _, headline, hint = self._hint
                said = fitted(painter.fontMetrics(), (f"{headline}  {hint}", headline), self.width() - 40.0)
                paint_caption(painter, said, self.width(), self.palette_)
            return
        labels = self.legend(painter.fontMetrics())
        paint_legend(painter, [chip for chip, _ in labels], [box for _, box in labels], self.palette_)
        if self.caption:
            paint_caption(painter, self.caption, self.width(), self.palette_)
        paint_colour_bars(painter, self.scales, self.bar_boxes([one.title for one in self.scales]), self.palette_)
        self.voids.paint_label(painter, self.palette_)


class FaultTour(QObject):
    """Watches one view for clicks on faults; the view still gets every click."""

    phi_wanted = Signal(float)  #: radians, the angle at which the fault can be seen
    status = Signal(str)

    def __init__(self, view: LayoutView) -> None:
        super().__init__(view)
        self._view = view
        self._place = -1
        self._pressed: QPointF | None = None
        view.installEventFilter(self)

    def step(self, forth: int) -> None:
        """Go to the next fault, or to the one before; after the last one comes the first."""
        found = self._view.find_faults()
        if not found:
            self.status.emit(tr("No faults: no inverted panels, and the sheet does not touch itself."))
            return
        self._place = (self._place + forth) % len(found) if self._place >= 0 else (0 if forth > 0 else len(found) - 1)
        self.visit(found[self._place])
        self.status.emit(numbered_fault(found[self._place].kind, self._place + 1, len(found)))

    def visit(self, fault: Fault) -> None:
        """Show one fault, at the angle at which it is seen."""
        if fault.phi is not None:
            self.phi_wanted.emit(fault.phi)
        self._view.zoom_to(fault.where, CLOSE_UP)

    def forget(self) -> None:
        """Another design: begin with its first fault."""
        self._place = -1

    def eventFilter(self, watched: QObject, event: QEvent) -> bool:  # noqa: N802 - Qt's name
        if isinstance(event, QMouseEvent) and event.button() is Qt.MouseButton.LeftButton:
            if event.type() == QEvent.Type.MouseButtonPress:
                self._pressed = event.position()
            elif event.type() == QEvent.Type.MouseButtonRelease and self._pressed is not None:
                moved = (event.position() - self._pressed).manhattanLength()
                fault = self._view.fault_at(event.position()) if moved < STILL else None
                self._pressed = None
                if fault is not None:
                    self.visit(fault)
                    self.status.emit(tr(FAULT_SENTENCES[fault.kind]))
        return False


def numbered_fault(kind: FaultKind, number: int, count: int) -> str:
    """One of all faults, for the status line; ``number`` counts from 1."""
    if kind is FaultKind.INVERTED:
        return tr("Fault {number} of {count}: inverted or collapsed panel.", number=number, count=count)
    if kind is FaultKind.CONTACT:
        return tr("Fault {number} of {count}: first contact during deployment.", number=number, count=count)
    return tr("Fault {number} of {count}: the sheet overlaps itself here.", number=number, count=count)
