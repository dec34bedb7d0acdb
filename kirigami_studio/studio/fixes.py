"""Fixes for a sheet that is not ready to cut: changes that were tried on this very design and found to work.

Styles, connector widths, sheet widths, other designs, coarser grids, combinations and other materials are tried, small
changes first.
Each is planned and checked; what passes is closed on its connectors and judged.  Fast estimates leave out at once what
would jam or break.
"""

from __future__ import annotations

import math
from collections.abc import Generator, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from itertools import product
from types import MappingProxyType

from kirigami_studio.evaluate.candidate import Candidate
from kirigami_studio.fabricate.fastener import SIZES, Fastener
from kirigami_studio.fabricate.findings import Note, Problem
from kirigami_studio.fabricate.machine import cuttable
from kirigami_studio.fabricate.material import Material, library
from kirigami_studio.fabricate.options import ConnectorStyle
from kirigami_studio.fabricate.strain import StrainFigure
from kirigami_studio.foundation.errors import KirigamiError, UsageError
from kirigami_studio.foundation.steps import never
from kirigami_studio.foundation.words import tr
from kirigami_studio.lattice.deployment import Deployment, deploy
from kirigami_studio.outlines.outline import Outline
from kirigami_studio.pipeline.rank import Ranking
from kirigami_studio.pipeline.request import Request
from kirigami_studio.project import edits
from kirigami_studio.project.document import Document
from kirigami_studio.project.edits import Edit
from kirigami_studio.settings.design import POLISH_STEPS
from kirigami_studio.settings.fabrication import (
    FabricationSettings,
    PinSizes,
    is_pinned,
    is_printed,
    machine_for,
    named_machine,
    pin_sizes,
)
from kirigami_studio.settings.layers import hinge_layer, sheet_material
from kirigami_studio.studio.as_cut import ESTIMATE_CLOSES, AsCut, all_break, estimate
from kirigami_studio.studio.assembling import assembled
from kirigami_studio.studio.backing import checked_plan
from kirigami_studio.studio.cutting import plan_of
from kirigami_studio.studio.verdict import TOO_SMALL, Level, Verdict, closed_as_cut, judge, judge_assembled

#: Fixes that are offered at most.
MOST_FIXES = 3
#: Changes of one kind that are planned, and of these closed on their connectors, at most.
MOST_PLANNED, MOST_CLOSED = 16, 6
#: Changes that are tried at most although the sheet is estimated to jam, and materials that are offered.
MOST_JAMMING, MOST_MATERIALS = 6, 2
#: Other designs that are tried at most.
MOST_DESIGNS = 4
#: Connector and sheet widths that are tried, as multiples of the present ones.
CONNECTORS, WIDTHS = (0.5, 0.75, 1.5, 2.0, 3.0), (1.25, 1.5, 2.0, 3.0)
#: Changes of a pinned design whose pieces are made, at most; ears that are tried, as shares of their walls, the least
#: wall (mm, both sides), and the least clearance (mm).
MOST_ASSEMBLED, EARS, LEAST_EAR_MM, LEAST_CLEARANCE_MM = 12, (0.75, 0.5), 2.0, 0.3
#: Larger sheets than a problem asks for, so that rounding spoils nothing.
ROUNDED_UP = 1.02
#: Problems of sheets whose panels leave connectors no room: a coarser grid has larger ones.
CROWDED = frozenset({"slit.no_room", "edge_cut.no_room", "plan.connectors_narrowed"}) | TOO_SMALL
#: Styles that are tried together with widths.
COMBINED = (ConnectorStyle.CENTRED, ConnectorStyle.DOUBLE, ConnectorStyle.ARC)
#: Sheets wider than this (mm) are not tried where the machine's bed is not known.
WIDEST_MM = 1000.0
#: Fewer voids each way, one grid after the other: by two, so that a grid keeps the symmetries that its parities allow.
FEWER_VOIDS = (2, 4)
#: Coarser grids than this are not tried.
LEAST_VOIDS = 4
#: Designs of a coarser grid: a quarter of them are fits from the uniform sheet.
COARSER_DESIGNS = 12
#: A coarser design that matches by more than this less than the one in its place is not worth offering.
MOST_MATCH_LOST = 0.03


