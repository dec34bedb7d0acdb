"""The grid and angle at which fields show a target, and the matrices between it and a network's own grid.

A network draws on its own grid at phi = 0; a sheet may have any grid and angle.  Fields go from one to the other by
the lattice's parity-wise interpolation, which is linear, and outlines are read at as many stations, side by side, as
the network's own has vertices.  On the network's own grid at phi = 0 both are the identity.

A *design* of the sheet is the fields' entries of z, followed by how far the mouths are from their even places where the
rim is free.  The flow draws z alone; corrections move the mouths.

Within a symmetry of the sheet's grid the flow goes on on that grid, as the network's own may not have the symmetry:
the network sees its state carried over, and its velocity is carried back and made symmetric.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import lru_cache

import numpy as np
import torch
from torch import Tensor
from torch.nn.functional import pad

from kirigami_studio.foundation.arrays import FloatArray
from kirigami_studio.foundation.paper import LOG_RATIO_LIMIT
from kirigami_studio.lattice.deployment import ZIPPED_BELOW
from kirigami_studio.lattice.ratio_field import frozen
from kirigami_studio.lattice.resize import resize_fields
from kirigami_studio.lattice.sheet import RIM_REACH, rim_table
from kirigami_studio.lattice.symmetry import GridSymmetry, Symmetry


@dataclass(frozen=True, slots=True)
class DeployedGrid:
    """The grid of a sheet and the angle at which it shows the target."""

    rows: int
    columns: int
    phi: float = 0.0  #: radians, in [0, pi)
    symmetry: Symmetry | None = None  #: what all fields keep
    free_rim: bool = False  #: corrections move the mouths of the rim as well

    @property
    def cells(self) -> int:
        """Number of voids."""
        return self.rows * self.columns

    @property
    def mouths(self) -> int:
        """Number of mouths that are free."""
        return int(rim_table(self.rows, self.columns).mouths.size) if self.free_rim else 0

    @property
    def zipped(self) -> bool:
        """Whether the edge hinges have zipped shut."""
        return self.phi < ZIPPED_BELOW

    @property
    def side_vertices(self) -> tuple[int, int, int, int]:
        """Outline vertices from one sheet corner to the next: left, bottom, right, top."""
        m, n = (self.rows + 1, self.columns + 1) if self.zipped else (2 * self.rows + 1, 2 * self.columns + 1)
        return m, n, m, n


class GridTransfer:
    """Constant matrices between a network's own grid and that of a sheet.

    Parameters
    ----------
    own : (rows, columns)
        The network's grid.
    deployed : DeployedGrid
        Of the sheet.
    """

    def __init__(self, own: tuple[int, int], deployed: DeployedGrid, device: torch.device) -> None:
        grid = deployed.rows, deployed.columns
        self.cells, self.mouths = deployed.cells, deployed.mouths
        self.same_grid = own == grid
        self.same_outline = self.same_grid and deployed.zipped
        self._up = self._down = self._stations = torch.empty(0, device=device)
        if not self.same_grid:
            self._up, self._down = (
                torch.tensor(table, dtype=torch.float32, device=device)
                for table in (_resizing(own, grid), _resizing(grid, own))
            )
        if not self.same_outline:
            table = _reading(DeployedGrid(*own).side_vertices, deployed.side_vertices)
            self._stations = torch.tensor(table, dtype=torch.float32, device=device)

    def up(self, z: Tensor) -> Tensor:
        """Fields (B, own cells) on the sheet: (B, m * n)."""
        return z if self.same_grid else z @ self._up

    def down(self, z: Tensor) -> Tensor:
        """Fields of the sheet (B, m * n) on the network's grid: (B, own cells)."""
        return z if self.same_grid else z @ self._down

    def state(self, z: Tensor) -> Tensor:
        """Where a flow from fields (B, own cells) starts: its states are fields of the network's own grid."""
        return z

    def state_of(self, field: Tensor) -> Tensor:
        """The state of the flow at which fields of the sheet (B, m * n) are reached."""
        return self.down(field)

    def seen(self, state: Tensor) -> Tensor:
        """A state of the flow as the network sees it: (B, own cells)."""
        return state

    def on_grid(self, state: Tensor) -> Tensor:
        """Designs (B, m * n + R) of a state of the flow, their mouths evenly spaced."""
        return self.evenly(self.up(state))

    def evenly(self, z: Tensor) -> Tensor:
        """Fields (B, m * n) as designs whose mouths are evenly spaced: (B, m * n + R)."""
        return pad(z, (0, self.mouths)) if self.mouths else z

    def bounded(self, design: Tensor) -> Tensor:
        """The nearest designs (B, m * n + R) within the limits of ratios and mouths."""
        z = design[:, : self.cells].clamp(-LOG_RATIO_LIMIT, LOG_RATIO_LIMIT)
        return torch.cat([z, design[:, self.cells :].clamp(-RIM_REACH, RIM_REACH)], dim=1) if self.mouths else z

    def state_change(self, velocity: Tensor) -> Tensor:
        """What a velocity (B, own cells) does to the state."""
        return velocity

    def symmetric(self, design: Tensor) -> Tensor:
        """Nearest designs (B, m * n + R), or fields alone, that keep the sheet's symmetry."""
        return design

    def stations(self, outline: Tensor) -> Tensor:
        """The sheet's outline (B, L, 2) read at as many places as the network's own has vertices: (B, L_own, 2)."""
        return outline if self.same_outline else self._stations @ outline


