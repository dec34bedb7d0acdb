"""Sheets, designs and cuts: a design is a sheet for a target, planned in a material.

- A *sheet* is one table of ratios, decoded exactly, at every angle.
- A *design* is a sheet for a target, with its score and its place.
- *Cuts* are those of a design in a material: planned, checked, simulated, judged and written.
"""

from __future__ import annotations

import html
import os
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import lru_cache
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypeAlias, Unpack, overload

import numpy as np
import numpy.typing as npt
import shapely
from shapely.geometry import Polygon

from kirigami_studio.api.choices import (
    CUTS,
    CutKeywords,
    checked_choices,
    connector_widths,
    connectors,
    explicit_docstring,
    explicit_signature,
    keywords_of,
    number,
    panel_numbers,
)
from kirigami_studio.api.pictures import cuts_picture, plot_sheet, states_picture
from kirigami_studio.api.simulation import Simulation
from kirigami_studio.api.target import Target, TargetLike, load_target
from kirigami_studio.api.values import at_angles, read_only
from kirigami_studio.assembly.pieces import Assembly
from kirigami_studio.assembly.posed_pieces import PosedPieces
from kirigami_studio.evaluate.candidate import Candidate, Origin
from kirigami_studio.evaluate.feasibility import Feasibility, feasibility_of_many
from kirigami_studio.evaluate.mask_siou import mask_siou
from kirigami_studio.evaluate.porosity import Porosity
from kirigami_studio.evaluate.posed_design import PosedDesign, polygons_of
from kirigami_studio.evaluate.score import Score, evaluate
from kirigami_studio.evaluate.silhouette import rasterise
from kirigami_studio.evaluate.similarity import Similarity
from kirigami_studio.export.cut_motion import CutMotion
from kirigami_studio.export.registry import export, find_writer
from kirigami_studio.export.verification import Verification
from kirigami_studio.fabricate.checks import PlanReport
from kirigami_studio.fabricate.cut_plan import CutPlan
from kirigami_studio.fabricate.material import Construction
from kirigami_studio.foundation.arrays import BoolArray, FloatArray
from kirigami_studio.foundation.errors import (
    ExportError,
    FabricationError,
    KirigamiError,
    ProjectError,
    RatioError,
    UsageError,
)
from kirigami_studio.foundation.paper import MASK_SIZE
from kirigami_studio.lattice import sheet as lattice_sheet
from kirigami_studio.lattice.deployment import Deployment, check_phi, deploy
from kirigami_studio.lattice.ratio_field import RatioField
from kirigami_studio.lattice.sheet_files import read_sheet, sheet_json, sheet_of_json
from kirigami_studio.mechanics.closing import CLOSED, STEPS
from kirigami_studio.outlines.outline import Outline
from kirigami_studio.project.candidate_edits import set_label
from kirigami_studio.project.document import Document
from kirigami_studio.project.edits import ALONE
from kirigami_studio.project.labels import cleaned_name
from kirigami_studio.project.store import CUT_FILES, SUFFIX, load, save
from kirigami_studio.settings.design import DesignSettings
from kirigami_studio.settings.fabrication import CutChange, FabricationSettings, is_pinned, with_choices
from kirigami_studio.studio.as_cut import AsCut, Leading, simulated
from kirigami_studio.studio.assembling import assembled
from kirigami_studio.studio.cutting import check_connectors
from kirigami_studio.studio.file_kinds import FILE_KINDS
from kirigami_studio.studio.making import (
    CutRequest,
    MadePieces,
    Output,
    Planned,
    chosen_candidate,
    has_pieces,
    judged,
    picture_job,
    pieces_of,
    planned,
    posed_pieces,
    written,
    written_pieces,
)
from kirigami_studio.studio.two_states import shown_match
from kirigami_studio.studio.verdict import Level, Verdict, judge_assembled

if TYPE_CHECKING:
    from matplotlib.axes import Axes

