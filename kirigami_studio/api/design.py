"""Designs: a sheet for a target, with its score and its place, and what can be done with it."""

from __future__ import annotations

import os
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import lru_cache
from pathlib import Path
from typing import TYPE_CHECKING, Any, Unpack

import numpy as np
import numpy.typing as npt
from shapely.geometry import Polygon

from kirigami_studio.api.choices import (
    checked_choices,
    connector_widths,
    connectors,
    cut_choices,
    explicit_signature,
)
from kirigami_studio.api.pictures import states_picture
from kirigami_studio.api.sheet import Sheet, SheetLike, decode
from kirigami_studio.api.target import Target, TargetLike, load_target
from kirigami_studio.evaluate.candidate import Candidate, Origin
from kirigami_studio.evaluate.mask_siou import mask_siou
from kirigami_studio.evaluate.posed_design import PosedDesign, polygons_of
from kirigami_studio.evaluate.score import Score, evaluate
from kirigami_studio.export.registry import export, find_exporter
from kirigami_studio.foundation.arrays import FloatArray
from kirigami_studio.foundation.errors import ExportError
from kirigami_studio.lattice import sheet as lattice_sheet
from kirigami_studio.lattice.deployment import Deployment, check_phi, deploy
from kirigami_studio.outlines.outline import Outline
from kirigami_studio.project.candidate_edits import set_label
from kirigami_studio.project.document import Document
from kirigami_studio.project.export_job import chosen_candidate, picture_job
from kirigami_studio.project.labels import cleaned_name
from kirigami_studio.project.store import SUFFIX, save
from kirigami_studio.settings.design import DesignSettings
from kirigami_studio.settings.fabrication import CutChange

if TYPE_CHECKING:
    from kirigami_studio.api.cuts import Cuts, Exported
    from kirigami_studio.api.simulation import Simulation

#: Files that need no planned cuts.
PICTURES = (".png", ".gif")


