"""The two states that a design runs between: what its sheet starts as while it is flat, and what it opens into; and
the second target that it passes, if it was made for one.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import lru_cache
from typing import TYPE_CHECKING

import numpy as np

from kirigami_studio.evaluate.candidate import Candidate
from kirigami_studio.evaluate.opened_size import opened_size
from kirigami_studio.evaluate.posed_design import PosedDesign
from kirigami_studio.evaluate.second_target import SecondMatch
from kirigami_studio.foundation.arrays import FloatArray, ShapeRings
from kirigami_studio.foundation.words import mark, tr
from kirigami_studio.lattice.deployment import Deployment
from kirigami_studio.lattice.laying import start_match
from kirigami_studio.lattice.sheet import RimPath, Sheet, anchor_points
from kirigami_studio.outlines.outline import Outline
from kirigami_studio.outlines.starts import RECTANGLE, StartShape

if TYPE_CHECKING:
    from kirigami_studio.studio.as_cut import AsCut

#: Starts that are no silhouettes, by what their names begin with.
START_NAMES = {
    "auto": mark("auto"),
    "rectangle": mark("rectangle"),
    "square": mark("square"),
    "circle": mark("circle"),
    "ellipse": mark("ellipse"),
    "triangle": mark("triangle"),
    "hexagon": mark("hexagon"),
    "polygon": mark("polygon"),
    "gable": mark("gable"),
    "notch": mark("notched rectangle"),
}


def start_words(name: str) -> str:
    """A start's name as people read it: "ellipse 3:2" for "ellipse:3:2"."""
    kind, _, numbers = name.partition(":")
    return f"{tr(START_NAMES[kind])} {numbers}".strip() if kind in START_NAMES else tr(name)


def start_of(candidate: Candidate) -> str:
    """What a design starts as, in words; a design keeps its own start, whatever the settings say now."""
    sheet, name = candidate.sheet, dict(candidate.made_with).get("start", "")
    if name:
        return start_words(name)
    return start_words(RECTANGLE.name) if sheet.start is None else tr("own shape")


def starts_as(candidate: Candidate, start: StartShape) -> bool:
    """Whether a design was made with this start; outlines may share a name."""
    if start.outline is not None:
        return dict(candidate.made_with).get("start_sha256") == start.digest
    return start_of(candidate) == start_words(start.name)


def size_words(width_mm: float, height_mm: float) -> str:
    """A size as people read it: in whole millimetres from 100 on, below in tenths."""
    width, height = (round(length, 0 if length >= 100.0 else 1) for length in (width_mm, height_mm))
    return tr("{width:g} \N{MULTIPLICATION SIGN} {height:g} mm", width=width, height=height)


@lru_cache(maxsize=1024)
def match_of_start(sheet: Sheet) -> float:
    """IoU of a flat sheet with its start outline, kept: shown with every card."""
    return start_match(sheet)


def shown_match(candidate: Candidate, as_cut: AsCut | None) -> float:
    """IoU (0..1) with the target that is called the match of a design everywhere.

    Of its pieces where they were put together, which grow beyond their lattice; else of its ideal sheet, trimmed if it
    is.  The lattice's own stays in the score.
    """
    return as_cut.iou if as_cut is not None and as_cut.of_pieces and as_cut.iou is not None else candidate.match


def shown_flat_match(candidate: Candidate, as_cut: AsCut | None) -> float | None:
    """The same of the flat design with its start; None where its edge is trimmed off."""
    if as_cut is not None and as_cut.of_pieces:
        return as_cut.flat_iou
    return match_of_start(candidate.sheet) if candidate.trim is None else None


def start_outline(start: StartShape, grid: tuple[int, int]) -> FloatArray:
    """Outline of a start (P, 2), y up, of any size; a plain rectangle has as many square cells as its grid."""
    if start.outline is not None:
        return start.outline.points
    rows, columns = grid
    width = (columns + 1) / (rows + 1) if start.aspect is None else start.aspect
    return np.array([(0.0, 0.0), (width, 0.0), (width, 1.0), (0.0, 1.0)])


def flat_size(deployment: Deployment, width_mm: float) -> tuple[float, float]:
    """Width and height, mm, of a flat sheet that is ``width_mm`` wide."""
    across, up = np.ptp(deployment.compact, axis=0).tolist()
    return width_mm, up * width_mm / across


@dataclass(frozen=True, slots=True, eq=False)
class State:
    """One end of the motion."""

    name: str  #: of the start, or of the target
    outline: ShapeRings  #: (P, 2), and its holes; what the sheet is to look like, y up, of any size
    size_mm: tuple[float, float]  #: (width, height), mm; of the flat sheet; of the target as the opened sheet shows it
    #: 0..1, or None; IoU of the sheet with that outline; None where the sheet is trimmed: its edge is cut off.
    match: float | None
    is_flat: bool = False  #: whether it is the flat sheet

    @property
    def named(self) -> str:
        """Its name after the word for its end of the motion."""
        return tr("flat: {name}", name=self.name) if self.is_flat else tr("open: {name}", name=self.name)

    @property
    def size_text(self) -> str:
        """Width and height in mm."""
        return size_words(*self.size_mm)

    def texts(self) -> tuple[str, ...]:
        """What is known of it, longest text first."""
        if self.match is None:
            return (
                tr("{name}  ·  {size}  ·  trimmed", name=self.named, size=self.size_text),
                tr("{name}  ·  {size}", name=self.named, size=self.size_text),
                self.named,
                self.name,
            )
        percent = 100.0 * self.match
        return (
            tr("{name}  ·  {size}  ·  match {percent:.1f} %", name=self.named, size=self.size_text, percent=percent),
            tr("{name}  ·  {size}  ·  {percent:.1f} %", name=self.named, size=self.size_text, percent=percent),
            tr("{name} {percent:.1f} %", name=self.named, percent=percent),
            self.named,
            self.name,
        )