@dataclass(frozen=True, slots=True, eq=False)
class Fix:
    """A change that was tried and that helps."""

    change: Note  #: What to do, in a sentence
    candidate: Candidate  #: The design that is then cut
    settings: FabricationSettings  #: How it is then cut
    verdict: Verdict  #: What is then to be expected
    as_cut: AsCut
    #: Designs on another grid, best first, that take the place of all there are; empty where those stay
    instead: tuple[Candidate, ...] = ()
    solves: tuple[str, ...] = ()  #: Codes of the problems that are then gone

    @property
    def line(self) -> str:
        """The change, and the verdict that it leads to."""
        return Note.of("fix.then", change=self.change.text, level=self.verdict.level_words).text

    def edit(self, document: Document) -> Edit:
        """Make the change, as one step that can be undone; a design that is gone leaves the choice as it is."""
        label = self.change.text.rstrip(".")
        if self.instead:
            return replace(edits.set_candidates(document, self.instead, document.provenance), label=label)
        if self.candidate != document.candidate and self.candidate in document.candidates:
            return replace(edits.choose(document, document.candidates.index(self.candidate)), label=label)
        profile, version = document.fabrication.profile, document.fabrication.dxf_version
        fabrication = replace(self.settings, profile=profile, dxf_version=version)
        if fabrication.width_mm != document.fabrication.width_mm:  # it is what the fix is about, and stays
            fabrication = replace(fabrication, opened_mm=None)
        return Edit(label, replace(document, fabrication=fabrication))

    def to_json(self) -> dict[str, object]:
        """For the command line."""
        settings = self.settings
        return {
            "text": self.change.text,
            "code": self.change.code,
            "level": self.verdict.level.value,
            "problems": [problem.text for problem in self.verdict.problems],
            "style": settings.options.style.value,
            "connector_mm": settings.connector_mm,
            "width_mm": settings.width_mm,
            "material": settings.material,
            "grid": list(self.candidate.sheet.grid),
            "max_strain": self.as_cut.strain,
            **self._pins_json(),
            "solves": list(self.solves),
        }

    def _pins_json(self) -> dict[str, object]:
        """Pins and ears of a pinned design."""
        if not is_pinned(self.settings):
            return {}
        sizes = _sizes(self.settings)
        sized = {"ear_mm": sizes.ear_mm, "clearance_mm": sizes.clearance_mm}
        return {"fastener": self.settings.fastener.value, **sized}


@dataclass(frozen=True, slots=True, eq=False)
class Advice:
    """What was found."""

    fixes: tuple[Fix, ...]  #: The best first; empty where nothing that was tried works
    tried: Note  #: What was tried, in a sentence

    @property
    def lines(self) -> tuple[str, ...]:
        """As it is shown: every fix with what is then to be expected, or that nothing works."""
        if not self.fixes:
            return (self.tried.text,)
        return tuple(fix.line for fix in self.fixes)

    def lines_for(self, verdict: Verdict) -> tuple[str, ...]:
        """A verdict with fixes: each below the worst problem that it solves, others at the end."""
        told: list[str] = [verdict.words]
        left = list(self.fixes)
        for problem in verdict.problems:
            told.append(problem.text)
            told += [fix.line for fix in left if problem.code in fix.solves]
            left = [fix for fix in left if problem.code not in fix.solves]
        rest = [fix.line for fix in left] if self.fixes else [self.tried.text]
        return (*told, *rest, verdict.summary, *(note.text for note in verdict.notes))


@dataclass(frozen=True, slots=True, eq=False)
class _Change:
    """Something to try."""

    note: Note
    candidate: Candidate
    settings: FabricationSettings
    instead: tuple[Candidate, ...] = ()


