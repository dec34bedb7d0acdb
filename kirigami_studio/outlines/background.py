"""A picture -> distance of each pixel from the colour of the border, light evened out.

The *ground* is the colour that most of the border has, or that of the corners where a shape reaches the border; it may
change slowly over the picture, as light does.  *Distance* is that of colours in CIELAB, of pictures in grey that of
grey levels in per cent, and of transparent pictures opacity in per cent.  A *silhouette* is the largest connected
region above a distance, its holes filled.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
import shapely
from scipy import ndimage
from shapely.geometry import MultiPoint, Polygon
from skimage import color, filters

from kirigami_studio.foundation.arrays import BoolArray, FloatArray, IntArray

#: scikit-image carries no types; the annotations state what is used of it.
rgb2lab: Callable[..., Any] = color.rgb2lab
threshold_otsu: Callable[[FloatArray], float] = filters.threshold_otsu

#: Longer side at which the background is modelled and the level is looked for, pixels.
JUDGED_SIDE = 768
#: Width of the border, share of the shorter side.
BORDER = 0.01
#: Colours (distance) that are one: of the border and the ground, at the least; and of the corners.
SAME_GROUND, SAME_CORNERS = 8.0, 12.0
#: Share of the border, and corners, that a slowly changing ground must explain.
EXPLAINED, CORNERS = 0.5, 3
#: Times as much as over the border that light may change over the picture.
EXTRAPOLATED = 2.5
#: Share of the border that has one colour where the corners differ.
MOST_OF_BORDER = 0.6
#: Change of the ground over the picture, distance, from which light is evened out.
UNEVEN = 3.0
#: The least distance that tells a shape from the ground; as many times the grain of the ground.
LEAST_DISTANCE, GRAIN = 2.5, 4.5
#: Pixels of the ground inside the border that its light is fitted to, at least and at most; order by number of terms.
LEAST_SEEN, MOST_SEEN, ORDER_OF = 200, 20_000, {6: 2, 15: 4}
#: Levels that are tried, and the share of the silhouette's edge that must be sharp: shadows fade.
LEVELS, SHARP, LEAST_SHARP = 12, 0.85, 0.5
#: An edge is sharp where this share of the change within six pixels is one within two.
STEP = 0.5
#: A silhouette that reaches the border more than at the middle level, and is thinner than this share of what it
#: surrounds, is squared paper.
SOLID = 0.5
#: Pixels (of the picture that is judged) by which a silhouette may shrink when its edge is sought midway.
SHRINKS = 3.0
#: Pixels around a silhouette that are blur; share of its level from which on something is a paler part or a shadow
#: (less is what JPEG adds), and of its area.
HALO, PALEST, FADES = 3, 0.12, 0.01
#: A page: share of the picture, share of a rectangle around it, lightness above its ground, and colourfulness.
PAGE_SHARE, PAGE_FILLS, PAGE_LIGHTER, PAGE_CHROMA = 0.3, 0.97, 20.0, 12.0
#: Share of a page that a shape on it has at least.
LEAST_ON_PAGE = 0.005


@dataclass(frozen=True, slots=True, eq=False)
class Separated:
    """A picture divided into background and shape."""

    distance: FloatArray  #: (H, W), 0 on the ground
    level: float  #: distance that divides best
    is_plain: bool  #: whether the silhouette is meant without doubt: sharp edges, no page around it
    ground: float | None = None  #: 0..1; grey level of a ground in even light, None otherwise
    is_on_page: bool = False  #: the shape lies on a page, which was left out


def separated(colours: FloatArray) -> Separated | None:
    """Divide a picture by the colour of its border.

    Parameters
    ----------
    colours : (H, W, 3) or (H, W, 1) float32, 0..1
        sRGB, or grey levels.

    Returns
    -------
    Separated or None
        None where nothing differs from the ground, or the border has no colour of its own.
    """
    small = _reduced(colours)
    height, width = small.shape[:2]
    rim = max(round(BORDER * min(height, width)), 1)
    everywhere = np.ones((height, width), dtype=bool)
    border = everywhere.copy()
    border[rim:-rim, rim:-rim] = False
    found = _separated(colours, small, border, everywhere)
    if found is None:
        return None
    whole, judged = found
    page = _page(judged, whole.level, small)
    if page is None:
        return whole
    inside = ndimage.binary_erosion(page, iterations=2 * rim)
    ring = inside & ~ndimage.binary_erosion(inside, iterations=2 * rim)
    found = _separated(colours, small, ring, inside)
    if found is None:
        return whole
    on_page, judged = found
    drawn = silhouette(judged, on_page.level)
    if not on_page.is_plain or np.any(drawn & ring) or np.sum(drawn) < LEAST_ON_PAGE * np.sum(page):
        return replace(whole, is_plain=False)
    return replace(on_page, is_plain=False, is_on_page=True)


def opacity_level(opacity: FloatArray) -> Separated:
    """Divide a transparent picture; its shape is opaque, and what fades around it is a shadow.

    Parameters
    ----------
    opacity : (H, W) float, 0..1
    """
    distance = 100.0 * opacity
    level, plain = level_of(_reduced(distance[..., None])[..., 0], LEAST_DISTANCE)
    return Separated(distance, level, plain, 0.0)


def silhouette(distance: FloatArray, level: float) -> BoolArray:
    """The largest connected region above a level, its holes filled."""
    labels, count = ndimage.label(distance > level)
    if not count:
        return np.zeros(distance.shape, dtype=bool)
    main = int(np.argmax(np.bincount(labels.ravel())[1:])) + 1
    filled: BoolArray = ndimage.binary_fill_holes(labels == main)
    return filled


def level_of(distance: FloatArray, least: float) -> tuple[float, bool]:
    """Find the level of the largest silhouette with sharp edges, then the middle of these edges.

    Parameters
    ----------
    distance : (H, W) float
        With ``JUDGED_SIDE`` pixels along the longer side at most.
    least : float
        Level above which a pixel is not of the ground.

    Returns
    -------
    level : float
    is_plain : bool
        Whether its edges are sharp; otherwise it is Otsu's.
    """
    smooth = ndimage.gaussian_filter(distance, 0.7)
    middle = middle_of(distance)
    highest, lowest = ndimage.maximum_filter(smooth, 5), ndimage.minimum_filter(smooth, 5)
    is_sharp = highest - lowest >= STEP * (ndimage.maximum_filter(smooth, 13) - ndimage.minimum_filter(smooth, 13))
    usual = silhouette(smooth, middle)
    usual_touch = _touching(usual)
    most = float(np.quantile(smooth, 0.999))
    if most <= least:
        return middle, False
    best: tuple[float, float] | None = None
    for level in np.geomspace(least, max(0.95 * most, least * 1.01), LEVELS).tolist():
        whole = silhouette(smooth, level)
        area = float(np.sum(whole))
        edge = whole & ~ndimage.binary_erosion(whole, border_value=1)
        if area < 16 or not edge.any():
            continue
        more = whole & ~usual
        if _touching(whole) > usual_touch + 0.02 and np.sum(more & (smooth > level)) < SOLID * np.sum(more):
            continue
        sharp = float(np.mean(is_sharp[edge]))
        if best is None or sharp > best[1] + 0.05:
            best = level, sharp
        if sharp >= SHARP:
            break
    if best is None or best[1] < LEAST_SHARP:
        return middle, False
    level = _midway(smooth, best[0], highest)
    return level, best[1] >= SHARP and not _fades(smooth, level, least)


def _fades(smooth: FloatArray, level: float, least: float) -> bool:
    """Whether a shadow or a paler part of the shape hangs together with a level's silhouette."""
    whole = silhouette(smooth, level)
    beside = silhouette(smooth, max(least, PALEST * level)) & ~ndimage.binary_dilation(whole, iterations=HALO)
    return float(np.sum(beside)) > FADES * float(np.sum(whole))


