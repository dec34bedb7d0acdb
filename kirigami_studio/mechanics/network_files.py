"""Networks of panels from .npz archives, and the drive of the circle-square morpher that is published with one.

An archive holds, in SI units (as resources/mechanics/README.md describes):

quads_m : (P, 4, 2)
    Corners of the panels at rest.
bonds : (L, 4) int
    Panel A, corner of A, panel B, corner of B of every ligament.
centroids_m : (P, 2), optional
    Where panels turn about; the mean of their corners unless given.
void_rest_angles : (L, 2), optional
    The two void angles at every ligament at rest, radians; they change by -1 and +1 times theta_B - theta_A.
quads_without_gap_m : (P, 4, 2), optional
    The panels before ligaments were given room; the morpher's drive is measured on them.
"""

from __future__ import annotations

import math
import zipfile
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from kirigami_studio.foundation.arrays import FloatArray, IntArray
from kirigami_studio.foundation.errors import MechanicsError
from kirigami_studio.mechanics.drive import Drive
from kirigami_studio.mechanics.network import CONTACT_STIFFNESS, Contacts, Ligaments, PanelNetwork, check_values

#: Files above this size (bytes) are refused.
LARGEST_FILE = 64 << 20
#: Most panels of a network that is read.
MOST_PANELS = 20_000
MM_PER_M = 1e3


@dataclass(frozen=True, slots=True)
class SpringConstants:
    """One set of constants for all ligaments, in SI units as they are published."""

    #: stretching, shearing: N/m; k_a and k_s.
    stretching: float
    shearing: float
    turning: float  #: N m; k_t
    contact: float = CONTACT_STIFFNESS  #: stiffness of contacts in turning stiffnesses


@dataclass(frozen=True, slots=True, eq=False)
class NetworkFile:
    """What an archive holds."""

    network: PanelNetwork
    #: (P, 4, 2), mm; the panels before ligaments were given room; the panels themselves where the archive does not say.
    without_gap: FloatArray


def read_network(path: Path, constants: SpringConstants) -> NetworkFile:
    """Read a network of slender ligaments.

    Raises
    ------
    MechanicsError
        No archive, missing arrays, or arrays that make no network.
    """
    arrays = _arrays(path)
    if missing := [name for name in ("quads_m", "bonds") if name not in arrays]:
        raise MechanicsError("network_file.array_missing", path=path.name, name=missing[0], found=", ".join(arrays))
    quads, bonds = arrays["quads_m"], arrays["bonds"]
    count, length = len(quads) if quads.ndim else 0, len(bonds) if bonds.ndim else 0
    if count > MOST_PANELS:
        raise MechanicsError("network_file.too_many_panels", found=count, most=MOST_PANELS)
    check_values("quads_m", quads, (count, 4, 2))
    check_values("bonds", bonds, (length, 4))
    corner = bonds[:, [1, 3]]
    if bonds.dtype.kind not in "iu" or (corner.size and not 0 <= corner.min() <= corner.max() <= 3):
        raise MechanicsError("network_file.bonds_not_corners", path=path.name)
    corners = quads.astype(np.float64) * MM_PER_M
    table = bonds.astype(np.intp)
    centroids = corners.mean(axis=1)
    if "centroids_m" in arrays:
        check_values("centroids_m", arrays["centroids_m"], (count, 2))
        centroids = arrays["centroids_m"].astype(np.float64) * MM_PER_M
    without_gap = corners
    if "quads_without_gap_m" in arrays:
        check_values("quads_without_gap_m", arrays["quads_without_gap_m"], (count, 4, 2))
        without_gap = arrays["quads_without_gap_m"].astype(np.float64) * MM_PER_M
    rest = np.zeros((0, 2))
    if "void_rest_angles" in arrays:
        check_values("void_rest_angles", arrays["void_rest_angles"], (length, 2))
        rest = arrays["void_rest_angles"].astype(np.float64)
    network = slender_network(corners, table, centroids, rest)
    return NetworkFile(
        network.with_stiffness(
            constants.stretching / MM_PER_M,
            constants.shearing / MM_PER_M,
            constants.turning * MM_PER_M,
            constants.contact,
        ),
        without_gap,
    )