@dataclass(frozen=True, slots=True, eq=False, repr=False)
class Design:
    """A sheet for a target: what a run found, a project holds, or :meth:`Sheet.for_target` made.

    In a notebook it shows itself flat, half open and closed over its target.

    Attributes
    ----------
    document : Document
        The project that it belongs to, with this design chosen.
    """

    document: Document

    @property
    def candidate(self) -> Candidate:
        """The value of the program: sheet, score, trim, and where it came from."""
        return chosen_candidate(self.document)

    @property
    def name(self) -> str:
        """What it is called, A1 unless it was given a name."""
        return self.document.name_of(self.candidate)

    @property
    def target(self) -> Target:
        assert self.document.target is not None  # chosen_candidate refuses documents without one
        return Target(self.document.target)

    @property
    def sheet(self) -> Sheet:
        """The sheet that is cut, in its own frame; of a trimmed design the one that was fitted for that."""
        return Sheet(_deployed(self.candidate.final_sheet))

    @property
    def ratios(self) -> FloatArray:
        """Side ratios of its voids (m, n), the top row first; read-only."""
        return self.sheet.ratios

    @property
    def grid(self) -> tuple[int, int]:
        """(rows, columns) of voids."""
        return self.candidate.sheet.grid

    @property
    def phi(self) -> float:
        """Angle (radians) at which it shows the target."""
        return self.candidate.final_phi

    @property
    def score(self) -> Score:
        """All figures of the sheet, untrimmed, against the target."""
        return self.candidate.score

    @property
    def siou(self) -> float:
        """IoU of 128-pixel masks under the best similarity, as in the paper."""
        return self.score.siou

    @property
    def iou(self) -> float:
        """Exact IoU of the polygons; of a trimmed design that of what is left."""
        trim = self.candidate.trim
        return self.score.iou_exact if trim is None else trim.iou

    @property
    def tv(self) -> float:
        """The paper's total variation of the ratios, over m n."""
        return self.score.tv

    @property
    def area_cv(self) -> float:
        """Coefficient of variation of the panels' areas: 0 for even ones."""
        return self.score.evenness.area_cv

    @property
    def feasible(self) -> bool:
        """Whether no quad is inverted and nothing touches or overlaps on the way to its angle."""
        return self.score.feasible

    @property
    def trimmed(self) -> bool:
        """Whether edge panels were cut along the target."""
        return self.candidate.trim is not None

    @property
    def symmetry(self) -> str | None:
        """The largest symmetry that its sheet has, such as ``mirror``."""
        found = self.candidate.symmetry
        return None if found is None else found.label

    @property
    def posed(self) -> PosedDesign:
        """The moving sheet in the target's frame."""
        return _posed(self.candidate)

    def panels(self, phi: float | None = None) -> list[FloatArray]:
        """What there is of every panel, over the target: (P, 2) each, row by row; at the design's own angle or another.

        Of trimmed designs, panels of which nothing stays are left out.
        """
        return self.posed.parts(self._angle(phi))

    def outline(self, phi: float | None = None) -> FloatArray:
        """The sheet's boundary over the target (L, 2), before anything was trimmed off."""
        angle = self._angle(phi)
        return self.posed.outline(self.posed.nodes(angle), angle)

    def panel_polygons(self, phi: float | None = None) -> npt.NDArray[np.object_]:
        """The panels over the target as Shapely polygons: (P,)."""
        return polygons_of(self.panels(phi))

    def polygon(self, phi: float | None = None) -> Polygon:
        """The silhouette over the target as a Shapely polygon, before anything was trimmed off."""
        return Polygon(self.outline(phi))

    def _angle(self, phi: float | None) -> float:
        return self.phi if phi is None else check_phi(phi)

    def plan_cuts(
        self,
        *,
        hinge_mm: Mapping[int, float] | None = None,
        removed: Sequence[int] | None = None,
        **choices: Unpack[CutChange],
    ) -> Cuts:
        """Plan the cuts in a material; what is left out is as the project has it.

        Parameters
        ----------
        material : str
            One of :func:`material_names`.
        width_mm : float
            Width of the flat sheet (100 in new projects).
        connector_mm, kerf_mm : float
            Finished width of the connectors, width of a cut; the material's own unless given.
        style : str
            How slits end at their connectors: ``centred``, ``straight``, ``round``, ``teardrop``, ``arc``, ``double``.
        order : str
            ``shortest``, ``rows``, ``inside-out`` or ``spread``.
        tabs, tab_mm : int, float
            Uncut places of the outline, and their finished width.
        copies, copy_gap_mm : int, float
            Sheets in one file (0: as many as fit on the bed), and the gap between them.
        hinge_mm : mapping of int to float
            Widths of single connectors by their numbers.
        removed : sequence of int
            Connectors to cut through.
        engrave : bool
            Whether the design's name is engraved.
        profile : str
            What machine files are for: ``any``, ``lightburn``, ``k40``, ``single``, ``layers``, ``slots``.
        dxf_version : str
            ``R2010`` or ``R12``.
        paper : str
            ``none``, ``a4`` or ``letter``, over whose pages PDFs are spread.
        markers : bool
            Whether LightBurn projects mark the connectors.

        Raises
        ------
        FabricationError, UsageError
            No such material or choice, or cuts that cannot be planned.

        Examples
        --------
        >>> import numpy as np
        >>> import kirigami_studio as ks
        >>> design = ks.decode(np.ones((4, 4))).for_target("square")
        >>> design.plan_cuts(material="film-uv", width_mm=60).size_mm
        (60.0, 60.0)
        """
        from kirigami_studio.api.cuts import plan_cuts

        given = checked_choices({**choices}, cut_choices(), "plan_cuts")
        if hinge_mm is not None:
            given["hinge_mm"] = connector_widths(hinge_mm)
        if removed is not None:
            given["removed"] = connectors(removed)
        return plan_cuts(self, {name: value for name, value in given.items() if value is not None})

    plan_cuts.__signature__ = explicit_signature(plan_cuts, cut_choices(), over=True)  # type: ignore[attr-defined]

    def simulate(self, **cuts: Any) -> Simulation:
        """Close the sheet on the connectors of its cuts; takes what :meth:`plan_cuts` takes."""
        return self.plan_cuts(**cuts).simulate()

    def export(self, path: str | os.PathLike[str], **cuts: Any) -> Exported:
        """Write a cut file or a picture, by its extension; takes what :meth:`plan_cuts` takes.

        Parameters
        ----------
        path : path
            ``.dxf``, ``.svg``, ``.pdf`` or ``.lbrn2``: cut files; ``.png``: the closed sheet; ``.gif``: its motion.

        Returns
        -------
        Exported
            DXF and SVG files are read back by two independent readers.

        Raises
        ------
        ExportError, FabricationError, UsageError
            An unknown extension, a place that cannot be written, or a sheet that cannot be cut.
        """
        from kirigami_studio.api.cuts import Exported

        goal = Path(path)
        find_exporter(goal)
        if cuts or goal.suffix.lower() not in PICTURES:
            return self.plan_cuts(**cuts).export(goal)
        return Exported((export(picture_job(self.document), goal),))

    def save(self, path: str | os.PathLike[str]) -> Path:
        """Write a project (.kiri) of this design alone.

        Raises
        ------
        ExportError
            Another extension, or a place that cannot be written.
        """
        label = self.document.label
        alone = replace(
            self.document, candidates=(self.candidate,), chosen=0, marks=(), labels=() if label is None else (label,)
        )
        return save_project(alone, path)

    def __repr__(self) -> str:
        rows, columns = self.grid
        told = "" if self.feasible else ", not feasible"
        return f"<Design {self.name} for {self.target.name!r}: {rows} x {columns} voids, IoU {self.iou:.4f}{told}>"

    def _repr_svg_(self) -> str:
        rows, columns = self.grid
        figures = [f"IoU {self.iou:.3f}", f"{rows} × {columns}", f"CV {self.area_cv:.2f}"]
        details = "  ·  ".join(figures if self.feasible else [*figures, "not feasible"])
        return states_picture(self.posed, self.target.points, f"{self.name}  ·  {self.target.name}", details)


