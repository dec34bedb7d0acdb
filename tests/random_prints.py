"""Writes random designs on printed pins and reads them back: ``python tests/random_prints.py 40``.

Each is a random pinwheel trimmed to an ellipse, with clearance, pin, thickness and target angle of its own.  Its 3MF is
read by lib3mf and its STL by numpy-stl: closed bodies of the planned volume to 0.1 %, which keep the clearance when
they are put together by ``pieces.json`` at angles of the motion.
"""

from __future__ import annotations

import json
import math
import sys
from dataclasses import replace
from itertools import combinations
from pathlib import Path

import numpy as np
from manifold3d import Manifold, Mesh64
from random_assemblies import MOST, played, posed
from solid_reader import ReadBody, read_3mf, read_stl

from kirigami_studio.assembly.options import PinOptions
from kirigami_studio.assembly.pinned import pinned
from kirigami_studio.export.print_files import PrintJob, write_print
from kirigami_studio.fabricate.fastener import PrintedPins
from kirigami_studio.fabricate.machine import find_machine
from kirigami_studio.fabricate.material import find_material

#: Shares of a volume, and mm of a clearance, that are rounding: discs are polygons.
SAME_VOLUME, ROUNDNESS_MM = 1e-3, 0.02
#: Angles of the motion at which bodies are put together.
ANGLES = 3


def random_print(seed: int, most: int = MOST) -> PrintJob:
    """A random design of ``most`` voids each way, and how it is printed."""
    random = np.random.default_rng(seed)
    rows, columns = (int(random.integers(2, most + 1)) for _ in range(2))
    phi = float(random.choice([0.0, 0.0, random.uniform(0.2, 2.0)]))
    pins = PrintedPins.of(float(random.uniform(2.0, 4.0)), None, float(random.uniform(0.2, 0.5)))
    sizes = {"pin_mm": pins.pin_mm, "ear_mm": pins.ear_mm, "clearance_mm": pins.clearance_mm, "neck_mm": 0.8}
    wall = 0.5 * (pins.ear_mm - pins.pin_mm)
    options = PinOptions(**sizes, wall_mm=wall, head_mm=0.0, margin_mm=0.0, in_one_plane=True)
    design, target = posed(rows, columns, seed, phi)
    assembly = pinned(design, target, 4.0 * pins.ear_mm * (columns + 1), options).assembly
    material = replace(find_material("pla-print"), thickness_mm=float(random.uniform(2.0, 8.0)))
    return PrintJob(assembly, material, find_machine("fdm-256"), pins)


def faults(seed: int, folder: Path, most: int = MOST) -> list[str]:
    """Write a random print, read it back, and name all that is not as it should be."""
    job = random_print(seed, most)
    write_print(job, folder)
    found = []
    for plate, planned in job.printed:
        bodies, alone = read_3mf(folder / f"{plate.name}.3mf"), read_stl(folder / f"{plate.name}.stl")
        volumes = {solid.name: solid.volume_mm3 for solid in planned}
        if set(bodies) != set(volumes):
            found.append(f"{plate.name}: {len(bodies)} bodies of {len(volumes)}")
            continue
        for name, body in bodies.items():
            if not body.closed or abs(body.volume - volumes[name]) > SAME_VOLUME * volumes[name]:
                found.append(f"{plate.name}: {name}: closed {body.closed}, volume {body.volume:.1f}")
        total = sum(volumes.values())
        if not alone.closed or abs(alone.volume - total) > SAME_VOLUME * total:
            found.append(f"{plate.name}: STL closed {alone.closed}, volume {alone.volume:.1f} of {total:.1f}")
        if not (np.allclose(alone.bounds[0], 0.0, atol=1e-3) and abs(alone.bounds[1, 2] - job.thickness_mm) < 1e-3):
            found.append(f"{plate.name}: from {alone.bounds[0]} to {alone.bounds[1]}")
        gap = least_gap(bodies, folder / "pieces.json", 2.0 * job.pins.clearance_mm)
        if gap < job.pins.clearance_mm - ROUNDNESS_MM:
            found.append(f"{plate.name}: bodies come within {gap:.3f} mm, not {job.pins.clearance_mm:.3f} mm")
    return found


def least_gap(bodies: dict[str, ReadBody], motion: Path, within: float) -> float:
    """Least distance, mm, of any two bodies of a plate at some angles of the motion; ``within`` at most."""
    frames = json.loads(motion.read_text())["motion"]
    flat, least = frames[0]["poses"], within
    solids = {}
    for name, body in bodies.items():
        points, faces = np.unique(body.triangles.reshape(-1, 3), axis=0, return_inverse=True)
        solids[name] = Manifold(Mesh64(np.ascontiguousarray(points, dtype=np.float64), faces.reshape(-1, 3)))
    # The plate's corner is at the origin; that of the flat sheet is where its outlines end.
    pieces = {piece["id"]: np.array(piece["outline"]) for piece in json.loads(motion.read_text())["pieces"]}
    corner = np.min([(ring + flat[name][:2]).min(axis=0) for name, ring in pieces.items()], axis=0)
    low = np.min([body.bounds[0] for body in bodies.values()], axis=0)[:2]
    for frame in frames[:: max(1, (len(frames) - 1) // (ANGLES - 1))]:
        placed = {}
        for name, solid in solids.items():
            (x, y, turn), (u, v, _) = frame["poses"][name], flat[name]
            back = solid.translate([corner[0] - low[0] - u, corner[1] - low[1] - v, 0.0])
            placed[name] = back.rotate([0.0, 0.0, math.degrees(turn)]).translate([x, y, 0.0])
        for one, other in combinations(placed.values(), 2):
            a, b = np.array(one.bounding_box()), np.array(other.bounding_box())
            if np.all(a[:3] <= b[3:] + within) and np.all(b[:3] <= a[3:] + within):
                least = min(least, one.min_gap(other, within))
    return least


if __name__ == "__main__":
    sys.exit(played(faults, __doc__))