@dataclass(frozen=True, slots=True, eq=False)
class PassedState:
    """A second target on the way of a design."""

    name: str
    outline: FloatArray  #: (P, 2)
    size_mm: tuple[float, float]  #: (width, height), mm; as the sheet shows it
    match: float  #: 0..1; IoU of the sheet, untrimmed, with it
    phi: float  #: radians
    trimmed: bool  #: whether the design is trimmed: its match is still that of the whole sheet

    @classmethod
    def of(cls, candidate: Candidate, second: SecondMatch, width_mm: float) -> PassedState:
        """That of a design whose flat sheet is ``width_mm`` wide."""
        outline = second.target.outline
        unit = width_mm / (float(np.ptp(anchor_points(candidate.sheet)[:, 0])) * second.match.transform.scale)
        width, height = (unit * np.ptp(outline.points, axis=0)).tolist()
        match, phi = second.match.iou_exact, second.target.phi
        return cls(tr(outline.name), outline.points, (width, height), match, phi, candidate.trim is not None)

    def texts(self) -> tuple[str, ...]:
        """What is known of it, longest text first."""
        values = {"name": self.name, "angle": math.degrees(self.phi), "percent": 100.0 * self.match}
        size = size_words(*self.size_mm)
        if self.trimmed:
            return (
                tr("{name} at {angle:.0f}°  ·  {percent:.1f} % untrimmed", **values),
                tr("{name}  ·  {percent:.1f} % untrimmed", **values),
                tr("{percent:.1f} % untrimmed", **values),
            )
        return (
            tr("{name} at {angle:.0f}°  ·  {size}  ·  match {percent:.1f} %", size=size, **values),
            tr("{name} at {angle:.0f}°  ·  {percent:.1f} %", **values),
            tr("{name} {percent:.1f} %", **values),
            tr("{angle:.0f}° {percent:.1f} %", **values),
        )

    def line(self) -> str:
        """The same as a sentence, for tooltips."""
        values = {"name": self.name, "angle": math.degrees(self.phi), "percent": 100.0 * self.match}
        if self.trimmed:
            return tr("On its way, at {angle:.0f}°: {name}; match {percent:.2f} %, untrimmed", **values)
        size = size_words(*self.size_mm)
        return tr("On its way, at {angle:.0f}°: {name}, {size}; match {percent:.2f} %", size=size, **values)


@dataclass(frozen=True, slots=True, eq=False)
class TwoStates:
    """Both ends of a design's motion: the flat sheet, and the sheet at the target angle."""

    start: State
    target: State
    phi: float  #: radians; the target angle
    passed: PassedState | None = None  #: the second target between them

    @classmethod
    def of(
        cls,
        candidate: Candidate,
        design: PosedDesign,
        target: Outline,
        width_mm: float,
        as_cut: AsCut | None = None,
    ) -> TwoStates:
        """Those of a design whose flat sheet is ``width_mm`` wide, with what is known of it as cut."""
        sheet, deployment = candidate.final_sheet, design.deployment
        outline = RimPath(*sheet.grid, sheet.start, sheet.cell).outline()
        flat = flat_size(deployment, width_mm)
        opened = opened_size(deployment, design.pose, target, width_mm).opened
        return cls(
            State(start_of(candidate), outline, flat, shown_flat_match(candidate, as_cut), is_flat=True),
            State(tr(target.name), target.rings, opened, shown_match(candidate, as_cut)),
            candidate.final_phi,
            None if candidate.second is None else PassedState.of(candidate, candidate.second, width_mm),
        )

    def lines(self) -> tuple[str, ...]:
        """All of them as sentences, for tooltips, from flat to open."""
        passed = () if self.passed is None else (self.passed.line(),)
        return self.flat_line(), *passed, self.open_line()

    def flat_line(self) -> str:
        """The flat sheet as a sentence."""
        start = self.start
        names = {"name": start.name, "size": start.size_text}
        if start.match is None:
            return tr("Flat: {name}, {size}; its edge is trimmed", **names)
        return tr("Flat: {name}, {size}; match {percent:.2f} %", percent=100.0 * start.match, **names)

    def open_line(self) -> str:
        """The opened sheet as a sentence."""
        target = self.target
        return tr(
            "Open at {phi:.0f}°: {name}, {size}; match {percent:.2f} %",
            phi=math.degrees(self.phi),
            name=target.name,
            size=target.size_text,
            percent=100.0 * (target.match or 0.0),
        )
