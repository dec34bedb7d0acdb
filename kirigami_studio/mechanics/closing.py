"""Opening of a cut sheet from flat towards phi = 0: force, energy, stretch, strain, jams."""

from __future__ import annotations

import math
from collections.abc import Generator
from dataclasses import dataclass
from typing import Literal

import numpy as np
import shapely

from kirigami_studio.foundation.arrays import FloatArray, IntArray
from kirigami_studio.foundation.steps import result_of
from kirigami_studio.lattice.deployment import Deployment, check_phi
from kirigami_studio.mechanics.drive import Drive, mean_turn
from kirigami_studio.mechanics.energy import NetworkEnergy
from kirigami_studio.mechanics.equilibrium import EquilibriumPath, follow_steps
from kirigami_studio.mechanics.network import PanelNetwork
from kirigami_studio.mechanics.sheet_network import SheetNetwork

#: A sheet that comes to this angle counts as closed; contacts keep it from phi = 0 itself.
CLOSED = math.radians(2.0)
#: Steps of a closing unless given.
STEPS = 31
#: The last part of a closing (radians), which takes smaller steps.
NARROWING = math.radians(12.0)
#: A panel that has lost more than this share of its area was trimmed.
TRIMMED = 1e-6
#: Gaps narrower than twice this share of a panel are closed in the silhouette of a sheet that has lost panels.
BRIDGED = 0.03
#: Cracks are closed by at least this share of a panel, unless they are narrower than this share of the grid on which
#: the parts are united.
CRACK, ROUNDED = 1e-4, 1e-3
#: Stretch (in connector widths) that a connector is taken to bear: what a neck of ductile film yields by.
TOLERATED_STRETCH = 0.45


@dataclass(frozen=True, slots=True, eq=False)
class Closing:
    """A sheet on its way from flat towards phi = 0."""

    sheet: SheetNetwork
    path: EquilibriumPath
    phi: FloatArray  #: (S,), radians; mean angle of the sheet: pi less the mean turn of its connectors
    #: (S, H); how far the two panels at every connector were pulled apart or pushed off each other.
    stretch_mm: FloatArray
    #: in_plane, out_of_plane: (S, H); upper and lower figure of the strain in every connector, see
    #: :meth:`SheetNetwork.strains`.
    in_plane: FloatArray
    out_of_plane: FloatArray
    asked: int  #: number of steps that were asked for; more than S where the sheet got stuck

    @property
    def stretch(self) -> FloatArray:
        """Stretch in widths of the connectors: (S, H)."""
        widths: FloatArray = self.stretch_mm / self.sheet.connectors.width_mm
        return widths

    @property
    def stable_phi(self) -> FloatArray:
        """Angles (radians) at which the sheet rests if it is let go."""
        at = self.path.drive.displacement
        order = np.argsort(at, kind="stable")
        found: FloatArray = np.interp(self.path.stable, at[order], self.phi[order])
        return found

    def jam_phi(self, tolerated: float = TOLERATED_STRETCH) -> float:
        """Angle (radians) at which a connector is stretched by more than it tolerates (in widths); 0 if none is.

        A sheet that comes to rest against its contacts before it has closed jams there.
        """
        return jam_angle(self.phi, self.stretch.max(axis=1), tolerated, len(self.phi) == self.asked)

    def motion_at(self, phi: float) -> FloatArray:
        """Motion (P, 3) at a mean angle (radians), between the two steps beside it."""
        phis = np.minimum.accumulate(self.phi)
        after = int(np.clip(np.searchsorted(-phis, -phi), 1, len(phis) - 1)) if len(phis) > 1 else 0
        before = max(after - 1, 0)
        run = self.phi[before] - self.phi[after]
        share = float(np.clip((self.phi[before] - phi) / run, 0.0, 1.0)) if run > 0.0 else 1.0
        found: FloatArray = (1.0 - share) * self.path.motion[before] + share * self.path.motion[after]
        return found


def jam_angle(phi: FloatArray, stretch: FloatArray, tolerated: float, reached_end: bool) -> float:
    """Where a growing stretch passes what is tolerated, from 0 to pi.

    Parameters
    ----------
    phi : (S,) float, radians
        Falling.
    stretch : (S,) float
        In connector widths.
    reached_end : bool
        Whether the sheet came as far as it was driven.

    Returns
    -------
    phi : float, radians
        0 for a sheet that closes, pi for one that jams at once.
    """
    phi = np.clip(phi, 0.0, math.pi)  # mean turns of a sheet at rest are 0 but for rounding
    over = np.flatnonzero(stretch > tolerated)
    if not over.size:
        closed = reached_end and phi[-1] <= CLOSED + 1e-9
        return 0.0 if closed else float(phi[-1])
    last = int(over[0])
    if last == 0:
        return float(phi[0])
    share = (tolerated - stretch[last - 1]) / (stretch[last] - stretch[last - 1])
    return float(phi[last - 1] + share * (phi[last] - phi[last - 1]))


