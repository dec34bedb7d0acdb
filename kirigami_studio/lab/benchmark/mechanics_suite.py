"""The closing simulator beside published tests and simulations of panels on elastic hinges.

- Rotating squares: 4 x 4 squares on ligaments between two clamped rows, pulled, pressed and sheared.
- Circle-square morpher: 8 x 8 panels with two kinds of textile hinges, through a full closing.

- Random sheets of our own, closed with connectors on their nodes and with straight ones: time, stretch, and how near
  the fast estimate of the jam angle comes to the simulator.

The first two are from *Textile hinges enable extreme properties of mechanical metamaterials* (Nature Materials 2024)
and its repository textile-hinge-metamaterials; ``resources/mechanics/README.md`` says what is bundled.
"""

from __future__ import annotations

import math
import time
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from kirigami_studio.foundation.resources import resource
from kirigami_studio.lattice.deployment import deploy
from kirigami_studio.lattice.ratio_field import RatioField
from kirigami_studio.mechanics.closing import closing
from kirigami_studio.mechanics.connectors import ElasticSheet, cut_connectors, junctions
from kirigami_studio.mechanics.drive import clamped_ends
from kirigami_studio.mechanics.equilibrium import follow
from kirigami_studio.mechanics.estimate import estimate_stretch
from kirigami_studio.mechanics.network import PanelNetwork
from kirigami_studio.mechanics.network_files import SpringConstants, morpher_drive, read_network, slender_network
from kirigami_studio.mechanics.sheet_network import sheet_network

#: Distance of the squares, length of a ligament (mm), turn at rest, columns and rows with both clamped ones.
SPACING_MM, LIGAMENT_MM, TURN, COLUMNS, ROWS = 15.0, 2.25, math.radians(-20.0), 4, 6
#: Constants of their ligaments: N/mm, N/mm, N mm.
SQUARES_CONSTANTS = (120.0, 1.19, 1.5)
SQUARES_STEPS = 21
#: End force may miss the mean of the tests by their standard deviation or by this share of it.
SHARE, SHEAR_SHARE = 0.05, 0.12
MORPHER_STEPS = 100
#: Root mean square distance (N) that a force curve may have from the published simulation.
CURVE_N = 0.15
#: Published curves begin at this displacement (mm); what they have before it is interpolated from outside.
CURVE_FROM_MM = 0.0
#: What one case may take, seconds on one core.
MOST_SECONDS = 10.0
#: Random sheets: voids each way, how far ratios spread (powers of ten), width, connectors and kerf (mm), film.
SHEETS, SPREAD, WIDTH_MM, CONNECTOR_MM, KERF_MM = (10, 24), 0.3, 100.0, 0.2, 0.02
FILM = ElasticSheet(2500.0, 0.05)
#: Connectors on their nodes may be stretched by this share of their width on the way to 2 degrees.
ON_NODES = 0.05
#: Runs of the fast estimate, of which the quickest counts: processor time, from the decoded design on.
ESTIMATES = 20


@dataclass(frozen=True, slots=True)
class SquaresCase:
    """One published test of the rotating squares.

    Attributes
    ----------
    name : str
    direction : int
        Along which axis the upper clamp moves.
    distance_mm : float
    tested_n, deviation_n : float
        Mean and standard deviation of the end force in the tests.
    simulated_n : float
        The authors' own simulation.
    share : float
        By which share of the tested force the simulator may be off, if the deviation is smaller.
    """

    name: str
    direction: int
    distance_mm: float
    tested_n: float
    deviation_n: float
    simulated_n: float
    share: float

    def accepts(self, force_n: float) -> bool:
        return abs(force_n - self.tested_n) <= max(self.deviation_n, self.share * self.tested_n)


SQUARES_CASES = (
    SquaresCase("tension", 1, 1.05, 4.4, 0.6, 4.4, SHARE),
    SquaresCase("compression", 1, -3.75, 2.8, 0.13, 2.95, SHARE),
    SquaresCase("shear", 0, 3.75, 1.28, 0.1, 1.42, SHEAR_SHARE),
)

#: Constants of the morpher's hinges.
MORPHER_HINGES = {"L2": SpringConstants(882.0, 220.5, 3.78e-4), "T1": SpringConstants(1512.0, 252.0, 5e-5)}


@dataclass(frozen=True, slots=True)
class CaseResult:
    """One case: what was found beside what is published.

    Attributes
    ----------
    name : str
    found : str
    published : str
        Empty for cases of our own.
    seconds : float
    ok : bool
    figures : dict
    """

    name: str
    found: str
    published: str
    seconds: float
    ok: bool
    figures: dict[str, float]


@dataclass(frozen=True, slots=True)
class MechanicsFigures:
    """All cases of the suite."""

    cases: tuple[CaseResult, ...]

    @property
    def ok(self) -> bool:
        return all(case.ok for case in self.cases)

    def sentences(self) -> Iterator[str]:
        """The figures for the user, one line each."""
        for case in self.cases:
            published = f"; published {case.published}" if case.published else ""
            yield f"{case.name:22s} {case.found}{published}; {case.seconds:.2f} s: {'ok' if case.ok else 'NOT ok'}"