def _midway(smooth: FloatArray, level: float, highest: FloatArray) -> float:
    """Middle level of the edges of a silhouette, as far as it hardly shrinks."""
    whole = silhouette(smooth, level)
    edge = whole & ~ndimage.binary_erosion(whole, border_value=1)
    wide = ndimage.maximum_filter(smooth, 13)[edge]
    near, below = highest[edge], float(np.quantile(ndimage.minimum_filter(smooth, 9)[edge], 0.9))
    least = float(np.sum(whole)) - SHRINKS * float(np.sum(edge))
    for above in (np.median(wide), np.quantile(wide, 0.1), np.median(near), np.quantile(near, 0.1)):
        middle = 0.5 * (float(above) + below)
        if middle > level and float(np.sum(silhouette(smooth, middle))) >= least:
            return middle
    return level


def middle_of(values: FloatArray) -> float:
    """Otsu's level, moved midway between the means of both classes."""
    otsu = float(threshold_otsu(values))
    above = values > otsu
    # On clean two-level pictures Otsu sits on one of the levels; midway, sub-pixel contours are unbiased.
    return (float(np.mean(values[above])) + float(np.mean(values[~above]))) / 2.0


def _touching(whole: BoolArray) -> float:
    """Share of the outermost pixels that belong to a region."""
    return float(np.mean(np.concatenate([whole[0], whole[-1], whole[1:-1, 0], whole[1:-1, -1]])))


