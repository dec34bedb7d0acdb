"""Shapes in every bundled material, as ``design --material`` makes them and otherwise."""

from __future__ import annotations

import hashlib
import math
from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import asdict, dataclass, field, replace
from itertools import product
from pathlib import Path

from kirigami_studio.evaluate.candidate import Candidate
from kirigami_studio.fabricate.machine import MachineKind, machine_of
from kirigami_studio.fabricate.material import Construction, Material, find_material, presets
from kirigami_studio.foundation.errors import ExportError, KirigamiError, UsageError
from kirigami_studio.foundation.files import read_at_most, write_atomically
from kirigami_studio.lab.benchmark.run_store import Key, Record, RunStore
from kirigami_studio.outlines.outline import Outline
from kirigami_studio.outlines.silhouettes import load
from kirigami_studio.settings.design import DesignSettings
from kirigami_studio.settings.fabrication import FabricationSettings, is_pinned, new_settings
from kirigami_studio.settings.layers import STIFF, note_before_run, stiffness
from kirigami_studio.studio.as_cut import AsCut
from kirigami_studio.studio.assembling import assembled
from kirigami_studio.studio.designing import completed, request_for, run_design
from kirigami_studio.studio.verdict import Level, Verdict, assess, judge_assembled

#: Shapes of the table, from easy to hard.
SHAPES = ("hexagon", "house", "heart", "star", "letter-l", "gear")
#: Of these, those that every material makes "ready to cut" in one construction and size at least.
NEEDED = frozenset(SHAPES) - {"letter-l"}
#: How a cell of the table says it.
MARKS = {Level.READY: "ready", Level.CARE: "care", Level.FAILS: "FAILS"}
#: Larger sheets that are tried where a usual one is not ready, as multiples of it, and the most of a bed's shorter side
#: that a sheet with its frame is wide.
LARGER, OF_BED = (1.5, 2.0), 0.85
#: Backed and pinned sheets are tried at this width (mm).
BOARD_MM = 300.0
#: Designs of a run unless asked otherwise: the best of these is tried at last.
USUAL_DESIGNS = DesignSettings().k
#: Lines in a Markdown file between which the table stands.
BEGIN, END = "<!-- table: benchmark presets -->", "<!-- end of the table -->"
LARGEST_DOCUMENT = 2**20
Report = Callable[[int, int], None]


@dataclass(frozen=True, slots=True)
class Making:
    """A construction, the width of the flat sheet, and the number of designs to choose from."""

    construction: Construction
    width_mm: float
    k: int


@dataclass(frozen=True, slots=True)
class PresetRun:
    """A shape that is designed in a material, made in some way."""

    material: Material
    shape: str
    making: Making
    seed: int

    @property
    def settings(self) -> FabricationSettings:
        """As ``design`` gets them."""
        making = self.making
        if making == usual_making(self.material, making.k):
            return new_settings({"material": self.material.key})
        chosen = {"construction": making.construction, "width_mm": making.width_mm}
        return new_settings({"material": self.material.key, **chosen})

    @property
    def key(self) -> Key:
        """By all that it depends on: another preset under the same name is another run."""
        preset = hashlib.sha256(repr(asdict(self.material)).encode()).hexdigest()[:12]
        making = self.making
        return (
            self.material.key,
            self.shape,
            making.construction.value,
            f"{making.width_mm:g}",
            making.k,
            self.seed,
            preset,
        )