def rotating_squares(constants: tuple[float, float, float] = SQUARES_CONSTANTS) -> PanelNetwork:
    """The published specimen: squares on a grid, turned alternately, their corners joined by level and upright strips.

    Parameters
    ----------
    constants : (k_a, k_s, k_t)
        N/mm, N/mm, N mm.
    """
    row, column = np.divmod(np.arange(ROWS * COLUMNS), COLUMNS)
    centroids = SPACING_MM * np.stack([column, row], axis=1).astype(np.float64)
    radius = 0.5 * (SPACING_MM - LIGAMENT_MM) / math.cos(TURN)
    angle = np.where((row + column) % 2 == 0, TURN, -TURN)[:, None] + 0.5 * math.pi * np.arange(4)
    corners = centroids[:, None] + radius * np.stack([np.cos(angle), np.sin(angle)], axis=-1)
    number = np.arange(ROWS * COLUMNS).reshape(ROWS, COLUMNS)
    level = np.stack([number[:, :-1].ravel(), number[:, 1:].ravel()], axis=1)
    upright = np.stack([number[:-1].ravel(), number[1:].ravel()], axis=1)
    bonds = np.concatenate([np.insert(level, [1, 2], [0, 2], axis=1), np.insert(upright, [1, 2], [1, 3], axis=1)])
    network = slender_network(corners, bonds, centroids, np.zeros((0, 2)))
    return network.with_stiffness(*constants, contact=0.0)


def squares_force(case: SquaresCase, network: PanelNetwork) -> float:
    """End force, N, positive as the tests count it."""
    drive = clamped_ends(network, 1, case.direction, case.distance_mm, SQUARES_STEPS)
    return float(follow(network, drive).force[-1])


def measure_squares() -> list[CaseResult]:
    """All published tests of the rotating squares."""
    network, results = rotating_squares(), []
    for case in SQUARES_CASES:
        began = time.perf_counter()
        force = squares_force(case, network)
        seconds = time.perf_counter() - began
        results.append(
            CaseResult(
                f"squares, {case.name}",
                f"{force:.3f} N at {case.distance_mm:+.2f} mm",
                f"{case.tested_n:g} +- {case.deviation_n:g} N (simulation {case.simulated_n:g} N)",
                seconds,
                case.accepts(force) and seconds < MOST_SECONDS,
                {"force_n": force, "tested_n": case.tested_n, "simulated_n": case.simulated_n},
            )
        )
    return results


def measure_morpher(hinge: str, steps: int = MORPHER_STEPS) -> CaseResult:
    """Close the morpher with one kind of hinge and compare with the published curve."""
    path = resource("mechanics", "panel_network.npz")
    with np.load(path, allow_pickle=False) as archive:
        at, published = archive[f"{hinge}_displacement_mm"], archive[f"{hinge}_force_N"]
    began = time.perf_counter()
    file = read_network(path, MORPHER_HINGES[hinge])
    found = follow(file.network, morpher_drive(file, steps))
    seconds = time.perf_counter() - began
    there = at >= CURVE_FROM_MM
    off = np.interp(at[there], found.drive.displacement, found.force) - published[there]
    rms = float(np.sqrt(np.mean(off**2)))
    monostable = len(found.stable) == 1 and abs(float(found.stable[0])) < 1e-6
    return CaseResult(
        f"morpher, hinge {hinge}",
        f"{rms:.3f} N rms from the curve, {'monostable' if monostable else 'not monostable'}",
        "monostable",
        seconds,
        rms <= CURVE_N and monostable and seconds < MOST_SECONDS,
        {
            "rms_n": rms,
            "force_at_4_5_mm_n": float(np.interp(4.5, found.drive.displacement, found.force)),
            "force_at_8_5_mm_n": float(np.interp(8.5, found.drive.displacement, found.force)),
            "stable_states": float(len(found.stable)),
            "snaps": float(np.sum(found.snapped)),
        },
    )


def measure_sheet(size: int, seed: int = 0) -> CaseResult:
    """Close a random size x size sheet, with its connectors on the nodes and with straight ones."""
    ratios = np.random.default_rng(seed).uniform(-SPREAD, SPREAD, (size, size))
    design = deploy(RatioField.from_log10(ratios))
    found = junctions(design, WIDTH_MM)
    widths = np.full(len(found.node), CONNECTOR_MM)
    began = time.perf_counter()
    exact = closing(sheet_network(found.corners, cut_connectors(found, widths, KERF_MM, found.place), FILM))
    seconds = time.perf_counter() - began
    cut = sheet_network(found.corners, cut_connectors(found, widths, KERF_MM), FILM)
    straight = closing(cut)
    durations = []
    for _ in range(ESTIMATES):
        began = time.process_time()
        found = junctions(design, WIDTH_MM)
        cut = sheet_network(found.corners, cut_connectors(found, widths, KERF_MM), FILM)
        estimate = estimate_stretch(design, cut, WIDTH_MM)
        durations.append(time.process_time() - began)
    stretch = float(exact.stretch.max())
    jams = math.degrees(straight.jam_phi()), math.degrees(estimate.jam_phi())
    return CaseResult(
        f"sheet, {size} x {size} voids",
        f"on nodes closes to 2 degrees in {len(exact.phi)} steps, stretch {stretch:.3f} w; straight jams at "
        f"{jams[0]:.1f} degrees (estimate {jams[1]:.1f} in {1e3 * min(durations):.1f} ms)",
        "",
        seconds,
        exact.jam_phi() == 0.0 and stretch <= ON_NODES and seconds < MOST_SECONDS,
        {
            "stretch_on_nodes_widths": stretch,
            "straight_jam_deg": jams[0],
            "estimated_jam_deg": jams[1],
            "estimate_ms": 1e3 * min(durations),
        },
    )


def measure_mechanics() -> MechanicsFigures:
    """Run the whole suite: half a minute."""
    published = (*measure_squares(), *(measure_morpher(hinge) for hinge in MORPHER_HINGES))
    return MechanicsFigures((*published, *(measure_sheet(size) for size in SHEETS)))