def find_fixes(
    candidate: Candidate,
    settings: FabricationSettings,
    verdict: Verdict,
    others: Mapping[str, Candidate] = MappingProxyType({}),
    coarser: Iterable[tuple[Candidate, ...]] = (),
    target: Outline | None = None,
) -> Generator[None, None, Advice]:
    """Look for changes that help; yields between them, for others to have their turn.

    Parameters
    ----------
    candidate : Candidate
        The design.
    settings : FabricationSettings
        How it is cut.
    verdict : Verdict
        On that; a change helps if it leads to a better one.
    others : mapping of str to Candidate
        Other designs of the document by their names, best first.
    coarser : iterable of tuple of Candidate
        Designs for the same target on coarser grids, best first; made when they are asked for.
    target : Outline, optional
        For the match as cut.

    Raises
    ------
    FabricationError
        No such material.
    """
    search = _Search(verdict, sheet_material(settings), target)
    if not candidate.score.feasible and candidate.trim is None:
        # However it is cut, its panels overlap.
        yield from search.try_all(_other_designs(candidate, settings, others), MOST_FIXES)
        return search.advice()
    single = _single_changes(candidate, settings, search.material, verdict)
    grids = _coarser_grids(candidate, settings, coarser)
    if any(problem.code in CROWDED for problem in verdict.problems):
        yield from search.try_all(single, MOST_FIXES - 1)
        yield from search.try_all(grids, MOST_FIXES)
    else:
        yield from search.try_all(single, MOST_FIXES)
    for changes in (
        _other_designs(candidate, settings, others),
        grids,
        _combinations(candidate, settings, search.material),
    ):
        if search.ready:
            return search.advice()
        yield from search.try_all(changes, MOST_FIXES)
    if search.ready:
        return search.advice()
    yield from search.try_jamming()
    yield from search.try_all(_other_materials(candidate, settings), MOST_MATERIALS)
    return search.advice()


@dataclass(slots=True, eq=False)
class _Search:
    """What was tried so far."""

    verdict: Verdict
    material: Material
    target: Outline | None
    found: list[Fix] = field(default_factory=list)
    jamming: list[_Change] = field(default_factory=list)
    seen: list[tuple[Candidate, FabricationSettings]] = field(default_factory=list)
    kinds: set[str] = field(default_factory=set)  #: of change, of which one works: no further one is tried
    planned: int = 0
    closed: int = 0

    @property
    def ready(self) -> list[Fix]:
        """Fixes after which the sheet is ready to cut."""
        return [fix for fix in self.found if fix.verdict.ok]

    def advice(self) -> Advice:
        """The best that were found."""
        fixes = sorted(self.found, key=lambda fix: not fix.verdict.ok)[:MOST_FIXES]
        cuts = [settings for _, settings in self.seen]
        connectors = [self._connector_mm(settings) for settings in cuts] or [0.0]
        widths = [settings.width_mm for settings in cuts] or [0.0]
        tried = Note.of(
            "fix.none",
            count=len(self.seen),
            styles=len({settings.options.style for settings in cuts}),
            narrowest_mm=min(connectors),
            widest_mm=max(connectors),
            least_mm=min(widths),
            largest_mm=max(widths),
            materials=len({settings.material for settings in cuts} - {self.material.key}),
        )
        return Advice(tuple(fixes), tried)

    def _connector_mm(self, settings: FabricationSettings) -> float:
        return sheet_material(settings).connector_mm if settings.connector_mm is None else settings.connector_mm

    def try_all(self, changes: Iterable[_Change], enough: int) -> Generator[None, None, None]:
        """Try changes in order, until enough of them work or too many were planned."""
        most_planned, most_closed = self.planned + MOST_PLANNED, self.closed + MOST_CLOSED
        for change in changes:
            if len(self.ready) >= enough or self.planned >= most_planned or self.closed >= most_closed:
                return
            made = (change.candidate, change.settings)
            if made in self.seen or change.note.code in self.kinds:
                continue
            self.seen.append(made)
            yield
            motion = deploy(change.candidate.final_sheet)
            if not self._hopeless(change, motion):
                yield from self._try(change, motion)

    def try_jamming(self) -> Generator[None, None, None]:
        """Try changes of thin sheets that are estimated to jam, for one that is better than what there is."""
        for change in self.jamming[:MOST_JAMMING]:
            if self.found:
                return
            yield from self._try(change, deploy(change.candidate.final_sheet))

    def _try(self, change: _Change, motion: Deployment) -> Generator[None, None, None]:
        candidate, settings = change.candidate, change.settings
        self.planned += 1
        try:
            plan = plan_of(candidate, settings, motion)
            yield
            report, _ = checked_plan(candidate, plan, motion, settings)
        except KirigamiError:
            return
        if not judge(candidate, plan, report, None).better_than(self.verdict):
            return
        yield
        self.closed += 1
        as_cut = closed_as_cut(candidate, motion, plan, settings.width_mm, self.target)
        after = judge(candidate, plan, report, as_cut)
        if isinstance(as_cut, AsCut) and after.better_than(self.verdict):
            if after.ok and change.note.code != "fix.material":
                self.kinds.add(change.note.code)
            note = _told(change.note, self.verdict, as_cut)
            left = {problem.code for problem in after.problems}
            solves = tuple(problem.code for problem in self.verdict.problems if problem.code not in left)
            self.found.append(Fix(note, candidate, settings, after, as_cut, change.instead, solves))

    def _hopeless(self, change: _Change, motion: Deployment) -> bool:
        """Whether its connectors break or the sheet jams, as estimated; thin sheets that jam are kept for later."""
        settings, phi = change.settings, change.candidate.final_phi
        try:
            material = sheet_material(settings)
            if all_break(motion, settings, phi, material):
                return True
            found = estimate(motion, settings, phi, material)
        except KirigamiError:
            return True
        if found.jam_phi <= found.phi + ESTIMATE_CLOSES:
            return False
        if self.verdict.level is Level.FAILS and found.figure is StrainFigure.OUT_OF_PLANE:
            self.jamming.append(change)
        return True