def score(ratios: SheetLike, target: TargetLike, *, phi: float = 0.0) -> Score:
    """Score ratios against a target, under the best similarity.

    Parameters
    ----------
    ratios : whatever :func:`decode` takes
    target : whatever :func:`load_target` reads
    phi : float, radians
        At which the sheet is meant to show it.

    Returns
    -------
    Score
        ``siou`` (128-pixel masks), ``iou_exact``, ``uniform_siou`` and ``uniform_iou`` (the floor), ``tv``,
        ``feasible``, ``evenness.area_cv`` and more.

    Examples
    --------
    >>> import numpy as np
    >>> import kirigami_studio as ks
    >>> round(ks.score(np.ones((4, 4)), "circle").iou_exact, 2)
    0.84
    """
    return evaluate(decode(ratios).deployment, load_target(target).outline, phi)


def siou(mask: npt.ArrayLike, other: npt.ArrayLike) -> float:
    """The paper's sIoU of two masks (H, W), of any sizes, row 0 on top.

    Raises
    ------
    KirigamiError
        A mask that is empty, not two-dimensional, or not finite.

    Examples
    --------
    >>> import kirigami_studio as ks
    >>> heart, circle = ks.load_target("heart").mask(), ks.load_target("circle").mask()
    >>> ks.siou(heart, heart), 0.7 < ks.siou(heart, circle) < 0.9
    (1.0, True)
    """
    value, _ = mask_siou(mask, other)
    return value


def design_of_sheet(deployment: Deployment, target: TargetLike | None, phi: float, name: str) -> Design:
    """A sheet as a design for a target, or for the silhouette that it has itself."""
    phi = check_phi(phi)
    if target is None:
        outline = Outline.from_points(deployment.outline(phi), "own silhouette")
    else:
        outline = load_target(target).outline
    settings = DesignSettings(deployment.sheet.grid, auto_grid=False, phi=phi)
    found = Candidate(deployment.sheet, evaluate(deployment, outline, phi), 0, 0, origin=Origin.EDITED)
    document = Document(outline, settings, (found,), 0)
    return Design(set_label(document, 0, cleaned_name(name), "").document if name else document)


def save_project(document: Document, path: str | os.PathLike[str]) -> Path:
    """Write a project file.

    Raises
    ------
    ExportError
        Another extension, or a place that cannot be written.
    """
    goal = Path(path)
    if goal.suffix.lower() != SUFFIX:
        raise ExportError("api.not_a_project_name", path=goal, suffix=SUFFIX)
    save(document, goal)
    return goal


@lru_cache(maxsize=256)
def _deployed(sheet: lattice_sheet.Sheet) -> Deployment:
    return deploy(sheet)


@lru_cache(maxsize=256)
def _posed(candidate: Candidate) -> PosedDesign:
    motion = _deployed(candidate.final_sheet)
    return PosedDesign(motion, candidate.final_pose, candidate.final_phi, candidate.trim)
