"""Sheets whose start has hollows: ratios and mouths with which no panel is turned over.

On a convex outline the barycentric system divides the sheet into panels whatever the ratios.  Around a hollow the
uniform sheet may fold: panels there are turned over, or have hardly any area.  Other ratios unfold it, and mouths that
move a little.  With A_p the areas of the panels and c_q those of the triangles at their corners (unit cells squared),
both positive counter-clockwise,

    sum_p max(0, AREA - A_p)^2 + sum_q max(0, CORNER - c_q)^2 + CALM |change of the shape|^2

is made least by a quasi-Newton method with exact derivatives.  Panels that are not turned over and a rim that does not
cross itself make a partition: all slits then lie inside.
"""

from __future__ import annotations

import math
from functools import lru_cache

import numpy as np
import shapely

from kirigami_studio.evaluate.boundary import as_plane
from kirigami_studio.evaluate.feasibility import bad_quads
from kirigami_studio.foundation.arrays import FloatArray, IntArray
from kirigami_studio.foundation.errors import SheetError
from kirigami_studio.foundation.paper import LOG_RATIO_LIMIT
from kirigami_studio.lattice.deployment import deploy
from kirigami_studio.lattice.ratio_field import RatioField
from kirigami_studio.lattice.sheet import Rim, RimPath, Sheet, anchor_points
from kirigami_studio.lattice.symmetry import symmetry_of
from kirigami_studio.lattice.topology import topology
from kirigami_studio.polish.basis import Basis
from kirigami_studio.polish.sensitivity import OutlineModel

#: An outline is convex when its hull is larger by no more than this share of it.
CONVEX = 1e-6
#: Panels and their corners are given these areas (unit cells squared), wherever that can be had.
AREA, CORNER = 0.3, 0.05
#: Weight of leaving ratios and mouths where they are, how far mouths move (unit cells), and steps at most.
CALM, REACH, STEPS = 1e-3, 0.6, 300


@lru_cache(maxsize=256)
def unfolded(folded: Sheet, *, free_rim: bool = True) -> Sheet:
    """The sheet near another one in which no panel is turned over; one with a convex start stays as it is.

    Parameters
    ----------
    folded : Sheet
        Its symmetry, if it has one, is kept.
    free_rim : bool
        Whether the mouths may move.

    Raises
    ------
    SheetError
        A panel stays turned over, or the rim crosses itself; the sentence says where.
    """
    if folded.start is None or not has_hollows(folded.start):
        return folded
    # Imported when it is needed: it takes long, and the window starts without it.
    from scipy.optimize import minimize

    grid = folded.grid
    model, symmetry = OutlineModel.of(folded, 0.0, free_rim=free_rim), symmetry_of(folded)
    basis = Basis.of(model.size, symmetry.on(*grid) if symmetry else None)
    corners = topology(*grid).panel_nodes.reshape(-1, 4)
    start = np.concatenate([folded.field.log10.ravel(), folded.rim.offsets(*grid)])[: model.size]

    def folds(variables: FloatArray) -> tuple[float, FloatArray]:
        change = basis.moved(variables)
        shape = start + change
        decoded = model.decoded(shape)
        value, force = _folds(decoded.nodes, corners)
        slope = model.node_motion(decoded).gradient(force) + 2.0 * CALM * change
        return value + CALM * float(change @ change), basis.reduced(slope)

    reach = np.concatenate([np.full(model.voids, LOG_RATIO_LIMIT), np.where(model.held_mouths, 0.0, REACH)])
    reach = reach[: model.size]
    low, high = np.full(basis.size, -np.inf), np.full(basis.size, np.inf)
    moves = basis.variable < basis.size
    room = np.sort(np.stack([-reach - start, reach - start]) * basis.sign, axis=0)[:, moves]
    np.maximum.at(low, basis.variable[moves], np.minimum(room[0], 0.0))
    np.minimum.at(high, basis.variable[moves], np.maximum(room[1], 0.0))
    found = minimize(
        folds,
        np.zeros(basis.size),
        jac=True,
        method="L-BFGS-B",
        bounds=list(zip(low.tolist(), high.tolist(), strict=True)),
        options={"maxiter": STEPS},
    )
    shape = np.round(start + basis.moved(found.x), 9)
    field = RatioField.from_log10(shape[: model.voids].reshape(grid))
    rim = Rim.moved(*grid, shape[model.voids :]) if free_rim else folded.rim
    sheet = Sheet(field, rim, folded.start, folded.cell)
    _check(sheet)
    return sheet


def has_hollows(outline: FloatArray) -> bool:
    """Whether an outline (P, 2) is not convex."""
    polygon = shapely.Polygon(outline)
    return bool(polygon.convex_hull.area > (1.0 + CONVEX) * polygon.area)


def _folds(nodes: FloatArray, corners: IntArray) -> tuple[float, FloatArray]:
    """The first two sums for compact ``nodes`` (N, 2), and their derivative (N, 2)."""
    here = nodes[corners]
    before, after = np.roll(here, 1, axis=1), np.roll(here, -1, axis=1)
    force = np.zeros_like(nodes)
    lack = np.maximum(0.0, AREA - _turned(here, after).sum(axis=1))
    grown = 0.5 * np.stack([after[..., 1] - before[..., 1], before[..., 0] - after[..., 0]], axis=-1)
    np.add.at(force, corners, -2.0 * lack[:, None, None] * grown)
    into, out = here - before, after - here
    short = np.maximum(0.0, CORNER - _turned(into, out))
    pull = -short[..., None]
    by_before, by_after = np.stack([-out[..., 1], out[..., 0]], axis=-1), np.stack([-into[..., 1], into[..., 0]], -1)
    np.add.at(force, np.roll(corners, 1, axis=1), pull * by_before)
    np.add.at(force, corners, -pull * (by_before + by_after))
    np.add.at(force, np.roll(corners, -1, axis=1), pull * by_after)
    return float(np.square(lack).sum() + np.square(short).sum()), force


def _turned(first: FloatArray, second: FloatArray) -> FloatArray:
    """Half the cross products of vectors (..., 2)."""
    return np.asarray(0.5 * (first[..., 0] * second[..., 1] - first[..., 1] * second[..., 0]))


def _check(sheet: Sheet) -> None:
    """Refuse a sheet that is still folded while it is flat, with the place of the start's deepest hollow."""
    panels = deploy(sheet).panels(math.pi).reshape(-1, 4, 2)
    if not bad_quads(as_plane(panels)).any() and shapely.is_valid(shapely.Polygon(anchor_points(sheet))):
        return
    rows, columns = sheet.grid
    outline = RimPath(rows, columns, sheet.start, sheet.cell).outline()
    hull = shapely.boundary(shapely.Polygon(outline).convex_hull)
    low, high = outline.min(axis=0), outline.max(axis=0)
    across, up = 100.0 * (outline[np.argmax(shapely.distance(hull, shapely.points(outline)))] - low) / (high - low)
    raise SheetError("start.folds", rows=rows, columns=columns, across=across, up=up)