def _told(note: Note, verdict: Verdict, as_cut: AsCut) -> Note:
    """The change with the strain that it leads to, where strain is what is wrong."""
    codes = {problem.code for problem in verdict.problems}
    if "as_cut.breaks" not in codes or note.code in ("fix.design", "fix.grid", "fix.material"):
        return note
    return Note.of("fix.strain", change=note.text.rstrip("."), strain_percent=100.0 * as_cut.strain)


# pieces on pins -------------------------------------------------------------------------------------------------------


def find_piece_fixes(
    candidate: Candidate,
    settings: FabricationSettings,
    verdict: Verdict,
    target: Outline,
    others: Mapping[str, Candidate] = MappingProxyType({}),
    coarser: Iterable[tuple[Candidate, ...]] = (),
) -> Generator[None, None, Advice]:
    """Look for changes that help a pinned design; takes what :func:`find_fixes` takes.

    The pieces of every change are made and checked: its verdict is that of the stage.
    """
    found: list[Fix] = []
    seen: list[tuple[Candidate, FabricationSettings]] = [(candidate, settings)]
    helped: set[str] = set()  # kinds of change of which one works: no further one is tried
    for changes in (
        _piece_changes(candidate, settings, verdict),
        _other_designs(candidate, settings, others),
        _piece_combinations(candidate, settings),
        _coarser_grids(candidate, settings, coarser),
    ):
        for change in changes:
            if len(found) >= MOST_FIXES or len(seen) > MOST_ASSEMBLED:
                break
            if change.note.code in helped or (change.candidate, change.settings) in seen:
                continue
            seen.append((change.candidate, change.settings))
            yield
            try:
                made = assembled(change.candidate, change.settings, target)
            except KirigamiError:
                continue
            after = judge_assembled(change.candidate, made, change.settings)
            if not after.better_than(verdict):
                continue
            if after.ok:
                helped.add(change.note.code)
            left = {problem.code for problem in after.problems}
            solves = tuple(problem.code for problem in verdict.problems if problem.code not in left)
            found.append(
                Fix(change.note, change.candidate, change.settings, after, made.as_cut, change.instead, solves)
            )
        if any(fix.verdict.ok for fix in found):
            break
    cuts = [cut for _, cut in seen[1:]] or [settings]
    ears = [_sizes(cut).ear_mm for cut in cuts]
    tried = Note.of(
        "fix.none_of_pieces",
        count=len(seen) - 1,
        least_mm=min(cut.width_mm for cut in cuts),
        largest_mm=max(cut.width_mm for cut in cuts),
        smallest_ear_mm=min(ears),
        largest_ear_mm=max(ears),
    )
    return Advice(tuple(sorted(found, key=lambda fix: not fix.verdict.ok)), tried)


