"""Shapes in every bundled material, as ``design --material`` makes them at its usual size."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from itertools import product

from kirigami_studio.evaluate.candidate import Candidate
from kirigami_studio.fabricate.material import Material, find_material, presets
from kirigami_studio.foundation.errors import KirigamiError, UsageError
from kirigami_studio.outlines.outline import Outline
from kirigami_studio.outlines.silhouettes import load
from kirigami_studio.settings.design import DesignSettings
from kirigami_studio.settings.fabrication import FabricationSettings, is_pinned, new_settings
from kirigami_studio.studio.as_cut import AsCut
from kirigami_studio.studio.assembling import assembled
from kirigami_studio.studio.designing import completed, request_for, run_design
from kirigami_studio.studio.verdict import Level, Verdict, assess, judge_assembled

#: Shapes of the table, from easy to hard.
SHAPES = ("hexagon", "house", "heart", "star", "letter-l", "gear")
#: How a cell of the table says it.
MARKS = {Level.READY: "ready", Level.CARE: "care", Level.FAILS: "FAILS"}
Report = Callable[[int, int], None]


@dataclass(frozen=True, slots=True)
class PresetSheet:
    """One shape in one material.

    Attributes
    ----------
    material, shape : str
    level : str
        Of the verdict, in words of JSON.
    codes : tuple of str
        Problems, worst first.
    grid : (rows, columns)
    jam_deg : float
        0 where it closes; not a number where nobody could close it.
    strain, strain_limit : float
        Of the connector nearest to breaking.
    figure : str
        Which of the two figures that is.
    iou, iou_as_cut : float
        Exact, of the design, and of the sheet where it comes to.
    """

    material: str
    shape: str
    level: str
    codes: tuple[str, ...] = ()
    grid: tuple[int, int] = (0, 0)
    jam_deg: float = math.nan
    strain: float = math.nan
    strain_limit: float = math.nan
    figure: str = ""
    iou: float = math.nan
    iou_as_cut: float = math.nan

    @property
    def works(self) -> bool:
        """Whether it is ready to cut, or cut with care."""
        return self.level != Level.FAILS.value

    @property
    def cell(self) -> str:
        """As a cell of the table."""
        mark = MARKS[Level(self.level)]
        return mark if math.isnan(self.iou_as_cut) else f"{mark}, {100.0 * self.iou_as_cut:.1f} %"


@dataclass(frozen=True, slots=True)
class PresetFigures:
    """The table.

    Attributes
    ----------
    sheets : tuple of PresetSheet
    notes : mapping of str to str
        What materials say before a run, by key; others have none.
    """

    sheets: tuple[PresetSheet, ...]
    notes: dict[str, str]

    @property
    def ok(self) -> bool:
        """Whether every sheet works, or its material said before the run which construction would."""
        return all(sheet.works or sheet.material in self.notes for sheet in self.sheets)

    def sentences(self) -> list[str]:
        """The table, one row a material, in Markdown; then what materials say before a run."""
        shapes = list(dict.fromkeys(sheet.shape for sheet in self.sheets))
        keys = list(dict.fromkeys(sheet.material for sheet in self.sheets))
        cells = {(sheet.material, sheet.shape): sheet.cell for sheet in self.sheets}
        said = [f"{key}: {note}" for key, note in self.notes.items()]
        return [
            f"| Material | connector, width, style | {' | '.join(shapes)} |",
            "|" + "---|" * (2 + len(shapes)),
            *(f"| `{key}` | {_usual(key)} | {' | '.join(cells[key, shape] for shape in shapes)} |" for key in keys),
            *said,
        ]


def _usual(key: str) -> str:
    material = find_material(key)
    return f"{material.connector_mm:g} mm, {material.sheet_mm:g} mm, {material.style.value}"


def measure_presets(
    materials: Sequence[str] = (),
    shapes: Sequence[str] = (),
    k: int = 32,
    seed: int = 0,
    report: Report = lambda done, total: None,
) -> PresetFigures:
    """Design every shape in every material at its usual size, and judge the best.

    Parameters
    ----------
    materials : sequence of str
        Keys; all bundled ones without any.
    shapes : sequence of str
        Silhouettes of the library; :data:`SHAPES` without any.
    k, seed : int
        Number of designs, of which the best is judged, and their random seed.
    report : callable
        Gets the sheets done and their number.

    Raises
    ------
    UsageError
        An unknown material.
    """
    known = presets()
    if unknown := [key for key in materials if key not in known]:
        raise UsageError("material.unknown", name=unknown[0], known=", ".join(known))
    keys = list(materials) or list(known)
    sheets: list[PresetSheet] = []
    wanted = list(shapes) or SHAPES
    for key, shape in product(keys, wanted):
        sheets.append(judged_preset(known[key], shape, k, seed))
        report(len(sheets), len(keys) * len(wanted))
    notes = {key: note.text for key in keys if (note := known[key].limits_note) is not None}
    return PresetFigures(tuple(sheets), notes)


def judged_preset(material: Material, shape: str, k: int, seed: int = 0) -> PresetSheet:
    """Judge the best design of a shape in the construction that suits a material."""
    target, settings = load(shape), new_settings({"material": material.key})
    wanted = DesignSettings(k=k, seed=seed)
    best = completed(run_design(request_for(target, wanted, settings), settings), lambda _: None).best
    try:
        found = _judged(best, settings, target)
    except KirigamiError as error:
        return PresetSheet(material.key, shape, Level.FAILS.value, (error.code,), best.sheet.grid)
    codes = tuple(problem.code for problem in found.problems)
    sheet = PresetSheet(material.key, shape, found.level.value, codes, best.sheet.grid)
    return sheet if found.as_cut is None else _with_figures(sheet, found.as_cut)


def _judged(best: Candidate, settings: FabricationSettings, target: Outline) -> Verdict:
    if is_pinned(settings):
        return judge_assembled(best, assembled(best, settings, target), settings)
    return assess(best, settings, target).verdict


def _with_figures(sheet: PresetSheet, as_cut: AsCut) -> PresetSheet:
    judged = as_cut.survival
    return PresetSheet(
        sheet.material,
        sheet.shape,
        sheet.level,
        sheet.codes,
        sheet.grid,
        math.degrees(as_cut.jam_phi),
        judged.strain,
        judged.limit,
        judged.figure.value,
        math.nan if as_cut.ideal_iou is None else as_cut.ideal_iou,
        math.nan if as_cut.iou is None else as_cut.iou,
    )