def _separated(
    colours: FloatArray, small: FloatArray, border: BoolArray, within: BoolArray
) -> tuple[Separated, FloatArray] | None:
    """Divide the part ``within`` of a picture by the colour of its ``border``."""
    if (ground_found := _ground(small, border)) is None:
        return None
    model, known = ground_found
    uneven = float(np.max(np.ptp(colours_in_lab(_evaluated(model, small.shape[:2])), axis=(0, 1)))) > UNEVEN
    judged = np.where(within, _distance(small, model, uneven), 0.0)
    if uneven and (better := _evened(small, judged, within)) is not None:
        model = better
        judged = np.where(within, _distance(small, model, uneven), 0.0)
    least = max(LEAST_DISTANCE, GRAIN * float(np.median(judged[known])))
    if float(np.quantile(judged, 0.9995)) < least:
        return None
    level, plain = level_of(judged, least)
    ground = float(_mean(model)[0]) if colours.shape[2] == 1 and not uneven else None
    if colours.shape == small.shape:
        return Separated(judged, level, plain, ground), judged
    full = _distance(colours, model, uneven)
    if not within.all():
        step = -(-full.shape[0] // within.shape[0])
        rows, columns = (
            np.minimum(np.arange(size) // step, most - 1) for size, most in zip(full.shape, within.shape, strict=True)
        )
        full = np.where(within[np.ix_(rows, columns)], full, 0.0)
    return Separated(full, level, plain, ground), judged


def _ground(small: FloatArray, border: BoolArray) -> tuple[FloatArray, BoolArray] | None:
    """Quadratic model (6, C) of the ground, and the pixels of the border that have its colour.

    None where the border has no colour of its own.
    """
    rows, columns = np.nonzero(border)
    terms, seen = _terms(rows, columns, small.shape[:2]), small[rows, columns]
    lab = colours_in_lab(seen[None])[0]
    near = max(0.04 * min(small.shape[:2]), 1.5)
    corners = np.array(
        [
            np.median(lab[np.hypot(rows - row, columns - column) <= near], axis=0)
            for row, column in _corners(rows, columns)
        ]
    )
    centre = _colour_of_corners(corners, lab)
    alike = np.linalg.norm(lab - centre, axis=1) < SAME_CORNERS
    has_one = np.sum(np.linalg.norm(corners - centre, axis=1) < SAME_CORNERS) >= CORNERS
    is_most = bool(np.mean(alike) >= MOST_OF_BORDER) or (bool(has_one) and bool(np.mean(alike) >= EXPLAINED))
    # Begun with one colour, the light is not bent towards a shape that the border cuts.
    model, good = _fitted(terms, seen, alike if is_most else None)
    there = colours_in_lab(
        np.clip(
            _terms(_corners(rows, columns)[:, 0], _corners(rows, columns)[:, 1], small.shape[:2]) @ model, 0.0, 1.0
        )[None]
    )[0]
    fits = np.sum(np.linalg.norm(corners - there, axis=1) <= 2.0 * SAME_GROUND)
    if np.mean(good) < EXPLAINED or fits < CORNERS or _leaves(model, seen[good]):
        good = alike
        if np.mean(good) < MOST_OF_BORDER and not has_one:
            return None
        model = np.zeros((6, seen.shape[1]))
        model[0] = np.median(seen[good], axis=0)
    known = np.zeros(border.shape, dtype=bool)
    known[rows[good], columns[good]] = True
    return model, known


def _fitted(terms: FloatArray, seen: FloatArray, begun: BoolArray | None = None) -> tuple[FloatArray, BoolArray]:
    """Fit colours (N, C) by terms (N, K), and which of them follow: others are another thing.

    Parameters
    ----------
    begun : (N,) bool, optional
        Those that the first fit is of; by default all.
    """
    good = np.ones(len(seen), dtype=bool) if begun is None else begun
    for _ in range(8):
        model = np.linalg.lstsq(terms[good], seen[good], rcond=None)[0]
        off = 100.0 * np.linalg.norm(seen - terms @ model, axis=1)
        good = off <= np.clip(2.5 * float(np.median(off)), SAME_GROUND, SAME_CORNERS)
        if not good.any():
            good = off <= np.median(off)
    follows: BoolArray = off <= SAME_CORNERS
    return np.asarray(model, dtype=np.float64), follows


def _leaves(model: FloatArray, seen: FloatArray) -> bool:
    """Whether a model changes far more than the colours (N, C) it was made of."""
    low, high = np.quantile(seen, (0.1, 0.9), axis=0)
    change = np.ptp(_evaluated(model, (9, 9)), axis=(0, 1))
    return bool(np.any(change > EXTRAPOLATED * (high - low) + 0.01 * SAME_GROUND))


def _evened(small: FloatArray, judged: FloatArray, within: BoolArray) -> FloatArray | None:
    """Model (15, C) of the fourth order of all beside the silhouette."""
    shape = ndimage.binary_dilation(silhouette(judged, middle_of(judged)), iterations=4)
    rows, columns = np.nonzero(within & ~shape)
    if len(rows) < LEAST_SEEN:
        return None
    few = slice(None, None, max(len(rows) // MOST_SEEN, 1))
    seen = small[rows[few], columns[few]]
    model, good = _fitted(_terms(rows[few], columns[few], small.shape[:2], 4), seen)
    return model if np.mean(good) > EXPLAINED and not _leaves(model, seen[good]) else None


def _corners(rows: IntArray, columns: IntArray) -> IntArray:
    """Rows and columns (4, 2) of the outermost places in the four diagonal directions."""
    ends = [int(np.argmax(down * rows + right * columns)) for down in (-1, 1) for right in (-1, 1)]
    return np.column_stack([rows[ends], columns[ends]])


def _colour_of_corners(corners: FloatArray, lab: FloatArray) -> FloatArray:
    """The colour of three corners at least, or else the most frequent one of the border."""
    for corner in corners:
        alike = np.linalg.norm(corners - corner, axis=1) < SAME_CORNERS
        if np.sum(alike) >= CORNERS:
            return np.asarray(np.median(corners[alike], axis=0))
    cells, of = np.unique(np.round(lab / SAME_CORNERS), axis=0, return_inverse=True)
    return np.asarray(np.median(lab[of.ravel() == np.argmax(np.bincount(of.ravel(), minlength=len(cells)))], axis=0))


def _terms(rows: IntArray, columns: IntArray, shape: tuple[int, ...], order: int = 2) -> FloatArray:
    """Monomials (..., K) of places up to an order, -1..1 over the picture."""
    y, x = 2.0 * (rows + 0.5) / shape[0] - 1.0, 2.0 * (columns + 0.5) / shape[1] - 1.0
    powers = [(degree - down, down) for degree in range(order + 1) for down in range(degree + 1)]
    return np.stack([x**across * y**down for across, down in powers], axis=-1)


def _evaluated(model: FloatArray, shape: tuple[int, ...]) -> FloatArray:
    """Colour (H, W, C) of the ground at every pixel."""
    rows, columns = np.mgrid[: shape[0], : shape[1]]
    return np.asarray(np.clip(_terms(rows, columns, shape, ORDER_OF[len(model)]) @ model, 0.02, 1.0))


def _mean(model: FloatArray) -> FloatArray:
    """Mean colour (C,) of the ground."""
    return np.asarray(np.clip(model[0] + (model[3] + model[5]) / 3.0, 0.0, 1.0))


def _distance(colours: FloatArray, model: FloatArray, uneven: bool) -> FloatArray:
    """Distance (H, W) of each pixel from the ground; light that falls unevenly is divided out first."""
    if not uneven:
        return _norm(colours_in_lab(colours) - colours_in_lab(_mean(model)[None, None]))
    ground = _evaluated(model, colours.shape[:2])
    lightest = ground.max(axis=(0, 1))
    evened = np.clip(colours * (lightest / ground), 0.0, 1.0).astype(colours.dtype)
    return _norm(colours_in_lab(evened) - colours_in_lab(lightest[None, None]))


def _norm(differences: FloatArray) -> FloatArray:
    return np.asarray(np.sqrt(np.sum(differences * differences, axis=-1)), dtype=np.float64)


def colours_in_lab(colours: FloatArray) -> FloatArray:
    """Colours (H, W, 3), 0..1, in CIELAB; grey levels (H, W, 1) in per cent."""
    return 100.0 * colours if colours.shape[-1] == 1 else np.asarray(rgb2lab(colours))


def _reduced(colours: FloatArray) -> FloatArray:
    """Means over squares of pixels, ``JUDGED_SIDE`` along the longer side."""
    step = -(-max(colours.shape[:2]) // JUDGED_SIDE)
    if step == 1:
        return colours
    height, width = (max(size // step, 1) for size in colours.shape[:2])
    blocks = colours[: height * step, : width * step]
    blocks = blocks[: blocks.shape[0] // height * height, : blocks.shape[1] // width * width]
    squares = blocks.reshape(height, -1, width, blocks.shape[1] // width, colours.shape[2])
    return np.asarray(squares.mean(axis=(1, 3)))


def _page(distance: FloatArray, level: float, small: FloatArray) -> BoolArray | None:
    """The page in a picture: light, colourless, with four corners, on darker ground."""
    whole = silhouette(distance, level)
    if np.mean(whole) < PAGE_SHARE or _touching(whole) > 0.5:
        return None
    rows, columns = np.nonzero(whole & ~ndimage.binary_erosion(whole))
    hull = MultiPoint(np.column_stack([columns, rows])[:: max(len(rows) // 4000, 1)]).convex_hull
    if not isinstance(hull, Polygon) or float(np.sum(whole)) < PAGE_FILLS * hull.area:
        return None
    corners = shapely.simplify(hull, 0.04 * hull.length).exterior.coords
    if len(corners) > 5 or hull.area < PAGE_FILLS * shapely.minimum_rotated_rectangle(hull).area * 0.85:
        return None
    lab = colours_in_lab(small)
    if lab.shape[2] == 1:
        lab = np.concatenate([lab, np.zeros((*lab.shape[:2], 2))], axis=2)
    rim = whole & ~ndimage.binary_erosion(whole, iterations=8)
    inside, outside = np.median(lab[rim], axis=0), np.median(lab[~whole], axis=0)
    is_page = inside[0] > outside[0] + PAGE_LIGHTER and float(np.hypot(inside[1], inside[2])) < PAGE_CHROMA
    return whole if is_page else None
