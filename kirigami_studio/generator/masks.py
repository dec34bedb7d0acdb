"""Outline polygons -> masks in one batch: the picture of a target that a convolutional network sees.

The same pixels as ``evaluate.silhouette.rasterise``, which fills one polygon at a time in NumPy, where training needs a
whole batch on the device it runs on.  No gradient.
"""

from __future__ import annotations

import torch
from torch import Tensor

from kirigami_studio.foundation.paper import MASK_SIZE


def filled_masks(polygons: Tensor, size: int = MASK_SIZE) -> Tensor:
    """Fill each polygon into its own square mask.

    All edges cut every row of pixel centres; where the sum of their directions from the left is not 0, the pixel is
    inside (winding number, so a sheet that overlaps itself is still filled).

    Parameters
    ----------
    polygons : (B, L, 2) float tensor
        y up, any place and size, either direction.
    size : int
        Pixels each way; the longer side of the bounding box fills it, the other is centred (paper, Appendix: recentred
        by the bounding-box midpoint).

    Returns
    -------
    masks : (B, size, size) tensor of the polygons' type
        1 where the pixel's centre is inside, 0 elsewhere; row 0 on top.
    """
    with torch.no_grad():
        low, high = polygons.amin(dim=1), polygons.amax(dim=1)
        corner = 0.5 * (low + high) - 0.5 * (high - low).amax(dim=1, keepdim=True)
        pixel = (high - low).amax(dim=1) / size
        # In pixels, with pixel centres at whole numbers and the first row at the bottom.
        x, y = ((polygons - corner[:, None]) / pixel[:, None, None] - 0.5).unbind(dim=-1)
        next_x, next_y = x.roll(-1, dims=1), y.roll(-1, dims=1)
        row = torch.arange(size, dtype=y.dtype, device=y.device)
        above, next_above = y[..., None] > row, next_y[..., None] > row
        crosses = above != next_above
        rise = torch.where(crosses, (next_y - y)[..., None], torch.ones_like(y)[..., None])
        crossing = x[..., None] + (row - y[..., None]) / rise * (next_x - x)[..., None]
        # Pixels from the crossing on get +1 where the edge goes down and -1 where it goes up.
        column = crossing.ceil().clamp(0, size).long()
        direction = torch.where(crosses, above.to(y.dtype) - next_above.to(y.dtype), torch.zeros_like(crossing))
        change = torch.zeros((len(y), size, size + 1), dtype=y.dtype, device=y.device)
        change.scatter_add_(2, column.transpose(1, 2), direction.transpose(1, 2))
        winding = change[..., :-1].cumsum(dim=2)
        return (winding.round() != 0).to(y.dtype).flip(1)