def _piece_changes(candidate: Candidate, settings: FabricationSettings, verdict: Verdict) -> Iterator[_Change]:
    """Changes of one thing: smaller ears, other pins, less clearance, larger sheets."""
    sizes = _sizes(settings)
    if settings.ear_mm is not None and settings.ear_mm <= sizes.hole_mm:
        yield _Change(Note.of("fix.ear", ear_mm=sizes.ear_mm), candidate, replace(settings, ear_mm=None))
    for share in EARS:
        ear = round(sizes.hole_mm + share * (sizes.ear_mm - sizes.hole_mm), 1)
        if ear > max(sizes.neck_mm, sizes.hole_mm + LEAST_EAR_MM) and ear < sizes.ear_mm:
            yield _Change(Note.of("fix.ear", ear_mm=ear), candidate, replace(settings, ear_mm=ear))
    for fastener in _smaller_pins(settings):
        note = Note.of("fix.fastener", fastener=tr(SIZES[fastener].name))
        yield _Change(note, candidate, _with_pins(settings, fastener))
    if sizes.clearance_mm > LEAST_CLEARANCE_MM:
        note = Note.of("fix.clearance", clearance_mm=LEAST_CLEARANCE_MM)
        yield _Change(note, candidate, replace(settings, clearance_mm=LEAST_CLEARANCE_MM))
    for width in _needed_widths(verdict, settings):
        if width <= WIDEST_MM:
            yield _Change(Note.of("fix.width", width_mm=width), candidate, _with(settings, width_mm=width))


def _sizes(settings: FabricationSettings) -> PinSizes:
    """Measures of the pins; those of their fastener where the ear has no room for its hole."""
    try:
        return pin_sizes(settings)
    except UsageError:
        return pin_sizes(replace(settings, ear_mm=None))


def _needed_widths(verdict: Verdict, settings: FabricationSettings) -> list[float]:
    """Widths (mm) of larger sheets: as problems ask for them, then multiples of the present one."""
    numbers = [
        {name: float(value) for name, value in problem.fields.items() if isinstance(value, int | float)}
        for problem in verdict.problems
    ]
    needs = [(one["needed_mm"], one["gap_mm"]) for one in numbers if {"needed_mm", "gap_mm"} <= one.keys()]
    times = [needed / gap * ROUNDED_UP for needed, gap in needs if gap > 0.0]
    return [math.ceil(settings.width_mm * one) for one in (*times, *WIDTHS) if one > 1.0]


def _smaller_pins(settings: FabricationSettings) -> list[Fastener]:
    """Other pins with smaller holes or heads, the largest first; none where pins are printed."""
    if is_printed(settings):
        return []
    present = SIZES[settings.fastener]
    smaller = [
        fastener
        for fastener, size in SIZES.items()
        if size.hole_mm <= present.hole_mm and size.head_mm <= present.head_mm and size != present
    ]
    return sorted(smaller, key=lambda fastener: (-SIZES[fastener].hole_mm, -SIZES[fastener].head_mm))


def _with_pins(settings: FabricationSettings, fastener: Fastener) -> FabricationSettings:
    """The settings with other pins, whose holes and ears are their own."""
    return replace(settings, fastener=fastener, pin_mm=None, ear_mm=None)


