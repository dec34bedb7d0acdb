"""Sheets without a target: one table of ratios, decoded exactly, at every angle."""

from __future__ import annotations

import os
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypeAlias

import numpy as np
import numpy.typing as npt
import shapely
from shapely.geometry import Polygon

from kirigami_studio.api.pictures import states_picture
from kirigami_studio.evaluate.feasibility import Feasibility, feasibility_of_many
from kirigami_studio.evaluate.porosity import Porosity
from kirigami_studio.evaluate.posed_design import PosedDesign
from kirigami_studio.evaluate.silhouette import rasterise
from kirigami_studio.evaluate.similarity import Similarity
from kirigami_studio.foundation.arrays import BoolArray, FloatArray
from kirigami_studio.foundation.errors import ProjectError, RatioError
from kirigami_studio.foundation.paper import MASK_SIZE
from kirigami_studio.lattice import sheet as lattice_sheet
from kirigami_studio.lattice.deployment import Deployment, check_phi, deploy
from kirigami_studio.lattice.ratio_field import RatioField
from kirigami_studio.lattice.sheet_files import read_sheet, sheet_json, sheet_of_json
from kirigami_studio.project.store import CUT_FILES, SUFFIX, load

if TYPE_CHECKING:
    from kirigami_studio.api.design import Design
    from kirigami_studio.api.target import TargetLike

#: Files that hold a project, whose chosen design is meant.
PROJECTS = (SUFFIX, *CUT_FILES)


@dataclass(frozen=True, slots=True, eq=False, repr=False)
class Sheet:
    """One sheet at every angle phi, from pi (flat) to 0 (closed again); lengths in unit cells, angles in radians.

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

    def nodes(self, phi: float = 0.0) -> FloatArray:
        """Positions of all nodes: (N, 2)."""
        return self.deployment.nodes(phi)

    def panels(self, phi: float = 0.0) -> FloatArray:
        """Corners of the panels, counter-clockwise: (m + 1, n + 1, 4, 2)."""
        return self.deployment.panels(phi)

    def voids(self, phi: float = 0.0) -> FloatArray:
        """Corners of the voids: (m, n, 4, 2)."""
        return self.deployment.voids(phi)

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

    def area(self, phi: float = 0.0) -> float:
        """Area of panels and voids together, unit cells squared."""
        return self.deployment.area(phi)

    def porosity(self, phi: float = 0.0) -> float:
        """Share of that area that is voids."""
        return Porosity.of(self.deployment).at(phi)

    def feasibility(self, phi: float = 0.0) -> Feasibility:
        """Whether it is ``feasible``: no quad is inverted and nothing touches or overlaps on the way from flat to phi.

        ``n_invalid``, ``overlap_ratio`` and ``contact`` say why not.
        """
        (found,) = feasibility_of_many([self.deployment], check_phi(phi))
        return found

    def for_target(self, target: TargetLike | None = None, *, phi: float = 0.0, name: str = "") -> Design:
        """This sheet as a design: scored, and laid over a target, so that it can be planned, simulated and exported.

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
        from kirigami_studio.api.design import design_of_sheet

        return design_of_sheet(self.deployment, target, phi, name)

    def to_json(self) -> dict[str, Any]:
        """A sheet file's content: ``ratio``, ``rim``, ``start`` and ``cell``; :func:`decode` reads such files."""
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