#: Files that hold a project, whose chosen design is meant.
PROJECTS = (SUFFIX, *CUT_FILES)
#: Files that need no planned cuts.
PICTURES = tuple(kind.extension for kind in FILE_KINDS if not kind.cuts)
#: Extension of pages to share.
PAGE = ".html"
#: Colours of the levels of a verdict, on white and on black.
LEVELS = {Level.READY: "#30a46c", Level.CARE: "#d9730d", Level.FAILS: "#e5484d"}


@read_only
@dataclass(frozen=True, slots=True, eq=False, repr=False)
class Sheet:
    """One sheet at every angle phi, from pi (flat) to 0 (closed again).

    Lengths are in unit cells, angles in radians.  Nodes, panels, voids, area and porosity take angles of any shape S,
    too: their arrays then have that shape in front.

    In a notebook it shows itself flat, half open and closed.

    Attributes
    ----------
    deployment : Deployment
        The value of the program that it wraps.
    """

    deployment: Deployment

    @property
    def ratios(self) -> FloatArray:
        """Side ratios of the voids (m, n), the top row first; read-only."""
        return self.deployment.field.ratio

    @property
    def grid(self) -> tuple[int, int]:
        """(rows, columns) of voids."""
        return self.deployment.sheet.grid

    def nodes(self, phi: npt.ArrayLike = 0.0) -> FloatArray:
        """Positions of all nodes: (N, 2)."""
        found: FloatArray = at_angles(self.deployment.nodes, phi)
        return found

    def panels(self, phi: npt.ArrayLike = 0.0) -> FloatArray:
        """Corners of the panels, counter-clockwise: (m + 1, n + 1, 4, 2)."""
        found: FloatArray = at_angles(self.deployment.panels, phi)
        return found

    def voids(self, phi: npt.ArrayLike = 0.0) -> FloatArray:
        """Corners of the voids: (m, n, 4, 2)."""
        found: FloatArray = at_angles(self.deployment.voids, phi)
        return found

    def outline(self, phi: float = 0.0) -> FloatArray:
        """The boundary (L, 2), counter-clockwise, the first vertex not repeated."""
        return self.deployment.outline(phi)

    def panel_polygons(self, phi: float = 0.0) -> npt.NDArray[np.object_]:
        """The panels as Shapely polygons: (m + 1, n + 1)."""
        return np.asarray(shapely.polygons(self.panels(phi)))

    def void_polygons(self, phi: float = 0.0) -> npt.NDArray[np.object_]:
        """The voids as Shapely polygons: (m, n)."""
        return np.asarray(shapely.polygons(self.voids(phi)))

    def polygon(self, phi: float = 0.0) -> Polygon:
        """The silhouette as a Shapely polygon."""
        return Polygon(self.outline(phi))

    def mask(self, phi: float = 0.0, size: int = MASK_SIZE) -> BoolArray:
        """The silhouette's picture (size, size), row 0 on top; the longer side fills it."""
        return rasterise(self.outline(phi), size)

    @overload
    def area(self, phi: float = ...) -> float: ...
    @overload
    def area(self, phi: npt.ArrayLike) -> FloatArray: ...
    def area(self, phi: npt.ArrayLike = 0.0) -> float | FloatArray:
        """Area of panels and voids together, unit cells squared; (S,) for angles (S,)."""
        found: float | FloatArray = at_angles(self.deployment.area, phi)
        return found

    @overload
    def porosity(self, phi: float = ...) -> float: ...
    @overload
    def porosity(self, phi: npt.ArrayLike) -> FloatArray: ...
    def porosity(self, phi: npt.ArrayLike = 0.0) -> float | FloatArray:
        """Share of that area that is voids; (S,) for angles (S,)."""
        found: float | FloatArray = at_angles(Porosity.of(self.deployment).at, phi)
        return found

    def feasibility(self, phi: float = 0.0) -> Feasibility:
        """Whether no quad is inverted and nothing touches or overlaps on the way from flat to phi.

        ``n_invalid``, ``overlap_ratio`` and ``contact`` say why not.
        """
        (found,) = feasibility_of_many([self.deployment], check_phi(phi))
        return found

    def for_target(self, target: TargetLike | None = None, *, phi: float = 0.0, name: str = "") -> Design:
        """This sheet as a design, scored and laid over a target, to be planned and exported.

        Parameters
        ----------
        target : Target or whatever :func:`load_target` reads, optional
            The sheet's own silhouette at ``phi`` unless given.
        phi : float, radians
            At which the sheet is meant to show it.
        name : str
            What the design is called; A1 unless given.

        Examples
        --------
        >>> import numpy as np
        >>> import kirigami_studio as ks
        >>> ks.decode(np.ones((4, 4))).for_target("square").iou > 0.999
        True
        """
        return _design_of_sheet(self.deployment, target, phi, name)

    def to_json(self) -> dict[str, Any]:
        """Content of a sheet file, for :func:`decode`: ``ratio``, ``rim``, ``start``, ``cell``."""
        return sheet_json(self.deployment.sheet)

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Sheet) and self.deployment.sheet == other.deployment.sheet

    def __hash__(self) -> int:
        return hash(self.deployment.sheet)

    def __repr__(self) -> str:
        rows, columns = self.grid
        low, high = float(self.ratios.min()), float(self.ratios.max())
        return f"<Sheet of {rows} x {columns} voids, ratios {low:.3g} to {high:.3g}>"

    def _repr_svg_(self) -> str:
        rows, columns = self.grid
        design = PosedDesign(self.deployment, Similarity(), 0.0)
        return states_picture(design, None, f"{rows} × {columns} voids")