def closing(sheet: SheetNetwork, drive: Drive | None = None) -> Closing:
    """Close a sheet along a drive, as far as it goes, all in one go; see :func:`closing_steps`."""
    return result_of(closing_steps(sheet, drive))


def closing_steps(sheet: SheetNetwork, drive: Drive | None = None) -> Generator[None, None, Closing]:
    """Close a sheet along a drive, as far as it goes; yields after each step, and returns the closing.

    Parameters
    ----------
    drive : Drive, optional
        The mean turn of the connectors, from the flat sheet to :data:`CLOSED`, unless given.
    """
    chosen = even_closing(sheet) if drive is None else drive
    path = yield from follow_steps(sheet.network, chosen, until_stuck=True)
    energy = NetworkEnergy(sheet.network)
    opening = sheet.opening(path.motion)
    in_plane, out_of_plane = sheet.strains(opening, energy.tension(path.motion))
    return Closing(
        sheet=sheet,
        path=path,
        phi=math.pi - opening.mean(axis=1),
        stretch_mm=energy.stretch(path.motion),
        in_plane=in_plane,
        out_of_plane=out_of_plane,
        asked=chosen.steps,
    )


def even_closing(sheet: SheetNetwork, end: float = CLOSED, steps: int = STEPS) -> Drive:
    """Drive the mean turn of the connectors from the flat sheet to an angle (radians): the sheet finds its own way.

    Where panels run into each other, a fifth of the steps are for the last :data:`NARROWING`.
    """
    last = steps // 5 if len(sheet.network.stops) and end + 2.0 * NARROWING < math.pi else 0
    turns = np.linspace(0.0, math.pi - end - (NARROWING if last else 0.0), steps - last)
    more = np.linspace(turns[-1], math.pi - end, last + 1)[1:]
    return mean_turn(sheet.network, sheet.connectors.sign, np.concatenate([turns, more]))


def ideal_motion(deployment: Deployment, network: PanelNetwork, width_mm: float, phi: float) -> FloatArray:
    """Displacement (mm) and turn (radians) of every panel (P, 3) at an angle: the way with connectors on the nodes.

    Parameters
    ----------
    network : PanelNetwork
        Its panels, row by row, at rest as the flat sheet of that width with its smallest coordinates at 0.
    phi : float, radians

    The middle of the nodes stays where it is.
    """
    tables = deployment.topology
    half = 0.5 * (math.pi - check_phi(phi))
    flat, scale = _flat_nodes(deployment, width_mm)
    nodes = deployment.nodes(phi) * scale
    nodes += flat.mean(axis=0) - nodes.mean(axis=0)
    row, column = np.indices((tables.rows + 1, tables.columns + 1))
    theta = np.where((row + column) % 2 == 0, -half, half).ravel()
    first = tables.panel_nodes.reshape(-1, 4)[:, 0]
    if network.numbers is not None:
        theta, first = theta[network.numbers], first[network.numbers]
    moved = _turned(network.centroids - flat[first], theta) + nodes[first]
    return np.column_stack([moved - network.centroids, theta])


def carried_on(found: Closing, deployment: Deployment, width_mm: float, phi: float) -> FloatArray:
    """Motion (P, 3) at an angle (radians) that may lie a little beyond the last step of a closing.

    Up to the last step it is what was simulated.  Beyond it the panels go on as the ideal ones do, with what they were
    off by: a closed sheet is simulated to :data:`CLOSED` only, where contacts set in.
    """
    if phi >= found.phi.min():
        return found.motion_at(phi)
    network, last = found.sheet.network, found.path.motion[int(np.argmin(found.phi))]
    before, after = (
        ideal_motion(deployment, network, width_mm, angle) for angle in (float(found.phi.min()), max(phi, 0.0))
    )
    here, ideal, ahead = (network.centroids @ (1.0, 1j) + motion[:, :2] @ (1.0, 1j) for motion in (last, before, after))
    # The simulated sheet lies elsewhere in the plane: both are compared after the best rigid motion.
    turned = float(np.angle(np.sum((here - here.mean()) * np.conj(ideal - ideal.mean()))))
    place = np.exp(1j * turned) * (ahead - ahead.mean() - ideal + ideal.mean()) + here
    theta = after[:, 2] - before[:, 2] + last[:, 2]
    return np.column_stack([place.real - network.centroids[:, 0], place.imag - network.centroids[:, 1], theta])