def _piece_combinations(candidate: Candidate, settings: FabricationSettings) -> Iterator[_Change]:
    """Larger sheets with the smallest pins."""
    smaller = _smaller_pins(settings)
    pins = smaller[-1] if smaller else settings.fastener
    for times in WIDTHS:
        width = math.ceil(settings.width_mm * times)
        if smaller and width <= WIDEST_MM:
            note = Note.of("fix.pins_combined", fastener=tr(SIZES[pins].name), width_mm=width)
            yield _Change(note, candidate, _with(_with_pins(settings, pins), width_mm=width))


# what is tried --------------------------------------------------------------------------------------------------------


def _single_changes(
    candidate: Candidate, settings: FabricationSettings, material: Material, verdict: Verdict
) -> Iterator[_Change]:
    """Changes of one thing, those that the problems name themselves first."""
    options = settings.options
    if options.removed:
        whole = replace(settings, options=replace(options, removed=()))
        yield _Change(Note.of("fix.removed"), candidate, whole)
    if options.hinge_mm:
        even = replace(settings, options=replace(options, hinge_mm=()))
        yield _Change(Note.of("fix.hinges"), candidate, even)
    named = [width for problem in verdict.problems for width in _named_widths(problem, settings, material)]
    for width in named:
        yield from _wider(candidate, settings, width)
    for style in _styles(material, settings):
        yield _Change(Note.of("fix.style", style=style.value), candidate, _with(settings, style=style))
    for connector in _connectors(material, settings, CONNECTORS):
        note = Note.of("fix.connector", connector_mm=connector)
        yield _Change(note, candidate, _with(settings, connector_mm=connector))
    for times in WIDTHS:
        yield from _wider(candidate, settings, settings.width_mm * times)


def _named_widths(problem: Problem, settings: FabricationSettings, material: Material) -> list[float]:
    """Sheet widths (mm) that a problem's numbers lead to."""
    values = {name: float(value) for name, value in problem.fields.items() if isinstance(value, int | float)}
    width = settings.width_mm
    kerf = material.kerf_mm if settings.kerf_mm is None else settings.kerf_mm
    if "times" in values:
        return [width * values["times"], 1.1 * width * values["times"]]
    if {"size_mm", "least_mm"} <= values.keys() and values["size_mm"] > 0.0:
        return [width * (values["least_mm"] + kerf) / (values["size_mm"] + kerf)]
    if "largest_mm" in values:
        return [0.999 * values["largest_mm"]]
    return []


def _wider(candidate: Candidate, settings: FabricationSettings, width_mm: float) -> Iterator[_Change]:
    """Another width of the sheet, rounded up to a tenth of a millimetre, if the machine can reach it."""
    width = math.ceil(10.0 * width_mm - 1e-6) / 10.0
    if width <= max(_widest(settings), settings.width_mm):
        yield _Change(Note.of("fix.width", width_mm=width), candidate, _with(settings, width_mm=width))


def _widest(settings: FabricationSettings) -> float:
    return max(machine_for(hinge_layer(settings)).reach_mm) or WIDEST_MM


def _styles(material: Material, settings: FabricationSettings) -> list[ConnectorStyle]:
    rounded = (ConnectorStyle.ROUND, ConnectorStyle.TEARDROP) if material.relief_radius_mm > 0.0 else ()
    styles = (*COMBINED, ConnectorStyle.STRAIGHT, *rounded)
    return [style for style in styles if style is not settings.options.style]


def _connectors(material: Material, settings: FabricationSettings, multiples: Sequence[float]) -> list[float]:
    """Widths (mm, to a hundredth) of connectors to try: the material's own, its least one, multiples of the present."""
    present = material.connector_mm if settings.connector_mm is None else settings.connector_mm
    tried = [material.connector_mm, material.min_ligament_mm, *(present * times for times in multiples)]
    widths = [round(width, 2) for width in tried if round(width, 2) >= material.min_ligament_mm]
    return [width for width in dict.fromkeys(widths) if width != round(present, 2)]


