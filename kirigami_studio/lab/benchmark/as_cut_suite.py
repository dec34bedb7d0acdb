"""Silhouettes designed, cut with connectors of several widths, read back from their DXF files, and closed on them.

What the files say is read from them alone: pieces, panels, finished widths, and by how much voids miss being
parallelograms.  How the sheets close is simulated on their planned cuts, as the verdict on an export does.
"""

from __future__ import annotations

import math
import tempfile
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from itertools import product
from pathlib import Path

from kirigami_studio.evaluate.candidate import Candidate
from kirigami_studio.export.dxf_reading import read_with_ezdxf
from kirigami_studio.export.exporter import ExportJob
from kirigami_studio.export.profile import DEFAULT_PROFILE, find_profile
from kirigami_studio.export.registry import export
from kirigami_studio.export.verification import file_voids, verify_export
from kirigami_studio.fabricate.options import ConnectorStyle, CutOptions
from kirigami_studio.foundation.errors import KirigamiError
from kirigami_studio.foundation.steps import result_of
from kirigami_studio.lab.paper_evaluator import released_match
from kirigami_studio.lattice.deployment import deploy
from kirigami_studio.mechanics.network import CONTACT_BELOW
from kirigami_studio.outlines.outline import Outline
from kirigami_studio.settings.design import DesignSettings
from kirigami_studio.settings.fabrication import FabricationSettings
from kirigami_studio.studio.as_cut import simulate
from kirigami_studio.studio.cutting import plan_of
from kirigami_studio.studio.designing import completed, request_for, run_design

#: A connector counts as narrower than asked for from here on (mm); files hold a tenth of it.
NARROWER_MM = 1e-3
#: Void angles that are smaller by no more than this (radians) than where contacts begin do not press.
ROUNDING = 1e-9
Report = Callable[[int, int], None]


@dataclass(frozen=True, slots=True)
class SheetAsCut:
    """One silhouette at one width.

    Attributes
    ----------
    name : str
    connector_mm : float
        Finished width that was asked for.
    passed : bool
        Whether the written file passed every check of two readers.
    pieces, panels, connectors : int
        As read from the file.
    void_miss_um : float
        Largest miss of a void's four connectors from a parallelogram, as read from the file.
    narrowed : int
        Connectors that are narrower than asked for.
    narrowest_mm : float
        As read from the file.
    jam_deg : float
        Angle at which the sheet jams; 0 where it closes to 2 degrees.
    stretch, stretch_before_contact : float
        Largest stretch of a connector on the way to 2 degrees, and until the first panels press on each other, in its
        widths.
    iou, iou_as_cut, uniform_iou : float
        Exact IoU of the design, of the sheet where it comes to, and of the uniform sheet.
    siou_released : float
        sIoU of the design as the paper's released code measures it.
    """

    name: str
    connector_mm: float
    passed: bool
    pieces: int
    panels: int
    connectors: int
    void_miss_um: float
    narrowed: int
    narrowest_mm: float
    jam_deg: float
    stretch: float
    stretch_before_contact: float
    iou: float
    iou_as_cut: float
    uniform_iou: float
    siou_released: float

    @property
    def row(self) -> str:
        """As a row of the table."""
        jam = "closes" if self.jam_deg == 0.0 else f"{self.jam_deg:.0f} deg"
        return (
            f"| {self.name} | {self.connector_mm:g} | {'yes' if self.passed else 'NO'} | {self.pieces} | {self.panels} "
            f"| {self.void_miss_um:.2f} | {self.narrowed} of {self.connectors} | {self.narrowest_mm:.3f} | {jam} "
            f"| {self.stretch_before_contact:.3f} | {self.stretch:.3f} | {self.iou:.4f} | {self.iou_as_cut:.4f} |"
        )