@dataclass(frozen=True, slots=True)
class PresetSheet:
    """One shape in one material.

    Attributes
    ----------
    material, shape : str
    construction : str
    width_mm : float
        Of the flat sheet.
    k : int
        Number of designs that the best was taken of.
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
    construction: str = Construction.ONE_SHEET.value
    width_mm: float = math.nan
    k: int = 0
    codes: tuple[str, ...] = ()
    grid: tuple[int, int] = (0, 0)
    jam_deg: float = math.nan
    strain: float = math.nan
    strain_limit: float = math.nan
    figure: str = ""
    iou: float = math.nan
    iou_as_cut: float = math.nan

    @classmethod
    def of(cls, record: Record) -> PresetSheet:
        """From the record of a run; JSON has lists for tuples, and null for what is not finite."""
        values = {name: math.nan if value is None else value for name, value in record.items()}
        values |= {name: tuple(values[name]) for name in ("codes", "grid")}  # type: ignore[arg-type]
        return cls(**values)  # type: ignore[arg-type]

    def to_json(self) -> Record:
        """Plain values, null for what is not finite."""
        return {
            name: None if isinstance(value, float) and not math.isfinite(value) else value
            for name, value in asdict(self).items()
        }

    @property
    def works(self) -> bool:
        """Whether it is ready to cut, or cut with care."""
        return self.level != Level.FAILS.value

    @property
    def ready(self) -> bool:
        """Whether it is ready to cut."""
        return self.level == Level.READY.value

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
        As the preset makes them by itself.
    others : tuple of PresetSheet
        Made otherwise, where the first is not ready; the last one of a shape is, if any is.
    notes : mapping of str to str
        Sentences before a run, by key; other materials have none.
    """

    sheets: tuple[PresetSheet, ...]
    notes: dict[str, str]
    others: tuple[PresetSheet, ...] = field(default=())

    @property
    def ok(self) -> bool:
        """Whether all sheets work or were warned of, and no needed shape is a hole."""
        return not self.holes and all(sheet.works or sheet.material in self.notes for sheet in self.sheets)

    @property
    def holes(self) -> tuple[PresetSheet, ...]:
        """Sheets of needed shapes that no construction makes ready."""
        made = {(sheet.material, sheet.shape) for sheet in (*self.sheets, *self.others) if sheet.ready}
        return tuple(one for one in self.sheets if one.shape in NEEDED and (one.material, one.shape) not in made)

    def sentences(self) -> list[str]:
        """The table in Markdown, sentences before a run, and the holes."""
        said = [f"{key}: {note}" for key, note in self.notes.items()]
        holes = [f"not ready: {sheet.shape} in {sheet.material}: {', '.join(sheet.codes)}" for sheet in self.holes]
        return [*self.table, *said, *holes]

    @property
    def table(self) -> list[str]:
        """One row a material, in Markdown; cells end with the first construction that is ready."""
        shapes = list(dict.fromkeys(sheet.shape for sheet in self.sheets))
        rows: dict[str, dict[str, PresetSheet]] = {}
        for sheet in self.sheets:
            rows.setdefault(sheet.material, {})[sheet.shape] = sheet
        ready = {(sheet.material, sheet.shape): sheet for sheet in self.others if sheet.ready}
        return [
            f"| Material | made as | {' | '.join(shapes)} |",
            "|" + "---|" * (2 + len(shapes)),
            *(
                f"| `{key}` | {_usual(key)} | {' | '.join(_cell(row[one], ready.get((key, one))) for one in shapes)} |"
                for key, row in rows.items()
            ),
        ]


def _cell(usual: PresetSheet, ready: PresetSheet | None) -> str:
    if usual.ready or ready is None:
        return usual.cell
    if (ready.construction, ready.width_mm) == (usual.construction, usual.width_mm):
        return f"{ready.cell} (best of {ready.k})"
    return f"{usual.cell}; {ready.construction} {ready.width_mm:g} mm: {ready.cell}"


def _usual(key: str) -> str:
    material = find_material(key)
    made = f"{material.construction.value}, {material.sheet_mm:g} mm"
    if material.construction is not Construction.ONE_SHEET or material.backing:
        return made
    return f"{made}, connectors {material.connector_mm:g} mm, {material.style.value}"


def usual_making(material: Material, k: int) -> Making:
    """The construction and width that a material is made in unless others are asked for."""
    return Making(material.construction, material.sheet_mm, k)


def other_makings(material: Material, k: int) -> Iterator[Making]:
    """Ways of making sheets of a material that are tried where the usual one is not ready."""
    usual = usual_making(material, k)
    room = OF_BED * min(machine_of(material).reach_mm)
    width = min(max(material.sheet_mm, BOARD_MM), room)
    printed = MachineKind.of(material.machine) is MachineKind.PRINTER
    rigid = Construction.PRINTED if printed else Construction.PINNED
    if usual.construction is not rigid and stiffness(material) >= STIFF:
        yield Making(rigid, width, k)
    if usual.construction is not Construction.BACKED:
        yield Making(Construction.BACKED, width, k)
    yield from (replace(usual, width_mm=share * usual.width_mm) for share in LARGER if share * usual.width_mm <= room)
    if k < USUAL_DESIGNS:
        yield replace(usual, k=USUAL_DESIGNS)