def _other_designs(
    candidate: Candidate, settings: FabricationSettings, others: Mapping[str, Candidate]
) -> Iterator[_Change]:
    """Other designs of the document, best first."""
    hopeful = [(name, one) for name, one in others.items() if one.score.feasible and one != candidate]
    for name, one in hopeful[:MOST_DESIGNS]:
        yield _Change(Note.of("fix.design", name=name), one, settings)


def _coarser_grids(
    candidate: Candidate, settings: FabricationSettings, coarser: Iterable[tuple[Candidate, ...]]
) -> Iterator[_Change]:
    """Coarser grids, without choices for single connectors; a trimmed design has no counterpart there."""
    if candidate.trim is not None:
        return
    there = replace(settings, options=replace(settings.options, hinge_mm=(), removed=()))
    for designs in coarser:
        rows, columns = designs[0].sheet.grid
        match = 100.0 * designs[0].score.iou_exact
        note = Note.of("fix.grid", rows=rows, columns=columns, match_percent=match)
        yield _Change(note, designs[0], there, designs)


def _combinations(candidate: Candidate, settings: FabricationSettings, material: Material) -> Iterator[_Change]:
    """Style, connector and sheet width together."""
    connectors = _connectors(material, settings, (1.0, 2.0)) or [material.connector_mm]
    widths = [round(settings.width_mm * times, 1) for times in (1.0, 1.5, 2.0, 3.0)]
    for width, style, connector in product(widths, COMBINED, connectors):
        if width <= max(_widest(settings), settings.width_mm):
            note = Note.of("fix.combined", style=style.value, connector_mm=connector, width_mm=width)
            yield _Change(note, candidate, _with(settings, style=style, connector_mm=connector, width_mm=width))


def _other_materials(candidate: Candidate, settings: FabricationSettings) -> Iterator[_Change]:
    """All other materials with centred connectors; of a chosen machine, those that it cuts."""
    machine = named_machine(settings)
    for key, material in (library().items if machine is None else cuttable(machine)).items():
        if key != settings.material and material.limits_note is None:
            options = replace(settings.options, style=ConnectorStyle.CENTRED, hinge_mm=(), removed=())
            other = replace(
                settings, material=key, construction=None, connector_mm=None, kerf_mm=None, options=options, own=None
            )
            yield _Change(Note.of("fix.material", material=material.name), candidate, other)


def _with(
    settings: FabricationSettings,
    style: ConnectorStyle | None = None,
    connector_mm: float | None = None,
    width_mm: float | None = None,
) -> FabricationSettings:
    """The settings with some of them changed."""
    return replace(
        settings,
        options=replace(settings.options, style=settings.options.style if style is None else style),
        connector_mm=settings.connector_mm if connector_mm is None else connector_mm,
        width_mm=settings.width_mm if width_mm is None else width_mm,
    )


def coarser_designs(candidate: Candidate, request: Request) -> Iterator[tuple[Candidate, ...]]:
    """Fit the target on coarser grids, one after the other, from the uniform sheet.

    Parameters
    ----------
    candidate : Candidate
        The design whose place they are to take.
    request : Request
        What it was asked for by; grid and number of designs do not matter.

    Yields
    ------
    tuple of Candidate
        The designs of a grid, best first; grids whose best is not feasible or matches by far less are left out.
    """
    from kirigami_studio.pipeline.run import fits_from_uniform

    rows, columns = candidate.sheet.grid
    for fewer in FEWER_VOIDS:
        grid = rows - fewer, columns - fewer
        if min(grid) < LEAST_VOIDS:
            return
        wish = replace(
            request,
            grid=grid,
            k=COARSER_DESIGNS,
            polish=POLISH_STEPS,
            near=None,
            budget_seconds=None,
            search=0,
            trim=False,
        )
        answers = [task.carry_out(wish, never) for task in fits_from_uniform(wish)]
        found = Ranking.of(wish).ranked([answer.candidate for answer in answers if answer.candidate is not None])
        if (
            found
            and found[0].score.feasible
            and found[0].score.iou_exact >= candidate.score.iou_exact - MOST_MATCH_LOST
        ):
            yield tuple(found)