def silhouette(deployment: Deployment, network: PanelNetwork, width_mm: float, motion: FloatArray) -> FloatArray:
    """Outer boundary (K, 2), mm, of the sheet after a motion (P, 3): of the union of all panels and voids."""
    area = covered_area(deployment, network, width_mm, motion)
    return np.asarray(shapely.get_coordinates(area.exterior)[:-1], dtype=np.float64)


def covered_area(
    deployment: Deployment, network: PanelNetwork, width_mm: float, motion: FloatArray, brief: bool = False
) -> shapely.Polygon:
    """Area, mm, of all panels and voids after a motion (P, 3), with openings inside.

    Corners that panels share lie halfway between theirs where a connector is stretched.  Voids beside a trimmed panel
    are left out, because they may reach beyond it.  Where it is to be ``brief``, as for pictures on the way, cracks are
    bridged with sharp corners and nothing is snapped to a grid: that takes a quarter of the time and is off by 2e-7 of
    the area at 24 x 24 voids with connectors of 0.2 mm, by 3e-4 at 6 x 6 with 0.8 mm that jam (tried once).
    """
    tables = deployment.topology
    nodes, corners, table = moved_nodes(deployment, network, width_mm, motion)
    panels = shapely.polygons(network.moved_outlines(motion))
    lost = shapely.area(shapely.polygons(corners)) - shapely.area(panels)
    whole = np.zeros((tables.rows + 1, tables.columns + 1), dtype=np.bool_)
    whole.flat[_numbers(network)] = lost <= TRIMMED * shapely.area(panels)
    closed_in = whole[:-1, :-1] & whole[:-1, 1:] & whole[1:, :-1] & whole[1:, 1:]
    voids = shapely.polygons(nodes[tables.void_nodes[closed_in]])
    parts = shapely.make_valid(np.concatenate([panels, voids]))
    # Beside stretched connectors there are cracks between panels and voids; along notches panels hang together by
    # hinges alone, without voids between them.
    grid, crack = 1e-6 * width_mm, float(np.linalg.norm(corners - nodes[table], axis=-1).max())
    bridge = max(crack, CRACK * network.panel_size) if crack > ROUNDED * grid else 0.0
    bridge = bridge if network.numbers is None else max(bridge, BRIDGED * network.panel_size)
    if bridge:
        style: Literal["mitre", "round"] = "mitre" if brief else "round"
        bridged = shapely.buffer(parts, bridge, join_style=style)
        united = shapely.union_all(bridged, grid_size=None if brief else grid)
        united = shapely.buffer(united, -bridge, join_style=style)
    else:
        united = shapely.union_all(parts, grid_size=grid)
    largest: shapely.Polygon = max(shapely.get_parts(united), key=lambda part: float(part.area))
    return largest


def moved_nodes(
    deployment: Deployment, network: PanelNetwork, width_mm: float, motion: FloatArray
) -> tuple[FloatArray, FloatArray, IntArray]:
    """Where the nodes of a sheet are after a motion (P, 3).

    Returns
    -------
    nodes : (N, 2) float, mm
        Halfway between the corners that panels have there; not a number where there is no panel left.
    corners : (P, 4, 2) float, mm
        Of the panels, before they were trimmed.
    table : (P, 4) int
        The nodes that they belong to.
    """
    tables = deployment.topology
    flat, _ = _flat_nodes(deployment, width_mm)
    table = tables.panel_nodes.reshape(-1, 4)[_numbers(network)]
    corners = _turned(flat[table] - network.centroids[:, None], np.repeat(motion[:, 2, None], 4, axis=1))
    corners += (network.centroids + motion[:, :2])[:, None]
    sums = [np.bincount(table.ravel(), corners[..., axis].ravel(), tables.node_count) for axis in (0, 1)]
    shared = np.bincount(table.ravel(), minlength=tables.node_count)[:, None]
    nodes = np.divide(np.stack(sums, axis=1), shared, out=np.full((tables.node_count, 2), np.nan), where=shared > 0)
    return nodes, corners, table


def _numbers(network: PanelNetwork) -> IntArray:
    """Numbers (P,) of the network's panels in their sheet."""
    return np.arange(network.panel_count) if network.numbers is None else network.numbers


def _flat_nodes(deployment: Deployment, width_mm: float) -> tuple[FloatArray, float]:
    """All nodes (N, 2) of the flat sheet, mm, smallest coordinates 0, and the mm of a unit cell."""
    scale = width_mm / float(np.ptp(deployment.compact[:, 0]))
    return (deployment.compact - deployment.compact.min(axis=0)) * scale, scale


def _turned(arms: FloatArray, theta: FloatArray) -> FloatArray:
    """Vectors (..., 2) turned by angles (...)."""
    cos, sin = np.cos(theta), np.sin(theta)
    return np.stack([cos * arms[..., 0] - sin * arms[..., 1], sin * arms[..., 0] + cos * arms[..., 1]], axis=-1)
