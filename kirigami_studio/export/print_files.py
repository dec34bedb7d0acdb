"""A design that is printed on its pins -> a folder.

It has 3MF, STL and OBJ of each plate, pieces and their motion, and a sheet on printing.  The folder appears whole or
not at all, and every mesh is read back: closed, of the planned volume, and in its place.
"""

from __future__ import annotations

import json
import re
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from pathlib import Path

import numpy as np

from kirigami_studio.assembly.holding import HoldPlace
from kirigami_studio.assembly.nesting import LaidShape
from kirigami_studio.assembly.pieces import Assembly, Piece
from kirigami_studio.assembly.plates import flat_bounds, parts_for, seams, size_of
from kirigami_studio.assembly.printed import PinJoint, cap_solids, pinned_solids
from kirigami_studio.assembly.solids import LAYER_MM, Plate, at_origin
from kirigami_studio.export import assembly_files
from kirigami_studio.export.assembly_files import AssemblyFiles, pieces_json
from kirigami_studio.export.assembly_pdf import AssemblySheet, write_assembly_pdf
from kirigami_studio.export.hold_files import SIDE_BY_SIDE_STEPS, hold_lines
from kirigami_studio.export.layer_files import whole_folder
from kirigami_studio.export.paper import Paper
from kirigami_studio.export.verification import Finding, Verification
from kirigami_studio.fabricate.cut_plan import design_hash
from kirigami_studio.fabricate.fastener import PrintedPins
from kirigami_studio.fabricate.hold import HoldOptions
from kirigami_studio.fabricate.machine import Machine
from kirigami_studio.fabricate.material import Construction, Material
from kirigami_studio.foundation.arrays import IntArray, ShapeRings
from kirigami_studio.foundation.files import write_atomically
from kirigami_studio.foundation.frozen_mapping import FrozenMapping
from kirigami_studio.foundation.words import mark, tr, tr_n

#: Kinds of files that are written, the one for slicers first.
KINDS = (".3mf", ".stl", ".obj")
PIECES, SHEET = assembly_files.PIECES, assembly_files.SHEET
OWN_NAME = re.compile(rf"(plate-[1-9]\d*|caps)\.(3mf|stl|obj)|{assembly_files.OWN_NAME.pattern}")
STEPS = (
    mark(
        "Open the .3mf of a plate in the slicer (or its .stl): it is in mm, and lies on the plate as it is printed. "
        "Do not turn, split or arrange its parts, for they are hooked into each other."
    ),
    mark(
        "Print without support, in layers of {layer_mm:g} mm with a nozzle of 0.4 mm, the first layer no wider than "
        "the others: switch on the compensation of the elephant's foot. A brim must not reach into joints."
    ),
    mark("Let the plate cool down before the print is taken off, flat and in one piece."),
    mark(
        "Free the joints from the rim inwards: hold one piece and turn its neighbour to and fro by a few degrees "
        "until it clicks. Where the first layer has fused, cut along the ring with a thin blade from below."
    ),
    mark("Open the whole sheet slowly, a few times to and fro. Where joints stay stiff, print with more clearance."),
)
JOINING = (
    mark(
        "Lay the plates side by side as in the flat picture, from the lower right to the upper left. Each part lowers "
        "its pins into the rings of those right of it and below it; press a cap on each from below with a drop of glue "
        "on the pin alone, and turn the joint while it sets."
    ),
)
#: Stem of the files of caps.
CAPS = "caps"
LEGEND = {1: mark("pieces with pins"), 2: mark("pieces with rings")}


@dataclass(frozen=True, eq=False)
class PrintedPlate:
    """Pieces that are printed at once.

    Attributes
    ----------
    number : int
        From 1.
    placed : tuple of (Piece, LaidShape)
        The pieces and their places; the smallest coordinates of all outlines are 0.
    size_mm : (width, depth)
    """

    number: int
    placed: tuple[tuple[Piece, LaidShape], ...]
    size_mm: tuple[float, float]

    @property
    def name(self) -> str:
        """Stem of its files."""
        return f"plate-{self.number}"