def slender_network(
    corners: FloatArray, bonds: IntArray, centroids: FloatArray, void_angles: FloatArray
) -> PanelNetwork:
    """Panels joined at corners by slender ligaments, all constants 1.

    Parameters
    ----------
    corners : (P, 4, 2) float, mm
    bonds : (L, 4) int
        Panel A, corner of A, panel B, corner of B.
    centroids : (P, 2) float, mm
    void_angles : (L, 2) float, radians
        At rest; empty for a network without contacts.

    Raises
    ------
    MechanicsError
        What makes no network.
    """
    panels, length = bonds[:, [0, 2]], len(bonds)
    if panels.size and not 0 <= panels.min() <= panels.max() < len(corners):
        raise MechanicsError("network.number_out_of_range", number=int(panels.max()), last=len(corners) - 1)
    points = np.stack([corners[bonds[:, 0], bonds[:, 1]], corners[bonds[:, 2], bonds[:, 3]]], axis=1)
    ones = np.ones(length)
    ligaments = Ligaments(
        panels, points, np.ones(length, dtype=np.bool_), np.zeros(length), ones, ones.copy(), ones.copy()
    )
    touching = len(void_angles) * 2
    contacts = Contacts(
        ligament=np.repeat(np.arange(len(void_angles)), 2),
        sign=np.tile([-1.0, 1.0], len(void_angles)),
        rest=void_angles.ravel().copy(),
        stiffness=np.ones(touching),
    )
    return PanelNetwork(centroids, ligaments, contacts, corners)


def _arrays(path: Path) -> dict[str, np.ndarray]:
    """All arrays of an archive by name."""
    try:
        if not path.is_file():
            raise MechanicsError("network_file.not_found", path=path)
        if path.stat().st_size > LARGEST_FILE:
            raise MechanicsError("network_file.too_large", path=path, limit=LARGEST_FILE >> 20)
        with zipfile.ZipFile(path) as archive:
            if sum(entry.file_size for entry in archive.infolist()) > LARGEST_FILE:
                raise MechanicsError("network_file.too_large", path=path, limit=LARGEST_FILE >> 20)
        with np.load(path, allow_pickle=False) as loaded:
            return {name: np.asarray(loaded[name]) for name in loaded.files}
    except MechanicsError:
        raise
    except Exception as error:
        # NumPy and zipfile raise a dozen kinds for a damaged archive.
        raise MechanicsError("network_file.not_readable", path=path) from error


#: The morpher's grips: the panel that is held, the one that is moved, and the corners that face each other.
HELD_PANEL, MOVED_PANEL = 28, 35
#: How far beyond the direction of the held panel's edge the moved corner goes (radians).
BEYOND = 0.1
#: Where on the way from a panel's middle to its corner displacement is measured.
MARK = 0.6


def morpher_drive(file: NetworkFile, steps: int = 100, there_and_back: bool = False) -> Drive:
    """The published drive of the 8 x 8 circle-square morpher.

    One panel is held, another one moved without turning, so that its corner 0 goes on a circle about corner 1 of the
    held panel until it has passed that panel's corner 2.  (Textile hinges enable extreme properties of mechanical
    metamaterials, Nature Materials 2024, and its repository textile-hinge-metamaterials.)  The displacement is by how
    much two marks on both panels come nearer to each other.

    Raises
    ------
    MechanicsError
        A network with too few panels, or whose grips do not move.
    """
    network, free = file.network, file.without_gap
    if network.panel_count <= max(HELD_PANEL, MOVED_PANEL):
        raise MechanicsError("drive.unknown_panel", panel=max(HELD_PANEL, MOVED_PANEL), last=network.panel_count - 1)
    held, moved = free[HELD_PANEL], free[MOVED_PANEL]
    arm, goal = moved[0] - held[1], held[2] - held[1]
    first, last = math.atan2(arm[1], arm[0]), math.atan2(goal[1], goal[0])
    sweep = np.linspace(0.0, 2.0 * math.pi + last - first + BEYOND, steps)
    angle = first + sweep
    radius = math.hypot(*arm)
    shift = radius * (np.stack([np.cos(angle), np.sin(angle)], axis=1) - (math.cos(first), math.sin(first)))
    along = radius * np.stack([-np.sin(angle), np.cos(angle)], axis=1)
    if there_and_back:
        shift, along = (np.concatenate([part, part[-2::-1]]) for part in (shift, along))
    marks = [
        network.centroids[panel] + MARK * (network.outlines[panel, corner] - network.centroids[panel])
        for panel, corner in ((HELD_PANEL, 2), (MOVED_PANEL, 0))
    ]
    between = marks[1] + shift - marks[0]
    distance = np.linalg.norm(between, axis=1)
    displacement = float(np.linalg.norm(marks[1] - marks[0])) - distance
    freedoms = np.concatenate([3 * HELD_PANEL + np.arange(3), 3 * MOVED_PANEL + np.arange(3)])
    path, rate = np.zeros((2, len(shift), 6))
    path[:, 3:5] = shift
    if not (np.all(distance > 0.0) and np.all(np.abs(np.sum(between * along, axis=1)) > 0.0)):
        raise MechanicsError("drive.nothing_moves")
    nearer = -np.sum(between * along, axis=1) / distance
    rate[:, 3:5] = along / nearer[:, None]
    return Drive(freedoms, path, displacement, rate)
