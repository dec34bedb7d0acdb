"""Writes random pinned designs and reads them back without the program: ``python tests/random_assemblies.py 200``.

Each is a random pinwheel with ears, kerf, bed, profile and target angle of its own; every other one has the pieces of
the program (notches, trimmed rims), the others simple ones.  Its DXF, SVG and LightBurn files are read by libraries,
pieces are recognised by their holes, and put together by ``pieces.json`` at all of its angles.  One design in twenty
has 10 x 10 voids.  With ``--results FILE`` a run that was stopped goes on.
"""

from __future__ import annotations

import argparse
import math
import sys
import tempfile
import time
from collections.abc import Callable
from pathlib import Path

import numpy as np
from piece_reader import Together, put_together
from pinned_assemblies import CELL_MM, CLEARANCE_MM, EAR_MM, HOLE_MM, pinwheel, small_assembly
from shapely.geometry import Polygon

from kirigami_studio.assembly.options import PinOptions
from kirigami_studio.assembly.pieces import Assembly
from kirigami_studio.assembly.pinned import pinned
from kirigami_studio.evaluate.posed_design import PosedDesign
from kirigami_studio.evaluate.similarity import Similarity
from kirigami_studio.export.assembly_files import KINDS, AssemblyJob, write_assembly
from kirigami_studio.export.paper import Paper
from kirigami_studio.export.profile import DxfVersion
from kirigami_studio.fabricate.fastener import Fastener
from kirigami_studio.fabricate.machine import Machine, MachineKind
from kirigami_studio.fabricate.material import find_material
from kirigami_studio.outlines.outline import Outline

#: Bounds of what is read back: outlines, holes and pins in mm, overlap in mm^2.
BOUNDS = Together(0, 2e-3, 1e-3, 1e-3, 0.01)
#: What a line says of a design without faults.
GOOD = "as it should be"
#: Voids each way at most, and the grid of one design in so many.
MOST, LARGE_GRID, LARGE_EVERY = 6, (10, 10), 20
#: Profiles with one file for each bed that has arcs.
PROFILES = ("any", "lightburn", "single", "glowforge", "slots")


def posed(rows: int, columns: int, seed: int, phi: float) -> tuple[PosedDesign, Outline]:
    """A pinwheel over an ellipse of the area that it has at an angle."""
    deployment = pinwheel(rows, columns, seed)
    shape = Polygon(deployment.outline(phi))
    scale, middle = 1.0 / math.sqrt(shape.area), np.array(shape.centroid.coords[0])
    turn = np.linspace(0.0, 2.0 * math.pi, 72, endpoint=False)
    aspect = math.sqrt(columns / rows)
    ellipse = np.column_stack([np.cos(turn) * aspect, np.sin(turn) / aspect]) / math.sqrt(math.pi)
    return PosedDesign(deployment, Similarity(scale, 0.0, tuple(-scale * middle)), phi), Outline.from_points(ellipse)


def random_grid(random: np.random.Generator, seed: int, most: int) -> tuple[int, int]:
    """A grid of ``most`` voids each way; every so many designs of a long run have a large one."""
    rows, columns = (int(random.integers(2, most + 1)) for _ in range(2))
    return LARGE_GRID if most == MOST and seed % LARGE_EVERY == LARGE_EVERY - 1 else (rows, columns)


def random_job(seed: int, most: int = MOST) -> AssemblyJob:
    """A random design with random choices of its cutting, of ``most`` voids each way."""
    random = np.random.default_rng(seed)
    rows, columns = random_grid(random, seed, most)
    phi = float(random.choice([0.0, 0.0, random.uniform(0.2, 2.0)]))
    kerf = float(random.choice([0.0, 0.05, 0.15, 0.2, 0.3]))
    bed = [float(random.choice([0.0, random.uniform(120.0, 600.0)])) for _ in range(2)]
    if seed % 2:
        options = PinOptions(clearance_mm=0.6)
        design, target = posed(rows, columns, seed, phi)
        assembly: Assembly = pinned(design, target, 35.0 * (columns + 1), options).assembly
        sizes = (options.pin_mm, options.ear_mm, options.clearance_mm)
    else:
        cell = float(random.uniform(20.0, 90.0))
        assembly = small_assembly(rows, columns, seed, cell, phi)
        sizes = (HOLE_MM * cell / CELL_MM, EAR_MM * cell / CELL_MM, CLEARANCE_MM * cell / CELL_MM)
    machine = Machine("", "a machine", MachineKind.CO2, bed_width_mm=bed[0], bed_height_mm=bed[1])
    return AssemblyJob(
        assembly,
        find_material("plywood-co2"),
        machine,
        Fastener.M3,
        kerf,
        *sizes,
        profile=str(random.choice(PROFILES)),
        dxf_version=DxfVersion(str(random.choice(["R2010", "R12"]))),
        paper=Paper(str(random.choice(["none", "a4", "letter"]))),
    )


def faults(seed: int, folder: Path, most: int = MOST) -> list[str]:
    """Write a random design, read it back without the program, and name all that is not as it should be."""
    job = random_job(seed, most)
    write_assembly(job, folder)
    found = []
    for kind in KINDS:
        if not list(folder.glob(f"*{kind}")):
            if kind != ".lbrn2" or job.profile != "slots":
                found.append(f"no {kind}")
            continue
        read = put_together(folder, kind, job.allowed_mm)
        if read.pieces != len(job.assembly.pieces):
            found.append(f"{kind}: {read.pieces} pieces of {len(job.assembly.pieces)}")
        for name in ("outline_mm", "holes_mm", "pins_mm", "overlap_mm2"):
            if not getattr(read, name) <= getattr(BOUNDS, name):
                found.append(f"{kind}: {name} {getattr(read, name):.2g}")
    return found


def played(faults: Callable[[int, Path], list[str]], about: str | None) -> int:
    """Make as many designs as the command line asks for, and print the faults of each; 1 if there are any.

    A run that was stopped goes on after the last design in its file of results.
    """
    parser = argparse.ArgumentParser(description=about)
    parser.add_argument("designs", type=int)
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--results", type=Path, help="file that gets a line for each design")
    asked = parser.parse_args()
    known = asked.results.read_text().splitlines() if asked.results and asked.results.exists() else []
    lines, begun = dict(line.split(": ", 1) for line in known), time.process_time()
    for seed in range(asked.seed, asked.seed + asked.designs):
        if f"{seed}" in lines:
            continue
        with tempfile.TemporaryDirectory() as folder:
            try:
                found = faults(seed, Path(folder) / "out")
            except Exception as error:  # every kind of failure is a fault of the design
                found = [f"{type(error).__name__}: {error}"]
        lines[f"{seed}"] = "; ".join(found) or GOOD
        sys.stdout.write(f"{seed}: {lines[f'{seed}']}\n")
        sys.stdout.flush()
        if asked.results:
            with asked.results.open("a") as results:
                results.write(f"{seed}: {lines[f'{seed}']}\n")
    bad = sum(line != GOOD for line in lines.values())
    sys.stdout.write(f"{len(lines)} designs, {bad} bad, {time.process_time() - begun:.0f} s of processor time\n")
    return min(bad, 1)


if __name__ == "__main__":
    sys.exit(played(faults, __doc__))