@dataclass(frozen=True, slots=True)
class AsCutFigures:
    """All sheets of the suite.

    Attributes
    ----------
    sheets : tuple of SheetAsCut
    refused : tuple of str
        Sheets whose cuts could not be planned or read, and why.
    """

    sheets: tuple[SheetAsCut, ...]
    refused: tuple[str, ...]

    @property
    def ok(self) -> bool:
        """Whether every file passed."""
        return not self.refused and all(sheet.passed for sheet in self.sheets)

    def sentences(self) -> list[str]:
        """The table, one row a sheet, in Markdown."""
        return [
            "| Silhouette | w (mm) | file passed | pieces | panels | voids miss (um) | narrower | narrowest (mm) "
            "| jams | stretch before contact (w) | stretch to 2 deg (w) | IoU designed | IoU as cut |",
            "|" + "---|" * 13,
            *(sheet.row for sheet in self.sheets),
            *self.refused,
        ]


def measure_as_cut(
    targets: Sequence[Outline],
    connectors_mm: Sequence[float],
    style: ConnectorStyle = ConnectorStyle.CENTRED,
    grid: tuple[int, int] = (10, 10),
    k: int = 32,
    seed: int = 0,
    report: Report = lambda done, total: None,
) -> AsCutFigures:
    """Design every target for every width as ``design --material`` does, untrimmed in the usual one, and cut the best.

    Parameters
    ----------
    targets : sequence of Outline
    connectors_mm : sequence of float, mm
        Finished widths.
    style : ConnectorStyle
    grid : (rows, columns) voids
    k, seed : int
        Number of designs, of which the best is cut, and their random seed.
    report : callable
        Gets the sheets done and their number.
    """
    sheets: list[SheetAsCut] = []
    refused: list[str] = []
    total = len(targets) * len(connectors_mm)
    with tempfile.TemporaryDirectory() as folder:
        for target, width in product(targets, connectors_mm):
            settings = FabricationSettings(connector_mm=width, options=CutOptions(style=style))
            wanted = DesignSettings(grid, k=k, seed=seed, auto_grid=False)
            best = completed(run_design(request_for(target, wanted, settings), settings), lambda _: None).best
            try:
                sheets.append(cut_sheet(target, best, settings, width, Path(folder) / "cut.dxf"))
            except KirigamiError as error:
                refused.append(f"{target.name} at {width:g} mm: {error}")
            report(len(sheets) + len(refused), total)
    return AsCutFigures(tuple(sheets), tuple(refused))


def cut_sheet(
    target: Outline, best: Candidate, settings: FabricationSettings, connector_mm: float, path: Path
) -> SheetAsCut:
    """Write a design as DXF to ``path``, read it back, and close the sheet.

    Raises
    ------
    KirigamiError
        Cuts that cannot be planned, a file that does not read, or panels that do not hang together.
    """
    motion = deploy(best.final_sheet)
    plan = plan_of(best, settings, motion)
    export(ExportJob(motion, plan=plan), path)
    verified = verify_export(plan, path, DEFAULT_PROFILE)
    found = file_voids(read_with_ezdxf(path).strokes, plan, find_profile(DEFAULT_PROFILE))
    sheet = result_of(simulate(motion, plan, settings.width_mm, best.final_phi, target, pose=best.final_pose))
    network, steps = sheet.closing.sheet.network, sheet.closing.path.motion
    # Voids of slits are as good as closed in the flat sheet, where their contacts do not press yet.
    free = (network.void_angles(steps) > CONTACT_BELOW - ROUNDING).all(axis=1)
    stretch = sheet.closing.stretch.max(axis=1)
    return SheetAsCut(
        name=target.name,
        connector_mm=connector_mm,
        passed=verified.ok,
        pieces=verified.pieces or 0,
        panels=found.panels,
        connectors=len(found.connectors),
        void_miss_um=found.miss_um,
        narrowed=sum(one.width_mm < connector_mm - NARROWER_MM for one in found.connectors),
        narrowest_mm=found.narrowest_mm,
        jam_deg=math.degrees(sheet.as_cut.jam_phi),
        stretch=float(stretch.max()),
        stretch_before_contact=float(stretch[free].max(initial=0.0)),
        iou=math.nan if sheet.as_cut.ideal_iou is None else sheet.as_cut.ideal_iou,
        iou_as_cut=math.nan if sheet.as_cut.iou is None else sheet.as_cut.iou,
        uniform_iou=best.score.uniform_iou,
        siou_released=released_match(motion, target),
    )