@dataclass(frozen=True, eq=False)
class PrintJob:
    """All that the files of a printed assembly need.

    Attributes
    ----------
    assembly : Assembly
    material : Material
    machine : Machine
    pins : PrintedPins
    name : str
        Of the design.
    paper : Paper
        Of the sheet on printing.
    target : (L, 2) float or None, mm
        Target outline, in the frame of the assembly at its target angle.
    provenance : mapping of str to str
        Where the design comes from.
    verdict : str
        Level of the verdict on the design; "" where nobody has judged it.
    hold : HoldOptions
        Parts that hold it in its end states.
    holds : tuple of HoldPlace
        Where they are.
    grips : (str, str) or None
        Ids of the pieces to hold and to pull.
    """

    assembly: Assembly
    material: Material
    machine: Machine
    pins: PrintedPins
    name: str = ""
    paper: Paper = Paper.NONE
    target: ShapeRings = None
    provenance: Mapping[str, str] = field(default_factory=FrozenMapping)
    verdict: str = ""
    hold: HoldOptions = field(default_factory=HoldOptions)
    holds: tuple[HoldPlace, ...] = ()
    grips: tuple[str, str] | None = None

    construction = Construction.PRINTED
    notes = ()

    @property
    def thickness_mm(self) -> float:
        """Of all pieces, in whole layers."""
        return PinJoint.usual_mm(self.pins, self.material.thickness_mm)

    @cached_property
    def parts(self) -> tuple[IntArray, ...]:
        """Indices of the pieces on each plate; all on one where no division fits on the printer."""
        found = parts_for(self.assembly, self.machine.reach_mm)
        return (np.arange(len(self.assembly.pieces)),) if found is None else found

    @cached_property
    def seams(self) -> frozenset[int]:
        """Nodes of the pins that join pieces of different plates."""
        return seams(self.assembly, self.parts)

    @cached_property
    def plates(self) -> tuple[PrintedPlate, ...]:
        """Pieces on the plates of the printer, as they lie in the flat sheet."""
        bounds, shifts = flat_bounds(self.assembly), self.assembly.poses(np.pi)[:, :2]
        found = []
        for number, part in enumerate(self.parts, start=1):
            low = bounds[part, :2].min(axis=0)
            placed = tuple(
                (self.assembly.pieces[index], LaidShape(place, shifts[index] - low, 0.0))
                for place, index in enumerate(part.tolist())
            )
            found.append(PrintedPlate(number, placed, size_of(bounds[part])))
        return tuple(found)

    @cached_property
    def solids(self) -> tuple[Plate, ...]:
        """Bodies of each plate, their lowest corner at the origin.

        Raises
        ------
        FabricationError
            A piece whose surface does not close.
        """
        solids = pinned_solids(
            self.assembly, self.thickness_mm, self.pins, self.seams, self.holds, self.hold.magnet_height_mm
        )
        return tuple(at_origin([solids[index] for index in part]) for part in self.parts)

    @cached_property
    def caps(self) -> Plate:
        """Feet for the pins at seams, to be printed as well."""
        return at_origin(cap_solids(len(self.seams), self.thickness_mm, self.pins)) if self.seams else ()

    @property
    def printed(self) -> tuple[tuple[PrintedPlate, Plate], ...]:
        """Plates with their bodies."""
        return tuple(zip(self.plates, self.solids, strict=True))

    @property
    def volume_mm3(self) -> float:
        """Of all plates, without what infill saves."""
        return sum(solid.volume_mm3 for plate in (*self.solids, self.caps) for solid in plate)

    @property
    def about(self) -> str:
        """Words on the design in every file."""
        facts = {
            "construction": self.construction.value,
            "design": design_hash(self.assembly.deployment, ()),
            "thickness_mm": f"{self.thickness_mm:g}",
            "pin_mm": f"{self.pins.pin_mm:g}",
            "ear_mm": f"{self.pins.ear_mm:g}",
            "clearance_mm": f"{self.pins.clearance_mm:g}",
            "material": self.material.key,
            **({"verdict": self.verdict} if self.verdict else {}),
            **self.provenance,
        }
        return "; ".join(f"{key} {text}" for key, text in facts.items())

    @property
    def lines(self) -> tuple[str, ...]:
        """Figures of the print in sentences."""
        plates = [
            tr_n(
                "{plate}: {width:.1f} x {depth:.1f} mm on the plate, {count} piece",
                "{plate}: {width:.1f} x {depth:.1f} mm on the plate, {count} pieces",
                len(plate.placed),
                plate=plate.name,
                width=plate.size_mm[0],
                depth=plate.size_mm[1],
            )
            for plate in self.plates
        ]
        if self.seams:
            plates.append(
                tr_n(
                    "caps: {count} foot for the pins at the seams between plates",
                    "caps: {count} feet for the pins at the seams between plates",
                    len(self.seams),
                )
            )
        pins, layers = self.pins, round(self.thickness_mm / LAYER_MM)
        return (
            *plates,
            tr(
                "{thickness:g} mm thick, {layers} layers of {layer:g} mm",
                thickness=self.thickness_mm,
                layers=layers,
                layer=LAYER_MM,
            ),
            tr_n(
                "{count} joint: ears {ear:g} mm, pins {pin:g} mm, clearance {clearance:g} mm",
                "{count} joints: ears {ear:g} mm, pins {pin:g} mm, clearance {clearance:g} mm",
                len(self.assembly.hinges),
                ear=pins.ear_mm,
                pin=pins.pin_mm,
                clearance=pins.clearance_mm,
            ),
            *(
                f"{entry.count} {tr(assembly_files.ITEMS[entry.item])}, {entry.note}"
                for entry in hold_lines(self.holds, self.hold)
            ),
            tr(
                "{material}: {volume:.1f} cm3 where it is solid; weight and time are told by the slicer",
                material=tr(self.material.name),
                volume=self.volume_mm3 / 1000.0,
            ),
        )


