"""Random designs through every machine profile and both DXF versions: files written, read twice, judged."""

from __future__ import annotations

import tempfile
import time
from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from kirigami_studio.export.exporter import ExportJob
from kirigami_studio.export.profile import PROFILES, DxfVersion
from kirigami_studio.export.registry import export
from kirigami_studio.export.verification import verify_export
from kirigami_studio.fabricate.cut_plan import plan_cuts
from kirigami_studio.fabricate.material import presets
from kirigami_studio.fabricate.options import ConnectorStyle, CutOptions
from kirigami_studio.foundation.errors import KirigamiError
from kirigami_studio.lattice.deployment import deploy
from kirigami_studio.lattice.ratio_field import RatioField

#: DXF in both versions, and SVG.
FORMS = ((DxfVersion.R2010, ".dxf"), (DxfVersion.R12, ".dxf"), (DxfVersion.R2010, ".svg"))
SMALLEST_GRID, LARGEST_GRID = 2, 8
#: Largest random logarithm of a ratio, and the widths of the sheets (mm).
SPREAD = 0.4
WIDTHS_MM = (150.0, 400.0)

#: Thin sheets with a kerf: connectors of thick ones have no room on the smaller sheets.
MATERIALS = ("film-uv", "card-co2", "foil-uv", "pet-co2")


@dataclass(frozen=True, slots=True)
class CutFileFigures:
    """What came of it.

    Attributes
    ----------
    designs, files, passed : int
        Designs planned, files written, files that both readers found as planned.
    refused : int
        Designs without room for their connectors; they give no files.
    failures : tuple of str
        The first bad finding of every file that did not pass.
    write_seconds, verify_seconds : float
        Median for one file.
    slots_length_ratio : (least, median, largest)
        Length of the contours of the slots profile to that of the centre lines.
    """

    designs: int
    files: int
    passed: int
    refused: int
    failures: tuple[str, ...]
    write_seconds: float
    verify_seconds: float
    slots_length_ratio: tuple[float, float, float]

    @property
    def ok(self) -> bool:
        """Whether every file passed."""
        return self.passed == self.files

    def sentences(self) -> list[str]:
        """The figures for the user."""
        low, middle, high = self.slots_length_ratio
        return [
            f"{self.passed} of {self.files} files of {self.designs} designs passed with two readers; {self.refused} "
            f"designs had no room for their connectors.",
            f"One file takes {self.write_seconds:.3f} s to write and {self.verify_seconds:.3f} s to verify (median).",
            f"As slots the cut is {low:.2f} to {high:.2f} times as long (median {middle:.2f}).",
            *self.failures,
        ]


def measure_cut_files(
    count: int,
    seed: int,
    report: Callable[[int, int], None] = lambda done, total: None,
    style: ConnectorStyle = ConnectorStyle.CENTRED,
) -> CutFileFigures:
    """Write and verify ``count`` random designs in every profile; ``report`` gets the designs done and their number."""
    passed, failures = 0, []
    writing: list[float] = []
    verifying: list[float] = []
    ratios: list[float] = []
    jobs = list(_jobs(count, seed, style))
    with tempfile.TemporaryDirectory() as folder:
        for number, job in enumerate(jobs):
            for profile in PROFILES:
                for version, extension in FORMS:
                    start = time.perf_counter()
                    made = replace(job, profile=profile, dxf_version=version)
                    path = export(made, Path(folder) / f"{profile}{extension}")
                    written = time.perf_counter()
                    found = verify_export(job.required_plan, path, profile, version)
                    writing.append(written - start)
                    verifying.append(time.perf_counter() - written)
                    if profile == "slots":
                        ratios.append(found.cut_length_mm / job.required_plan.cut_length_mm)
                    if found.ok:
                        passed += 1
                    else:
                        bad = next(finding.text for finding in found.findings if not finding.ok)
                        failures.append(f"Design {number}, {profile}, {version} {extension}: {bad}")
            report(number + 1, len(jobs))
    return CutFileFigures(
        designs=len(jobs),
        files=len(writing),
        passed=passed,
        refused=count - len(jobs),
        failures=tuple(failures),
        write_seconds=float(np.median(writing)),
        verify_seconds=float(np.median(verifying)),
        slots_length_ratio=(min(ratios), float(np.median(ratios)), max(ratios)),
    )


def _jobs(count: int, seed: int, style: ConnectorStyle) -> Iterator[ExportJob]:
    """Designs of random grids, ratios, widths and materials; those without room for connectors are left out."""
    materials = [presets()[key] for key in MATERIALS]
    for number in range(count):
        random = np.random.default_rng([seed, number])
        rows, columns = (int(side) for side in random.integers(SMALLEST_GRID, LARGEST_GRID + 1, 2))
        spread = float(random.uniform(0.0, SPREAD))
        design = deploy(RatioField.from_log10(random.uniform(-spread, spread, (rows, columns))))
        width = float(random.uniform(*WIDTHS_MM))
        try:
            plan = plan_cuts(design, width, material=materials[number % len(materials)], options=CutOptions(style))
        except KirigamiError:
            continue
        yield ExportJob(design, plan=plan)