#: What :func:`decode` takes.
SheetLike: TypeAlias = "Sheet | Design | str | os.PathLike[str] | npt.ArrayLike"


def decode(
    ratios: SheetLike,
    *,
    rim: Mapping[str, npt.ArrayLike] | None = None,
    start: npt.ArrayLike | None = None,
    cell: tuple[float, float] = (1.0, 1.0),
) -> Sheet:
    """Decode ratios into the exact sheet: one linear solve, then any angle in no time.

    Parameters
    ----------
    ratios : (m, n) array, path, Sheet or Design
        Positive numbers, the top row first; or a sheet file (.json, .npy) or a project, whose chosen design is meant.
    rim : mapping of str to array, optional
        Positions of the mouths along ``top``, ``right``, ``bottom`` and ``left``, in unit cells, left to right and top
        to bottom; even for sides that are left out.
    start : (P, 2) array, optional
        Outline of the flat sheet from its top left corner on; a rectangle unless given.
    cell : (width, height)
        Scales the flat sheet.

    Raises
    ------
    RatioError, GridError, SheetError
        Not such a table, or not a sheet.

    Examples
    --------
    >>> import math
    >>> import numpy as np
    >>> import kirigami_studio as ks
    >>> sheet = ks.decode(np.ones((10, 10)))
    >>> sheet
    <Sheet of 10 x 10 voids, ratios 1 to 1>
    >>> sheet.panels(math.pi / 2).shape
    (11, 11, 4, 2)
    """
    if isinstance(ratios, Sheet):
        return ratios
    sheet = getattr(ratios, "sheet", None)
    if isinstance(sheet, Sheet):
        return sheet
    if isinstance(ratios, (str, os.PathLike)):
        return Sheet(deploy(_read(Path(ratios))))
    field = RatioField(_table(ratios))
    entries = {"rim": None if rim is None else dict(rim), "start": start, "cell": cell}
    return Sheet(deploy(sheet_of_json(entries, field)))


def _table(ratios: object) -> npt.NDArray[Any]:
    try:
        return np.asarray(ratios)
    except (TypeError, ValueError):  # rows of unequal lengths
        raise RatioError("ratios.not_numbers") from None


def _read(path: Path) -> lattice_sheet.Sheet:
    if path.suffix.lower() not in PROJECTS:
        return read_sheet(path)
    candidate = load(path).candidate
    if candidate is None:
        raise ProjectError("project.no_design_chosen", path=path)
    return candidate.final_sheet