def write_print(
    job: PrintJob,
    folder: str | Path,
    kinds: Sequence[str] = KINDS,
    judged: Callable[[Sequence[Verification]], str] | None = None,
) -> AssemblyFiles:
    """Write the whole folder; parameters and errors as of ``write_assembly``."""
    from kirigami_studio.export.meshes import write_plate  # with libraries that few need

    home = Path(folder)
    _ = job.solids  # refused before a folder is made
    if judged is not None:  # what is read back is as planned, or nothing is written
        expected = [_verification(plate, bodies, home, ".3mf") for plate, bodies in job.printed]
        job = replace(job, verdict=judged(expected))
    verified = []
    with whole_folder(home, OWN_NAME) as fresh:
        for plate, bodies in job.printed:
            for kind in kinds:
                write_plate(bodies, fresh / f"{plate.name}{kind}", job.about)
                verified.append(_verification(plate, bodies, home, kind))
        for kind in kinds if job.caps else ():
            write_plate(job.caps, fresh / f"{CAPS}{kind}", job.about)
        write_atomically(
            fresh / PIECES,
            (json.dumps(pieces_json(job.assembly, holds=job.holds), separators=(",", ":")) + "\n").encode(),
        )
        joining = JOINING if job.seams else ()
        steps = tuple(tr(step, layer_mm=LAYER_MM) for step in (*STEPS[:-1], *joining, STEPS[-1]))
        about = {"title": job.name or tr("Printed kirigami"), "subject": job.about}
        sheet = AssemblySheet(
            job.assembly,
            (),
            about,
            job.lines,
            job.target,
            job.holds,
            steps=steps,
            legend=LEGEND,
            hold_steps=SIDE_BY_SIDE_STEPS,
            grips=job.grips,
            pins_are_put_in=False,
        )
        write_assembly_pdf(sheet, fresh / SHEET, job.paper)
        names = sorted(entry.name for entry in fresh.iterdir())
    return AssemblyFiles(tuple(home / name for name in names), tuple(verified))


def _verification(plate: PrintedPlate, bodies: Plate, home: Path, kind: str) -> Verification:
    """Findings of reading back a plate's file, which is there only where it holds."""
    width, depth, height = np.max([solid.high for solid in bodies], axis=0).tolist()
    volume = sum(solid.volume_mm3 for solid in bodies) / 1000.0
    found = Finding.judged(True, "mesh.as_planned", bodies=len(bodies), volume_cm3=volume, height_mm=height)
    return Verification(home / f"{plate.name}{kind}", True, (width, depth), len(bodies), 0.0, 0.0, 0.0, (found,), ())