class SymmetricTransfer(GridTransfer):
    """The same within a symmetry: states of the flow are symmetric fields of the sheet's grid."""

    def __init__(
        self, own: tuple[int, int], deployed: DeployedGrid, symmetry: GridSymmetry, device: torch.device
    ) -> None:
        super().__init__(own, deployed, device)
        cells = np.eye(self.cells).reshape(-1, deployed.rows, deployed.columns)
        projection = np.eye(self.cells + self.mouths)
        projection[: self.cells, : self.cells] = symmetry.symmetric(cells).reshape(self.cells, -1)
        if self.mouths:
            projection[self.cells :, self.cells :] = symmetry.symmetric_offsets(np.eye(self.mouths))
        self._projection = torch.tensor(projection, dtype=torch.float32, device=device)

    def state(self, z: Tensor) -> Tensor:
        return self.symmetric(self.up(z))

    def state_of(self, field: Tensor) -> Tensor:
        return field

    def seen(self, state: Tensor) -> Tensor:
        return self.down(state)

    def on_grid(self, state: Tensor) -> Tensor:
        return self.evenly(state)

    def state_change(self, velocity: Tensor) -> Tensor:
        return self.symmetric(self.up(velocity))

    def symmetric(self, design: Tensor) -> Tensor:
        size = design.shape[1]
        return design @ self._projection[:size, :size]


def grid_transfer(own: tuple[int, int], deployed: DeployedGrid, device: torch.device) -> GridTransfer:
    """The transfer to another grid; it depends on the angle only by whether the edge hinges have zipped.

    Raises
    ------
    UsageError
        The grid does not have the symmetry that its fields are to keep.
    """
    return _transfer(own, replace(deployed, phi=0.0 if deployed.zipped else 1.0), device)


@lru_cache(maxsize=256)
def _transfer(own: tuple[int, int], deployed: DeployedGrid, device: torch.device) -> GridTransfer:
    # Kept for later: a table made while sampling, without gradients, must serve training too.
    with torch.inference_mode(False):
        if deployed.symmetry is None:
            return GridTransfer(own, deployed, device)
        return SymmetricTransfer(own, deployed, deployed.symmetry.on(deployed.rows, deployed.columns), device)


@lru_cache(maxsize=256)
def _resizing(old: tuple[int, int], new: tuple[int, int]) -> FloatArray:
    """Matrix (old cells, new cells) of the parity-wise interpolation, read-only."""
    cells = old[0] * old[1]
    return frozen(resize_fields(np.eye(cells).reshape(cells, *old), *new).reshape(cells, -1))


def _reading(own: tuple[int, ...], sides: tuple[int, ...]) -> FloatArray:
    """Matrix (own vertices, vertices) that reads an outline at equal steps along each side."""
    count = sum(sides)
    table = np.zeros((sum(own), count))
    row = first = 0
    for stations, vertices in zip(own, sides, strict=True):
        place = first + np.arange(stations) * vertices / stations
        at = place.astype(np.intp)
        rows = row + np.arange(stations)
        table[rows, at] = 1.0 - (place - at)
        table[rows, (at + 1) % count] += place - at
        row, first = row + stations, first + vertices
    return table