@read_only
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
        """Its name, A1 unless it was given one."""
        return self.document.name_of(self.candidate)

    @property
    def target(self) -> Target:
        assert self.document.target is not None  # chosen_candidate refuses documents without one
        return Target(self.document.target)

    @property
    def sheet(self) -> Sheet:
        """The sheet that is cut, in its own frame; the fitted one of a trimmed design."""
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
        """Exact IoU of the polygons: of the trimmed ones, and of the lattice of a design on pins."""
        return self.candidate.match

    @property
    def match(self) -> float:
        """IoU that everything shows: of the pieces on pins, which are made for it, else ``iou``."""
        if not self._is_pinned:
            return self.iou
        try:
            made = assembled(self.candidate, self.document.fabrication, self.target.outline)
        except (FabricationError, UsageError):  # which making them explains
            return self.iou
        return shown_match(self.candidate, made.as_cut)

    @property
    def _is_pinned(self) -> bool:
        return is_pinned(self.document.fabrication)

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
        """Whether panels were cut along the target."""
        return self.candidate.trim is not None

    @property
    def family(self) -> str:
        """``closed`` where the whole sheet shows the target, ``cover`` where parts are cut away."""
        return self.candidate.family.value

    @property
    def given_up(self) -> float:
        """Share of the flat sheet's area that is cut away."""
        return self.candidate.given_up

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
        """Remains of every panel, over the target: (P, 2) each, row by row; at any angle.

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

        With ``construction="backed"`` they are those of the hinge layer; its tiles are exported with it.

        Parameters
        ----------
        hinge_mm : mapping of int to float
            Widths of single connectors by their numbers.
        removed : sequence of int
            Connectors to cut through.
        **choices : settings of a sheet and its cuts
            Those of :class:`kirigami_studio.settings.fabrication.FabricationSettings` and
            :class:`kirigami_studio.fabricate.options.CutOptions`; ``material`` is one of :func:`material_names`.

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
        given = checked_choices({**choices}, keywords_of(*CUTS), "plan_cuts")
        if hinge_mm is not None:
            given["hinge_mm"] = connector_widths(hinge_mm)
        if removed is not None:
            given["removed"] = connectors(removed)
        return _plan_cuts(self, {name: value for name, value in given.items() if value is not None})

    plan_cuts.__signature__ = explicit_signature(plan_cuts, keywords_of(*CUTS), over=True)  # type: ignore[attr-defined]
    plan_cuts.__doc__ = explicit_docstring(plan_cuts, *CUTS, over=True)

    def make_pieces(self, **choices: Unpack[CutChange]) -> Pieces:
        """Make the pieces of two layers on pins, or of a print; options as :meth:`plan_cuts`.

        Raises
        ------
        FabricationError, UsageError
            No such material or choice, or pieces that cannot be made.

        Examples
        --------
        >>> import numpy as np
        >>> import kirigami_studio as ks
        >>> ratios = 10 ** (0.2 * (-1.0) ** np.add.outer(range(4), range(4)))
        >>> design = ks.decode(ratios).for_target("square")
        >>> pieces = design.make_pieces(material="plywood-co2", width_mm=200)
        >>> pieces.count, pieces.pins
        (25, 40)
        """
        document, wanted = self.document, _given(choices, "make_pieces")
        settings = with_choices(document.fabrication, wanted)
        if "construction" not in wanted and not is_pinned(settings):
            settings = replace(settings, construction=Construction.PINNED)
        request = CutRequest.of(document, settings)
        if not request.is_pinned:
            raise UsageError("api.no_pieces_on_pins", construction=wanted["construction"])
        return Pieces(self, request, pieces_of(request))

    def simulate(
        self,
        *,
        hold: Sequence[int] = (),
        move: Sequence[int] = (),
        end: float = CLOSED,
        steps: int = STEPS,
        young_gpa: float | None = None,
        **cuts: Unpack[CutKeywords],
    ) -> Simulation:
        """Close the sheet on the connectors of its cuts.

        Parameters
        ----------
        hold, move, end, steps, young_gpa : optional
            As in :meth:`Cuts.simulate`.
        **cuts : settings of a sheet and its cuts
            Those of :meth:`plan_cuts`.
        """
        return self.plan_cuts(**cuts).simulate(hold=hold, move=move, end=end, steps=steps, young_gpa=young_gpa)

    def plot(self, ax: Axes | None = None, *, phi: float | None = None) -> Axes:
        """Draw the panels, or the pieces, over the target with Matplotlib.

        Parameters
        ----------
        ax : matplotlib.axes.Axes, optional
            Those to draw on; the current ones unless given.
        phi : float, radians, optional
            The target angle unless given.

        Raises
        ------
        UsageError
            Matplotlib, which the extra ``plot`` brings, is not installed.
        """
        angle, pieces = self._angle(phi), self._small_pieces
        rings = self.panels(angle) if pieces is None else pieces.outlines(angle)
        return plot_sheet(ax, rings, self.target.outline.rings, self.name)

    def export(self, path: str | os.PathLike[str], **cuts: Unpack[CutKeywords]) -> Exported:
        """Write a cut file or a picture, by its extension; takes what :meth:`plan_cuts` takes.

        Parameters
        ----------
        path : path
            ``.dxf``, ``.svg``, ``.pdf`` or ``.lbrn2``: cut files, for designs in layers in a folder of this name;
            ``.stl``, ``.3mf`` or ``.obj``: solids, on printed pins in a folder of this name; ``.png``: the closed
            sheet; ``.gif``: its motion; ``.html``: a page to share; ``.fold``,
            ``.xml`` (MuJoCo), ``.csv``: its parts and hinges; ``.inp``: its finite elements.

        Returns
        -------
        Exported
            DXF and SVG files are read back by two independent readers.

        Raises
        ------
        ExportError, FabricationError, UsageError
            An unknown extension, a place that cannot be written, or a sheet that cannot be cut.
        """
        goal = Path(path)
        find_writer(goal)
        if cuts or goal.suffix.lower() not in PICTURES:
            given: Mapping[str, Any] = cuts
            deciding = {
                name: given[name] for name in ("construction", "material", "machine") if given.get(name) is not None
            }
            if is_pinned(with_choices(self.document.fabrication, deciding)):
                return self.make_pieces(**given)._written(Output(goal))
            return self.plan_cuts(**cuts).export(goal)
        return Exported((export(picture_job(CutRequest.of(self.document)), goal),))

    def save(self, path: str | os.PathLike[str]) -> Path:
        """Write a project (.kiri) of this design alone.

        Raises
        ------
        ExportError
            Another extension, or a place that cannot be written.
        """
        label = self.document.label
        alone = replace(
            self.document,
            candidates=(self.candidate,),
            chosen=0,
            marks=(),
            labels=() if label is None else (label,),
            **ALONE,
        )
        return save_project(alone, path)

    def __repr__(self) -> str:
        rows, columns = self.grid
        told = "" if self.feasible else ", not feasible"
        iou = f"{'lattice ' if self._is_pinned else ''}IoU {self.iou:.4f}"  # nothing is made to be named
        return f"<Design {self.name} for {self.target.name!r}: {rows} x {columns} voids, {iou}{told}>"

    def _repr_svg_(self) -> str:
        rows, columns = self.grid
        figures = [f"IoU {self.match:.3f}", f"{rows} × {columns}", f"CV {self.area_cv:.2f}"]
        details = "  ·  ".join(figures if self.feasible else [*figures, "not feasible"])
        heading = f"{self.name}  ·  {self.target.name}"
        return states_picture(self.posed, self.target.outline.rings, heading, details, self._small_pieces)

    @property
    def _small_pieces(self) -> PosedPieces | None:
        """Its pieces on pins, or its tiles on cloth, for pictures; None for panels."""
        if not has_pieces(self.document.fabrication):
            return None
        try:
            found = posed_pieces(CutRequest.of(self.document))
        except (FabricationError, UsageError):  # which making them explains
            return None
        return None if found is None else found.small


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


def _design_of_sheet(deployment: Deployment, target: TargetLike | None, phi: float, name: str) -> Design:
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


def share(design: Design, path: str | os.PathLike[str], **cuts: Unpack[CutKeywords]) -> Exported:
    """Write a design as a page to share: one .html file that moves in every browser.

    Parameters
    ----------
    design : Design
    path : path
        It ends with ``.html``.
    **cuts : settings of a sheet and its cuts
        Those of :meth:`Design.plan_cuts`; the project's unless given.

    Raises
    ------
    ExportError, FabricationError, UsageError
        Another extension, a place that cannot be written, or a sheet that cannot be cut.
    """
    goal = Path(path)
    if goal.suffix.lower() != PAGE:
        raise UsageError("api.not_a_page_name", path=goal, suffix=PAGE)
    return design.export(goal, **cuts)


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


@read_only
@dataclass(frozen=True, slots=True, eq=False, repr=False)
class Cuts:
    """All cuts of a design in mm, in a material, and what is to be expected of the sheet.

    In a notebook it shows the cuts and the verdict.

    Attributes
    ----------
    design : Design
    """

    design: Design
    _request: CutRequest
    _planned: Planned

    @property
    def settings(self) -> FabricationSettings:
        """Material, sizes, connectors, machine."""
        return self._request.settings

    @property
    def plan(self) -> CutPlan:
        """The value of the program: paths in cutting order, connectors, notes."""
        return self._planned.plan

    @property
    def report(self) -> PlanReport:
        """Findings of the check of the plan."""
        return self._planned.report

    @property
    def material(self) -> str:
        """Key of the material."""
        return self.plan.material.key

    @property
    def size_mm(self) -> tuple[float, float]:
        """Width and height of the flat sheet."""
        return self.plan.size_mm

    @property
    def cut_length_mm(self) -> float:
        return self.plan.cut_length_mm

    @property
    def seconds(self) -> float:
        """Estimated time of cutting one sheet, with its tiles if it is backed."""
        return self.plan.seconds_estimate if self._planned.layers is None else self._planned.seconds

    @property
    def tiles(self) -> int:
        """Tiles that are glued on it; 0 unless it is backed."""
        return 0 if self._planned.layers is None else len(self._planned.layers.assembly.pieces)

    @property
    def pieces(self) -> int:
        """Pieces that the sheet is in after cutting: 1 unless something is wrong."""
        return self.report.pieces

    @property
    def min_connector_mm(self) -> float:
        """Smallest finished connector."""
        return self.plan.min_connector_mm

    @property
    def verdict(self) -> Verdict:
        """Whether it is ready to cut, and why not.

        Made of the check of the plan, the simulation and the material; the sheet is closed when first asked for.
        """
        return _judged(self)

    def paths_mm(self) -> dict[str, tuple[FloatArray, ...]]:
        """Cut paths by layer, as files have them: (P, 2) each, mm, y up, in the order of cutting.

        Arcs are chords of at most 5 micrometres error; a closed path ends at its first point.  Layers are called as in
        cut files: ``SLITS``, ``EDGE_SLITS``, ``OUTLINE`` and so on.
        """
        plan = self.plan
        return {layer.value: tuple(path.travelled for path in plan.on_layer(layer)) for layer in plan.layers}

    def simulate(
        self,
        *,
        hold: Sequence[int] = (),
        move: Sequence[int] = (),
        end: float = CLOSED,
        steps: int = STEPS,
        young_gpa: float | None = None,
    ) -> Simulation:
        """Close the sheet on its connectors; done once for the same options.

        Parameters
        ----------
        hold, move : sequence of int
            Panels that pins hold, and others that pins lead along the ideal path, by number, row by row from the top
            left; nothing is gripped unless both are given, and the mean angle is driven.
        end : float, radians
            Mean angle to close to.
        steps : int
            Equilibria on the way.
        young_gpa : float, optional
            Young's modulus; the material's unless given.

        Raises
        ------
        MechanicsError
            Panels that do not hang together, or no such panels.
        UsageError
            Panels to hold without others to lead, an angle that is flat, or too few steps.
        """
        lead = Leading(
            panel_numbers("hold", hold),
            panel_numbers("move", move),
            check_phi(end),
            number("steps", steps, whole=True),
            None if young_gpa is None else number("young_gpa", young_gpa),
        )
        return _simulated(self, lead)

    def export(
        self,
        path: str | os.PathLike[str],
        *,
        record: bool = False,
        phi: float | None = None,
        as_cut: bool | None = None,
    ) -> Exported:
        """Write one file, by its extension.

        Parameters
        ----------
        path : path
            ``.dxf``, ``.svg``, ``.pdf``, ``.lbrn2``, ``.stl``, ``.3mf``, ``.obj``, ``.png``, ``.gif`` or ``.html``.
        record : bool
            Whether all settings are written as .json beside it.
        phi : float, radians, optional
            Angle that a picture shows; the target angle unless given.
        as_cut : bool, optional
            Whether pictures show the sheet on its connectors, as far as it comes; only a GIF does unless given.

        Raises
        ------
        ExportError
            An unknown extension, or a place that cannot be written.
        """
        goal = Path(path)
        cut = goal.suffix.lower() == ".gif" if as_cut is None else as_cut
        return self._written(Output(goal, record=record), self.simulate().simulated.motion if cut else None, phi)

    def export_all(self, folder: str | os.PathLike[str]) -> Exported:
        """Write every kind of file and the record of all settings to a folder, cut files verified.

        Raises
        ------
        ExportError
            As :meth:`export`.
        """
        return self._written(Output(Path(folder), "cut", record=True))

    def _written(self, output: Output, motion: CutMotion | None = None, phi: float | None = None) -> Exported:
        found = written(self._request, self._planned, output, self._as_cut, motion, picture_phi=phi)
        return Exported(found.files, found.verifications, self)

    @property
    def _as_cut(self) -> AsCut | str:
        """The sheet as cut, or why it is unknown."""
        try:
            return self.simulate().as_cut
        except KirigamiError as error:
            return str(error)

    def _judge(self, verifications: Sequence[Verification] = ()) -> Verdict:
        return judged(self._request, self._planned, self._as_cut, verifications)

    def __repr__(self) -> str:
        width, height = self.size_mm
        told = "" if self.report.ok else ", cannot be cut"
        return f"<Cuts of {self.design.name} in {self.material}: {width:.1f} x {height:.1f} mm{told}>"

    def _repr_html_(self) -> str:
        width, height = self.size_mm
        verdict = self.verdict
        metres = self.cut_length_mm / 1000.0
        heading = f"{self.plan.material.name}: {width:.1f} × {height:.1f} mm, {metres:.2f} m of cuts"
        if len(self.plan.copies) > 1:
            heading += f", {len(self.plan.copies)} copies"
        level, *lines = (html.escape(line) for line in verdict.lines)
        told = "".join(f"<li>{line}</li>" for line in lines)
        chip = f'<b style="color:{LEVELS[verdict.level]}">{level}</b>'
        below = f'<ul style="margin:2px 0 0;padding-left:20px">{told}</ul>' if told else ""
        style = "font-family:system-ui,sans-serif;font-size:13px;line-height:1.5"
        return f'<div>{cuts_picture(self.plan, heading)}<div style="{style}">{chip}{below}</div></div>'


@read_only
@dataclass(frozen=True, slots=True, eq=False, repr=False)
class Pieces:
    """Pieces of a design on pins, in two layers or printed, and what is to be expected of them.

    Attributes
    ----------
    design : Design
    """

    design: Design
    _request: CutRequest
    _made: MadePieces

    @property
    def settings(self) -> FabricationSettings:
        """Material, sizes of pins and ears, machine."""
        return self._request.settings

    @property
    def assembly(self) -> Assembly:
        """The value of the program: pieces, pins, poses at any angle."""
        return self._made.made.assembly

    @property
    def count(self) -> int:
        """Pieces of both layers."""
        return len(self.assembly.pieces)

    @property
    def pins(self) -> int:
        """Pins that join them."""
        return len(self.assembly.hinges)

    @property
    def iou(self) -> float:
        """Exact IoU of the assembled silhouette with the target."""
        return self._made.report.figures.match

    @property
    def seconds(self) -> float:
        """Estimated time of cutting all beds; 0 for what is printed, which the slicer tells."""
        return self._made.seconds

    @property
    def verdict(self) -> Verdict:
        """Whether they are ready to cut, and why not."""
        return self._made.verdict

    def export(self, folder: str | os.PathLike[str]) -> Exported:
        """Write cut files or plates, assembly sheet, parts list and motion to a folder.

        Raises
        ------
        ExportError
            A place that cannot be written, or pieces whose files cannot be right.
        """
        return self._written(Output(Path(folder), "cut"))

    def _written(self, output: Output) -> Exported:
        found = written_pieces(self._request, output)
        return Exported(found.files, found.verifications, self)

    def _judge(self, verifications: Sequence[Verification] = ()) -> Verdict:
        return judge_assembled(self._request.candidate, self._made.made, self._request.settings, verifications)

    def __repr__(self) -> str:
        level = self.verdict.words
        return f"<Pieces of {self.design.name} in {self.settings.material}: {self.count}, {self.pins} pins, {level}>"


@read_only
@dataclass(frozen=True, slots=True, eq=False, repr=False)
class Exported:
    """Files that were written.

    Attributes
    ----------
    files : tuple of Path
    verifications : tuple of Verification
        What two readers found in each DXF and SVG.
    cuts : Cuts, Pieces or None
        That the files were written of; None for pictures.
    """

    files: tuple[Path, ...]
    verifications: tuple[Verification, ...] = ()
    cuts: Cuts | Pieces | None = field(default=None)

    @property
    def path(self) -> Path:
        """The first file."""
        return self.files[0]

    @property
    def ok(self) -> bool:
        """Whether every file that was read back is as planned."""
        return all(found.ok for found in self.verifications)

    @property
    def verdict(self) -> Verdict | None:
        """On the sheet, with what was found in the files; None for pictures."""
        return None if self.cuts is None else self.cuts._judge(self.verifications)

    def __repr__(self) -> str:
        names = ", ".join(path.name for path in self.files)
        read = "" if not self.verifications else ", verified by two readers" if self.ok else ", NOT as planned"
        return f"<Exported {names}{read}>"


def _given(choices: Mapping[str, Any], function: str) -> dict[str, Any]:
    """Choices that were given, by the names of settings."""
    given = checked_choices({**choices}, keywords_of(*CUTS), function)
    return {name: one for name, one in given.items() if one is not None}


def _plan_cuts(design: Design, given: Mapping[str, Any]) -> Cuts:
    """Plan and check the cuts of a design, with choices on top of those of its project."""
    document = design.document
    request = CutRequest.of(document, with_choices(document.fabrication, given))
    check_connectors(request.candidate, request.settings.options)
    return Cuts(design, request, planned(request))


@lru_cache(maxsize=32)
def _simulated(cuts: Cuts, lead: Leading) -> Simulation:
    request, width = cuts._request, cuts.settings.width_mm
    found = simulated(request.candidate, cuts.plan, width, request.target, request.deployment, lead)
    candidate = request.candidate
    posed = PosedDesign(request.deployment, candidate.final_pose, candidate.final_phi, candidate.trim)
    return Simulation(found, posed if found.made is None else posed.laid_over(found.made), width)


@lru_cache(maxsize=32)
def _judged(cuts: Cuts) -> Verdict:
    return cuts._judge()