def measure_presets(
    materials: Sequence[str] = (),
    shapes: Sequence[str] = (),
    k: int = 32,
    seed: int = 0,
    runs: str | None = None,
    into: str | None = None,
    report: Report = lambda done, total: None,
) -> PresetFigures:
    """Design every shape in every material as usual, and otherwise where that is not ready.

    Parameters
    ----------
    materials : sequence of str
        Keys; all bundled ones without any.
    shapes : sequence of str
        Silhouettes of the library; :data:`SHAPES` without any.
    k, seed : int
        Number of designs, of which the best is judged, and their random seed.
    runs : str, optional
        File of finished runs: what it has is not done again.
    into : str, optional
        Markdown file whose table is written anew, between :data:`BEGIN` and :data:`END`.
    report : callable
        Gets the usual sheets done and their number.

    Raises
    ------
    UsageError
        An unknown material.
    ExportError
        A Markdown file without a place for the table, or a file that cannot be written.
    """
    known = presets()
    if unknown := [key for key in materials if key not in known]:
        raise UsageError("material.unknown", name=unknown[0], known=", ".join(known))
    keys = list(materials) or list(known)
    if into is not None:
        _parts_around(Path(into))
    asked = list(product(keys, list(shapes) or SHAPES))
    usual: list[PresetSheet] = []
    others: list[PresetSheet] = []
    with RunStore.opened({"suite": "presets"}, None if runs is None else Path(runs)) as store:
        for key, shape in asked:
            usual.append(_kept(PresetRun(known[key], shape, usual_making(known[key], k), seed), store))
            report(len(usual), len(asked))
        for sheet in usual:
            if not sheet.ready and sheet.shape in NEEDED:
                material = known[sheet.material]
                ways = (PresetRun(material, sheet.shape, making, seed) for making in other_makings(material, k))
                others += _until_ready(ways, store)
    said = {key: note_before_run(new_settings({"material": key})) for key in keys}
    notes = {key: note.text for key, note in said.items() if note is not None}
    figures = PresetFigures(tuple(usual), notes, tuple(others))
    if into is not None:
        before, after = _parts_around(Path(into))
        write_atomically(Path(into), "\n".join([before + BEGIN, "", *figures.table, "", END + after]).encode())
    return figures


def _parts_around(path: Path) -> tuple[str, str]:
    """Texts before and after the table of a Markdown file.

    Raises
    ------
    ExportError
        It cannot be read, or has no place for one.
    """
    try:
        text = read_at_most(path, LARGEST_DOCUMENT).decode()
    except (OSError, ValueError) as error:
        raise ExportError("file.not_written", path=path, reason=str(error)) from error
    before, begin, rest = text.partition(BEGIN)
    _, end, after = rest.partition(END)
    if not begin or not end:
        raise ExportError("file.not_written", path=path, reason=f"it has no lines {BEGIN} and {END}")
    return before, after


def _until_ready(ways: Iterable[PresetRun], store: RunStore) -> Iterator[PresetSheet]:
    for way in ways:
        sheet = _kept(way, store)
        yield sheet
        if sheet.ready:
            return


def _kept(run: PresetRun, store: RunStore) -> PresetSheet:
    if run.key not in store.records:
        store.add(run.key, judged_preset(run).to_json())
    return PresetSheet.of(store.records[run.key])


def judged_preset(run: PresetRun) -> PresetSheet:
    """Judge the best design of a shape in a material."""
    target, settings, making = load(run.shape), run.settings, run.making
    named = run.material.key, run.shape
    made = making.construction.value, making.width_mm, making.k
    wanted = DesignSettings(k=making.k, seed=run.seed)
    best = completed(run_design(request_for(target, wanted, settings), settings), lambda _: None).best
    try:
        found = _judged(best, settings, target)
    except KirigamiError as error:
        return PresetSheet(*named, Level.FAILS.value, *made, (error.code,), best.sheet.grid)
    codes = tuple(problem.code for problem in found.problems)
    sheet = PresetSheet(*named, found.level.value, *made, codes, best.sheet.grid)
    return sheet if found.as_cut is None else _with_figures(sheet, found.as_cut)


def _judged(best: Candidate, settings: FabricationSettings, target: Outline) -> Verdict:
    if is_pinned(settings):
        return judge_assembled(best, assembled(best, settings, target), settings)
    return assess(best, settings, target).verdict


def _with_figures(sheet: PresetSheet, as_cut: AsCut) -> PresetSheet:
    judged = as_cut.survival
    return replace(
        sheet,
        jam_deg=math.degrees(as_cut.jam_phi),
        strain=judged.strain,
        strain_limit=judged.limit,
        figure=judged.figure.value,
        iou=math.nan if as_cut.ideal_iou is None else as_cut.ideal_iou,
        iou_as_cut=math.nan if as_cut.iou is None else as_cut.iou,
    )
