"""Making a sheet: plan and check its cuts, close it on its connectors, judge it, write and verify files, fix."""

from __future__ import annotations

from collections import OrderedDict
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from enum import Enum
from functools import cached_property, lru_cache
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import TYPE_CHECKING

import shapely

from kirigami_studio.evaluate.candidate import Candidate
from kirigami_studio.export.artwork import Artwork
from kirigami_studio.fabricate.findings import Problem, Severity
from kirigami_studio.fabricate.machine import MachineKind
from kirigami_studio.fabricate.material import Construction
from kirigami_studio.fabricate.options import BoardCut
from kirigami_studio.foundation.errors import (
    Cancelled,
    ExportError,
    FabricationError,
    KirigamiError,
    MechanicsError,
    ProjectError,
    UsageError,
)
from kirigami_studio.foundation.files import write_atomically
from kirigami_studio.foundation.steps import Cancel, in_turns, never
from kirigami_studio.foundation.threads import one_blas_thread
from kirigami_studio.foundation.words import tr
from kirigami_studio.lattice.deployment import Deployment, deploy
from kirigami_studio.outlines.outline import Outline
from kirigami_studio.project.design_facts import design_facts
from kirigami_studio.project.sheet_size import sized
from kirigami_studio.settings.fabrication import (
    FabricationSettings,
    hold_options,
    is_pinned,
    is_printed,
    machine_for,
    material_for,
    pin_sizes,
    printed_pins,
)
from kirigami_studio.settings.layers import board_layer, hinge_layer, is_backed, sheet_material
from kirigami_studio.studio import importing
from kirigami_studio.studio.cutting import kerf_mm, refuse_errors
from kirigami_studio.studio.file_kinds import FILE_KINDS, kind_of
from kirigami_studio.studio.two_states import shown_match

if TYPE_CHECKING:
    from kirigami_studio.assembly.backed import BackedSheet
    from kirigami_studio.assembly.checks import PinnedReport
    from kirigami_studio.assembly.nesting import LaidShape
    from kirigami_studio.assembly.pieces import Assembly, Piece
    from kirigami_studio.assembly.posed_pieces import PosedPieces
    from kirigami_studio.evaluate.posed_design import PosedDesign
    from kirigami_studio.export.artwork_files import PrintedBed
    from kirigami_studio.export.artwork_pieces import PrintedPieces
    from kirigami_studio.export.assembly_files import AssemblyFiles, AssemblyJob
    from kirigami_studio.export.cut_motion import CutMotion
    from kirigami_studio.export.exporter import ExportJob
    from kirigami_studio.export.print_files import PrintJob
    from kirigami_studio.export.printed_pages import PrintedPages
    from kirigami_studio.export.strokes import Work
    from kirigami_studio.export.verification import Verification
    from kirigami_studio.fabricate.checks import PlanReport
    from kirigami_studio.fabricate.cut_plan import CutPlan
    from kirigami_studio.fabricate.material import Material
    from kirigami_studio.foundation.arrays import ShapeRings
    from kirigami_studio.mechanics.gripping import Gripping
    from kirigami_studio.pipeline.request import Request
    from kirigami_studio.project.document import Document
    from kirigami_studio.studio.as_cut import AsCut, SimulatedSheet
    from kirigami_studio.studio.assembling import Assembled
    from kirigami_studio.studio.backing import Backing
    from kirigami_studio.studio.fixes import Advice
    from kirigami_studio.studio.verdict import Verdict

ANIMATION = ".gif"
#: Problems of tiles that leave no board to cut.
NO_BOARD = ("backed.cuts_merge", "printed.no_tiles")
#: Kinds of files that hold tiles to print.
SOLIDS = (".3mf", ".obj", ".stl")
#: What writes the files of pieces.
WRITING = "kirigami_studio.export.assembly_files"
#: Plans that are kept: a design that is chosen again, or exported, has its cuts at once.
MOST_PLANS = 16
#: Designs that are estimated between two reports.
AT_ONCE = 4


class Motion(Enum):
    """What an animation shows."""

    AS_CUT = "as_cut"  #: the sheet on its connectors, as far as it comes
    IDEAL = "ideal"  #: connectors of no width, all the way to the target angle


@dataclass(frozen=True, slots=True, eq=False)
class Planned:
    """A cut plan and what its check found."""

    plan: CutPlan
    report: PlanReport
    verdict: Verdict  #: What is to be expected as long as nobody has closed the sheet on its connectors
    removed_share: float = 0.0  #: 0..1; share of the sheet that was trimmed away
    #: Length and time where files hold other cuts than the plan: closed slots for slits, several copies, two layers
    work: Work | None = None
    layers: AssemblyJob | None = None  #: Both layers of a backed design, whose plan is that of the hinge layer

    @property
    def seconds(self) -> float:
        """Estimated time of all cuts."""
        return (self.plan.times if self.work is None else self.work.times).total


@dataclass(frozen=True, slots=True)
class TimedDesign:
    """Time of cutting a design."""

    candidate: Candidate
    settings: FabricationSettings  #: How it is cut
    seconds: float


@dataclass(frozen=True, slots=True)
class Output:
    """What is to be written."""

    path: Path  #: A file, whose extension names its kind; or the folder of a whole set
    name: str | None = None  #: Of the cut files of a whole set, without extension; None for one file
    record: bool = False  #: Whether all settings are written beside them as .json

    @property
    def has_pdf(self) -> bool:
        """Whether a PDF is among it, whose pages may be many."""
        return self.name is not None or self.path.suffix.lower() == ".pdf"


@dataclass(frozen=True, slots=True, eq=False)
class ExportedFiles:
    """A file, or a folder of files, that is on disk."""

    path: Path  #: The file, or the folder of a whole set
    planned: Planned | None  #: What it holds; pictures hold no plan
    #: What two readers found in each cut file; kinds of file that are not verified this way have none
    verifications: tuple[Verification, ...] = ()
    motion: CutMotion | None = None  #: What an animation shows; None for the ideal motion, and for other kinds of file
    not_as_cut: str = ""  #: Why an animation cannot show the sheet as cut, a sentence, or ""
    #: older and removed: Names of what an earlier export left in the folder and this one does not have: all of it, and
    #: what was removed
    older: tuple[str, ...] = ()
    removed: tuple[str, ...] = ()
    verdict: Verdict | None = None  #: On the sheet that a cut file holds; coupons and pictures have none
    files: tuple[Path, ...] = ()  #: All of them, in the order of writing
    pieces: MadePieces | None = None  #: Of a pinned design, which has no plan
    #: Of a target of several parts, what was written of each; all else is of all of them, the verdict the worst.
    parts: tuple[ExportedFiles, ...] = ()
    part: str = ""  #: Name of the part that this is of; "" for the whole
    work: Work | None = None  #: Length and time of all cuts of the sheets of several parts

    @property
    def ok(self) -> bool:
        """Whether every file that was read back is as planned."""
        return all(found.ok for found in self.verifications)


@dataclass(frozen=True, slots=True)
class ManyPages:
    """Nothing was written yet: the PDF would have many pages, which a person has to want."""

    pages: int
    note: str  #: A sentence


@dataclass(frozen=True, slots=True, eq=False)
class CutRequest:
    """The design that is to be cut, and how."""

    candidate: Candidate
    deployment: Deployment  #: Of the candidate's final field: that of the trim, if it is trimmed
    target: Outline | None
    settings: FabricationSettings
    as_cut: AsCut | str | None = None  #: How it does as cut, or why that cannot be told, if that is known already
    document: Document | None = None  #: The project of the design, which cut files carry with this design alone
    #: The name that the sheet gets engraved if the settings say so; that of the design unless given
    engraved: str | None = None

    @classmethod
    def of(cls, document: Document, settings: FabricationSettings | None = None) -> CutRequest:
        """The chosen design of a project, cut as the project says or by other settings.

        Raises
        ------
        ProjectError
            None is chosen.
        """
        candidate, cut = chosen_candidate(document), document.fabrication if settings is None else settings
        motion = deploy(candidate.final_sheet)
        return cls(candidate, motion, document.target, cut, document=replace(document, fabrication=cut))

    @property
    def name(self) -> str:
        """What the design is called, "" where nobody knows."""
        if self.engraved is not None:
            return self.engraved
        return "" if self.document is None else self.document.name_of(self.candidate)

    @property
    def is_pinned(self) -> bool:
        """Whether it is made of pieces on pins."""
        return is_pinned(self.settings)

    @property
    def has_layers(self) -> bool:
        """Whether its files are those of several layers, in a folder."""
        return has_pieces(self.settings)

    @property
    def facts(self) -> Mapping[str, str]:
        """Where the design comes from."""
        return {} if self.document is None else design_facts(self.document, self.candidate)

    @property
    def artwork(self) -> Artwork | None:
        """What is printed on the sheet."""
        return None if self.document is None else self.document.artwork


def has_pieces(settings: FabricationSettings) -> bool:
    """Whether a design is made of pieces on pins, or of tiles on cloth."""
    return is_pinned(settings) or is_backed(settings)


def chosen_candidate(document: Document) -> Candidate:
    """The chosen design of a project.

    Raises
    ------
    ProjectError
        It has none.
    """
    candidate = document.candidate
    if candidate is None or document.target is None:
        raise ProjectError("export.no_chosen_design")
    return candidate


def with_cuttable_chosen(document: Document) -> tuple[Document, KirigamiError | None]:
    """Choose the first design of a project, from the chosen one on, that survives its cuts.

    Returns
    -------
    document : Document
        With that design chosen; where there is none, the first one whose cuts can be planned at all.
    refusal : KirigamiError or None
        Why the design that was chosen before cannot be cut; None where it can.
    """
    first: KirigamiError | None = None
    planned_at_least: Document | None = None
    for number in range(document.chosen or 0, len(document.candidates)):
        chosen = sized(replace(document, chosen=number))
        request = CutRequest.of(chosen)
        try:
            made = pieces_of(request) if request.is_pinned else planned(request)
            planned_at_least = planned_at_least or chosen
            refuse_errors(made.report)
        except FabricationError as error:
            first = first or error
            continue
        return chosen, first
    return planned_at_least or document, first


# from a design to its files -------------------------------------------------------------------------------------------


def planning(request: CutRequest, cancel: Cancel) -> Iterator[Planned | MadePieces]:
    """Plan the cuts, or the pieces of a pinned design, and check them."""
    importing.import_as_cut()
    yield pieces_of(request) if request.is_pinned else planned(request, cancel)


def laying_pages(plan: CutPlan, paper: str, cancel: Cancel) -> Iterator[PrintedPages]:
    """Lay a plan over pages of paper, as its PDF has them."""
    importing.import_exporters()
    from kirigami_studio.export.printed_pages import printed_pages

    yield printed_pages(plan, paper)


@dataclass(frozen=True, slots=True, eq=False)
class LaidBed:
    """Pieces with their places on a bed or a plate, and the size (width, height; mm) that they take."""

    title: str
    placed: tuple[tuple[Piece, LaidShape], ...]
    size_mm: tuple[float, float]


@dataclass(frozen=True, eq=False)
class MadePieces:
    """The pieces of a pinned design, laid on the beds of its machine, and judged."""

    made: Assembled
    job: AssemblyJob | PrintJob
    verdict: Verdict
    grips: tuple[int, int]  #: panels to hold and to pull, row by row

    @property
    def report(self) -> PinnedReport:
        """Findings of the check of the pieces."""
        return self.made.report

    @cached_property
    def posed(self) -> PosedPieces:
        """The pieces over their target, for pictures."""
        from kirigami_studio.assembly.posed_pieces import PosedPieces

        cut = self.cutting
        if cut is None:
            found = PosedPieces.of(self.made.plan, self.job.material, holds=self.made.held.places)
        else:
            found = PosedPieces.of(self.made.plan, cut.material, cut.fastener, self.made.held.places)
        return replace(found, grips=self.grips)

    @cached_property
    def on_board(self) -> PosedPieces:
        """The same with the board and the arms that move them, if there are any."""
        drive = self.made.drive
        return self.posed if drive is None else replace(self.posed, assembly=drive.assembly)

    @property
    def printing(self) -> PrintJob | None:
        """The job of what is printed; None where pieces are cut."""
        from kirigami_studio.export.print_files import PrintJob

        return self.job if isinstance(self.job, PrintJob) else None

    @property
    def cutting(self) -> AssemblyJob | None:
        """The job of what is cut; None where pieces are printed."""
        from kirigami_studio.export.assembly_files import AssemblyJob

        return self.job if isinstance(self.job, AssemblyJob) else None

    @property
    def beds(self) -> tuple[LaidBed, ...]:
        """Pieces on each bed, or on each plate of what is printed."""
        if self.printing is not None:
            return tuple(
                LaidBed(tr("Plate {number}", number=plate.number), plate.placed, plate.size_mm)
                for plate in self.printing.plates
            )
        return () if self.cutting is None else laid_beds(self.cutting)

    @property
    def works(self) -> tuple[Work, ...]:
        """Length and time of the cuts of each bed; none of what is printed."""
        return () if self.cutting is None else self.cutting.works

    @property
    def flat_size_mm(self) -> tuple[float, float]:
        """Width and height of the flat assembly."""
        left, bottom, right, top = self.made.plan.flat.bounds
        return right - left, top - bottom

    @property
    def cut_length_mm(self) -> float:
        """Of all beds."""
        return sum(work.cut_length_mm for work in self.works)

    @property
    def seconds(self) -> float:
        """Estimated time of cutting all beds, without changing the sheets."""
        return sum(work.times.total for work in self.works)


def laid_beds(job: AssemblyJob) -> tuple[LaidBed, ...]:
    """Pieces on each bed of what is cut."""
    from kirigami_studio.export.cut_bed import LAYERS

    return tuple(
        LaidBed(
            tr("Board and arms, bed {bed}", bed=bed.number)
            if bed.layer > LAYERS
            else tr("Layer {layer}, bed {bed}", layer=bed.layer, bed=bed.number),
            tuple((cuts.piece, place) for cuts, place in bed.placed),
            bed.size_mm,
        )
        for bed in job.beds
    )


def pieces_of(request: CutRequest) -> MadePieces:
    """Make, check and judge the pieces of a pinned design.

    Raises
    ------
    FabricationError, UsageError
        No such material, or sizes that do not go together.
    """
    from kirigami_studio.studio.as_cut import grips_on_pins
    from kirigami_studio.studio.assembling import assembled
    from kirigami_studio.studio.verdict import judge_assembled

    settings, target = request.settings, request.target
    if target is None:
        raise ProjectError("export.no_chosen_design")
    made = _with_artwork(assembled(request.candidate, settings, target), request.artwork, target)
    opened = made.plan.opened
    shown = tuple(shapely.get_coordinates(ring)[:-1] for ring in (opened.exterior, *opened.interiors))
    verdict = judge_assembled(request.candidate, made, settings)
    job = _print_job(request, made, shown) if is_printed(settings) else _assembly_job(request, made, shown, verdict)
    grips = grips_on_pins(made.assembly.deployment, settings, made.assembly.numbers.tolist())
    names = [made.assembly.piece_on(panel).id for panel in grips]
    return MadePieces(made, replace(job, grips=(names[0], names[1])), verdict, grips)


@lru_cache(maxsize=MOST_PLANS)
def _with_artwork(made: Assembled, artwork: Artwork | None, target: Outline) -> Assembled:
    """The pieces with the lines of artwork, unless they are printed: see :func:`printed_parts`."""
    if artwork is None or not artwork.has_lines or made.plan.options.in_one_plane:
        return made
    from kirigami_studio.assembly.posed_pieces import PieceLook, PosedPieces
    from kirigami_studio.evaluate.posed_design import PosedDesign
    from kirigami_studio.export.artwork_pieces import PrintedPieces, artwork_lines, with_lines

    plan, drive = made.plan, made.drive
    design = PosedDesign(plan.assembly.deployment, plan.pose, plan.assembly.phi_target)
    lines = artwork_lines(PrintedPieces(PosedPieces(plan.assembly, design, PieceLook()), target.rings), artwork)
    return replace(
        made,
        plan=replace(plan, assembly=with_lines(plan.assembly, lines)),
        drive=None if drive is None else replace(drive, assembly=with_lines(drive.assembly, lines)),
    )


def _print_job(request: CutRequest, made: Assembled, shown: ShapeRings) -> PrintJob:
    from kirigami_studio.export.print_files import PrintJob

    settings = request.settings
    return PrintJob(
        made.assembly,
        material_for(settings),
        machine_for(settings),
        printed_pins(settings),
        name=request.name,
        paper=settings.paper,
        target=shown,
        provenance=request.facts,
        hold=hold_options(settings),
        holds=made.held.places,
    )


def _assembly_job(request: CutRequest, made: Assembled, shown: ShapeRings, verdict: Verdict) -> AssemblyJob:
    from kirigami_studio.export.assembly_files import AssemblyJob
    from kirigami_studio.project.store import packed_design

    settings = request.settings
    material, sizes = material_for(settings), pin_sizes(settings)
    return AssemblyJob(
        made.assembly,
        material,
        machine_for(settings),
        settings.fastener,
        kerf_mm(settings, material),
        sizes.hole_mm,
        sizes.ear_mm,
        sizes.clearance_mm,
        name=request.name,
        profile=settings.profile,
        dxf_version=settings.dxf_version,
        paper=settings.paper,
        order=settings.options.order,
        target=shown,
        hold=hold_options(settings),
        holds=made.held.places,
        drive=made.drive,
        provenance=request.facts,
        record=b"" if request.document is None else packed_design(request.document, request.candidate),
        verdict=verdict.level.value,
        width_mm=settings.width_mm,
    )


@dataclass(frozen=True, slots=True, eq=False)
class PicturedPieces:
    """Pieces of a design for thumbnails."""

    request: CutRequest
    pieces: PosedPieces | None = None  #: None for panels, and where pieces cannot be made
    verdict: Verdict | None = None  #: On pieces put together; tiles are judged by the sheet below them


def posed_pieces(request: CutRequest) -> PosedPieces | None:
    """The pieces of a design over its target, or its tiles on cloth; None for panels.

    Raises
    ------
    FabricationError, UsageError
        No such material, or sizes that do not go together.
    """
    from kirigami_studio.assembly.posed_pieces import PosedPieces
    from kirigami_studio.studio.assembling import assembled

    if request.target is None or not request.has_layers:
        return None
    if not request.is_pinned:
        layers = planned(request).layers
        if layers is None or layers.glued is None:
            return None
        sheet = layers.glued.sheet
        design = _posed_on_cloth(request, sheet)
        return PosedPieces.on_cloth(sheet, layers.assembly, design, layers.material, layers.holds)
    made = assembled(request.candidate, request.settings, request.target)
    made = _with_artwork(made, request.artwork, request.target)
    return PosedPieces.of(made.plan, material_for(request.settings), request.settings.fastener, made.held.places)


def picturing(requests: tuple[CutRequest, ...], cancel: Cancel) -> Iterator[PicturedPieces]:
    """Make the pieces of designs for thumbnails, and judge them."""
    importing.import_as_cut()
    from kirigami_studio.studio.assembling import assembled
    from kirigami_studio.studio.verdict import judge_assembled

    for request in requests:
        candidate, settings, verdict = request.candidate, request.settings, None
        try:
            pieces = posed_pieces(request)
            if request.is_pinned and request.target is not None:  # kept of its pieces
                verdict = judge_assembled(candidate, assembled(candidate, settings, request.target), settings)
        except (FabricationError, UsageError):  # which planning explains once the design is chosen
            yield PicturedPieces(request)
            continue
        _ = None if pieces is None else pieces.small  # worked out once and kept: here, so that the window need not
        yield PicturedPieces(request, pieces, verdict)


def writes_layers(request: CutRequest, output: Output) -> bool:
    """Whether an output is the folder of the layers of a design: for cut files, no pictures and no tiles to print."""
    kind = output.path.suffix.lower()
    if not request.has_layers:
        return False
    if output.name is not None or not kind:
        return True
    return any(one.extension == kind and one.cuts for one in FILE_KINDS) and (request.is_pinned or kind not in SOLIDS)


def judged_pieces(request: CutRequest) -> Verdict:
    """Judge a pinned design, also one whose pieces cannot be made."""
    from kirigami_studio.studio.verdict import refused

    try:
        return pieces_of(request).verdict
    except (FabricationError, UsageError) as error:
        return refused(error)


def written_pieces(request: CutRequest, output: Output, picture_phi: float | None = None) -> ExportedFiles:
    """Write the folder of a pinned design, read its files back, and judge it; or a picture of it.

    A file's name stands for the folder without its extension, which gets files of that kind alone.  Pictures show
    the ideal motion, which is that of the pieces, at ``picture_phi`` (radians) or the target angle.

    Raises
    ------
    ExportError
        An unwritable place, a kind of file that pieces have none of, or one that did not pass its own re-reading.
    """
    from kirigami_studio.pipeline.pool import shared_pool
    from kirigami_studio.studio.verdict import judge_assembled

    kind = output.path.suffix.lower()
    if output.name is None and kind and not kind_of(kind).cuts:
        from kirigami_studio.export.registry import export

        place = export(replace(picture_job(request), picture_phi=picture_phi), output.path)
        made = pieces_of(request)
        return ExportedFiles(place, None, verdict=made.verdict, files=(place,), pieces=made)
    shared_pool().prepare(WRITING)
    pieces = pieces_of(request)

    def judge(verifications: Sequence[Verification]) -> Verdict:
        return judge_assembled(request.candidate, pieces.made, request.settings, verifications)

    folder, found = _layers_written(pieces.job, output, judge, pieces.report.problems)
    verified, verdict = found.verifications, judge(found.verifications)
    return ExportedFiles(folder, None, verified, verdict=verdict, files=found.files, pieces=pieces)


def _layers_written(
    job: AssemblyJob | PrintJob,
    output: Output,
    judge: Callable[[Sequence[Verification]], Verdict],
    problems: Sequence[Problem],
) -> tuple[Path, AssemblyFiles]:
    """Write the folder of a design in layers, and return it; its ``problems`` explain files that cannot be right."""
    from kirigami_studio.export.assembly_files import KINDS, AssemblyJob, write_assembly
    from kirigami_studio.export.print_files import KINDS as PRINTED
    from kirigami_studio.export.print_files import write_print
    from kirigami_studio.pipeline.pool import shared_pool

    kinds = KINDS if isinstance(job, AssemblyJob) else PRINTED
    kind = output.path.suffix.lower()
    if output.name is None and kind not in ("", ".pdf", *kinds):
        raise ExportError("pieces.no_such_file", extension=kind, known=", ".join((".pdf", *kinds)))
    wanted = (kind,) if output.name is None and kind in kinds else kinds
    folder = output.path.with_suffix("") if output.name is None else output.path
    try:
        if isinstance(job, AssemblyJob):
            beside = shared_pool().beside
            return folder, write_assembly(job, folder, wanted, lambda read: judge(read).level.value, beside)
        return folder, write_print(job, folder, wanted, lambda read: judge(read).level.value)
    except ExportError as error:
        broken = next((one for one in problems if one.severity is Severity.ERROR), None)
        if broken is None:
            raise
        raise ExportError("export.cannot_be_cut", reason=broken.text) from error


_PLANS: OrderedDict[tuple[object, ...], Planned] = OrderedDict()


def planned(request: CutRequest, cancel: Cancel = never) -> Planned:
    """Plan the cuts and check them, in one go; a trimmed design gets its trimmed outline.

    What was planned lately is not planned again.

    Raises
    ------
    FabricationError
        A plan that cannot be made.
    """
    settings = request.settings
    name = request.name if settings.engrave else ""
    # The target, because what a trim keeps takes no part in comparisons.
    layers = [hinge_layer(settings), *([board_layer(settings)] if is_backed(settings) else [])]
    figures = [(material_for(cut), machine_for(cut)) for cut in layers]
    key = (request.candidate, request.target, settings, *figures, name, request.artwork if len(layers) > 1 else None)
    made = _PLANS.pop(key, None) or _planned_anew(request, cancel)
    _PLANS[key] = made
    while len(_PLANS) > MOST_PLANS:
        _PLANS.popitem(last=False)
    return made


def _planned_anew(request: CutRequest, cancel: Cancel) -> Planned:
    from kirigami_studio.export.strokes import total_work
    from kirigami_studio.studio.backing import checked_plan
    from kirigami_studio.studio.cutting import plan_of
    from kirigami_studio.studio.verdict import judge

    candidate, trim = request.candidate, request.candidate.trim
    plan = plan_of(candidate, request.settings, request.deployment, cancel, request.name)
    report, backing = checked_plan(candidate, plan, request.deployment, request.settings)
    _ = plan.times  # worked out once and kept: here, so that the window need not
    removed = 0.0 if trim is None else trim.removed_share
    layers = None if backing is None else _layers_job(request, backing)
    verdict = judge(candidate, plan, report, None)
    work = _work(plan, request.settings.profile) if layers is None else total_work(layers.all_works)
    return Planned(plan, report, verdict, removed, work, layers)


def _layers_job(request: CutRequest, backing: Backing) -> AssemblyJob:
    """The files of a backed design."""
    from kirigami_studio.export.assembly_files import AssemblyJob
    from kirigami_studio.export.backed_files import Glued
    from kirigami_studio.project.store import packed_design

    settings, sheet, target = request.settings, backing.sheet, None
    hold, assembly, board = hold_options(board_layer(settings)), backing.assembly, backing.board
    if request.artwork is not None and request.artwork.has_lines and backing.jig.cut is not BoardCut.KISS:
        from kirigami_studio.export.artwork_pieces import artwork_lines, with_lines

        assembly = with_lines(assembly, artwork_lines(_printed_tiles(request, sheet, assembly), request.artwork))
        board = sheet.board(backing.jig, assembly)
    if request.target is not None:
        back = request.candidate.final_pose.inverse()
        target = tuple(back.apply(ring) * sheet.cell_mm for ring in request.target.rings)
    return AssemblyJob(
        assembly,
        backing.material,
        backing.machine,
        settings.fastener,
        backing.kerf_mm,
        backing.jig.pin_mm,
        0.0,
        0.0,
        Construction.BACKED,
        name=request.name,
        profile=settings.profile,
        dxf_version=settings.dxf_version,
        paper=settings.paper,
        order=settings.options.order,
        target=target,
        hold=hold,
        holds=backing.held.places,
        provenance=request.facts,
        record=b"" if request.document is None else packed_design(request.document, request.candidate),
        glued=Glued(sheet, board, backing.material, backing.jig.cut, backing.held.places),
    )


def _printed_tiles(request: CutRequest, sheet: BackedSheet, tiles: Assembly) -> PrintedPieces:
    """Tiles as artwork lies on them."""
    from kirigami_studio.assembly.posed_pieces import PieceLook, PosedPieces
    from kirigami_studio.export.artwork_pieces import PrintedPieces

    design = _posed_on_cloth(request, sheet)
    target = None if request.target is None else request.target.rings
    return PrintedPieces(PosedPieces(tiles, design, PieceLook()), target)


def _posed_on_cloth(request: CutRequest, sheet: BackedSheet) -> PosedDesign:
    """The hinge layer as it is cut over its target."""
    from kirigami_studio.evaluate.posed_design import PosedDesign

    design = PosedDesign(request.deployment, request.candidate.final_pose, request.candidate.final_phi)
    return design if sheet.deployment is request.deployment else design.laid_over(sheet.deployment)


def _work(plan: CutPlan, profile: str) -> Work | None:
    """What cutting takes if the file holds slots or copies; None where it holds the plan, or cannot hold slots, which
    exporting then explains.
    """
    from kirigami_studio.export.profile import find_profile
    from kirigami_studio.export.strokes import strokes_of, work_of

    found = find_profile(profile)
    if not found.slots and len(plan.copies) == 1:
        return None
    try:
        return work_of(strokes_of(plan, found), plan)
    except ExportError:
        return None


def closed(request: CutRequest, made: Planned) -> AsCut | str:
    """How the planned sheet does as cut, closed in one go unless that is known, or why not."""
    from kirigami_studio.studio.verdict import closed_as_cut

    if request.as_cut is not None:
        return request.as_cut
    return closed_as_cut(request.candidate, request.deployment, made.plan, request.settings.width_mm, request.target)


def judged(
    request: CutRequest, made: Planned, as_cut: AsCut | str | None, verifications: Sequence[Verification] = ()
) -> Verdict:
    """Judge a planned sheet by its check, by how it does as cut, and by what was found in its files."""
    from kirigami_studio.studio.verdict import judge

    return judge(request.candidate, made.plan, made.report, as_cut, verifications)


def export_job(request: CutRequest, made: Planned | None) -> ExportJob:
    """What the exporters get about a design."""
    from kirigami_studio.assembly.backed import TileSizes
    from kirigami_studio.assembly.solids import PrintForm, Printing
    from kirigami_studio.export.exporter import ExportJob
    from kirigami_studio.project.store import packed_design

    target = None if request.target is None else request.target.rings
    job = ExportJob.of(request.candidate, target, None if made is None else made.plan)
    machine = machine_for(request.settings) if made is not None else None
    bed = machine.reach_mm if machine is not None and machine.kind is MachineKind.PRINTER else (0.0, 0.0)
    if made is not None and (made.layers is not None or made.plan.material.backing):
        tiles = TileSizes(request.settings.gap_mm)
        job = replace(job, printing=Printing(PrintForm.TILES, tile_sizes=tiles, bed_mm=bed))
    elif any(bed):
        job = replace(job, printing=Printing(bed_mm=bed))
    return replace(
        job,
        profile=request.settings.profile,
        dxf_version=request.settings.dxf_version,
        paper=request.settings.paper,
        markers=request.settings.markers,
        provenance=request.facts,
        width_mm=request.settings.width_mm,
        thickness_mm=material_for(request.settings).thickness_mm,
        artwork=request.artwork,
        record=b"" if request.document is None else packed_design(request.document, request.candidate),
    )


def picture_job(request: CutRequest) -> ExportJob:
    """Job of pictures and animations, with the pieces of a design that is made of them.

    Raises
    ------
    FabricationError, UsageError
        Pieces that cannot be made.
    """
    job = replace(export_job(request, None), pieces=posed_pieces(request))
    if not request.is_pinned or request.target is None:
        return job
    from kirigami_studio.studio.assembling import assembled

    made = assembled(request.candidate, request.settings, request.target)  # kept of its pieces
    return replace(job, match=shown_match(request.candidate, made.as_cut))


def printed_parts(request: CutRequest, cancel: Cancel = never) -> tuple[ExportJob, tuple[PrintedBed | None, ...]]:
    """Job of the files of a printed design, and the beds of its pieces; None for a sheet.

    Raises
    ------
    ExportError
        Its faces get no picture: it comes out of a 3D printer, or the faces of its tiles are glued on.
    FabricationError
        A plan that cannot be made.
    """
    settings = request.settings
    if is_printed(settings):
        raise ExportError("artwork.printer")
    if not request.has_layers:
        return export_job(request, planned(request, cancel)), (None,)
    from kirigami_studio.export.artwork_files import PrintedBed
    from kirigami_studio.export.assembly_files import bed_facts
    from kirigami_studio.export.cut_bed import LAYERS
    from kirigami_studio.export.profile import find_profile

    made = pieces_of(request) if request.is_pinned else planned(request, cancel)
    job = made.cutting if isinstance(made, MadePieces) else made.layers
    printed = printed_pieces(request, made)
    if job is None or printed is None:
        raise ExportError("artwork.kiss_cut")
    beds = []
    for bed in (one for one in job.beds if one.layer <= LAYERS):
        facts = bed_facts(job, bed, bed.strokes(find_profile(job.profile)))
        places = {cuts.piece.id: place for cuts, place in bed.placed}
        beds.append(PrintedBed(bed.name, printed, places, bed.size_mm, facts, facts["DESIGN"]))
    return export_job(request, None), tuple(beds)


def printed_pieces(request: CutRequest, made: Planned | MadePieces) -> PrintedPieces | None:
    """The pieces whose fronts get artwork; None for a sheet, a print, and kiss-cut tiles."""
    from kirigami_studio.assembly.posed_pieces import PieceLook, PosedPieces
    from kirigami_studio.export.artwork_pieces import PrintedPieces

    if isinstance(made, MadePieces):
        target, posed = None if request.target is None else request.target.rings, made.posed
        printed = PrintedPieces(PosedPieces(posed.assembly, posed.design, PieceLook()), target)
        return None if made.cutting is None else printed
    if made.layers is None or made.layers.glued is None or request.settings.board_cut is BoardCut.KISS:
        return None
    return _printed_tiles(request, made.layers.glued.sheet, made.layers.assembly)


def written(
    request: CutRequest,
    made: Planned,
    output: Output,
    as_cut: AsCut | str | None,
    motion: CutMotion | None = None,
    on_written: Callable[[Path], None] | None = None,
    picture_phi: float | None = None,
) -> ExportedFiles:
    """Write the files of a planned sheet, read them back and judge it; nothing appears that was not verified.

    Parameters
    ----------
    request : CutRequest
    made : Planned
    output : Output
    as_cut : AsCut, str or None
        As :func:`closed` tells; None where nobody has looked, for the verdict.
    motion : CutMotion, optional
        What pictures and animations show instead of the ideal motion.
    on_written : callable, optional
        Gets each path of a whole set once it is there, and may raise to stop.
    picture_phi : float, radians, optional
        Angle that pictures show; the target angle unless given.

    Raises
    ------
    ExportError
        An unknown extension, an unwritable place, or a file that did not pass its own re-reading.
    """
    if made.layers is not None and writes_layers(request, output):
        if broken := next((one for one in made.report.problems if one.code in NO_BOARD), None):
            raise ExportError("export.cannot_be_cut", reason=broken.text)

        def judge(verifications: Sequence[Verification]) -> Verdict:
            return judged(request, made, as_cut, verifications)

        held = replace(made.layers, grips=_grips_on_tiles(request, made))
        folder, layers = _layers_written(held, output, judge, made.report.problems)
        read = layers.verifications
        return ExportedFiles(folder, made, read, verdict=judge(read), files=layers.files)
    from kirigami_studio.export.export_set import export_all, placed
    from kirigami_studio.export.provenance import sidecar_path, write_sidecar
    from kirigami_studio.export.registry import export_files
    from kirigami_studio.export.verification import FORMATS

    job = replace(export_job(request, made), motion=motion, picture_phi=picture_phi, simulated_jam=jam_of(as_cut))
    path = output.path

    def told(verifications: Sequence[Verification]) -> Mapping[str, object]:
        return judged(request, made, as_cut, verifications).to_json()

    if output.name is not None:
        found = export_all(job, path, output.name, output.record, on_written, told)
        left, gone = (tuple(one.name for one in paths) for paths in (found.older, found.removed))
        verdict = judged(request, made, as_cut, found.verifications)
        files, verified = found.files, found.verifications
        return ExportedFiles(path, made, verified, older=left, removed=gone, verdict=verdict, files=files)
    if path.suffix.lower() in FORMATS:
        places: list[Path] = []
        job, found_in_files = placed(job, ((path, job.dxf_version),), told, places.append)
        verified, files = tuple(found_in_files), tuple(places)
    else:
        job, verified = replace(job, verdict=judged(request, made, as_cut).level.value), ()
        if motion is None and made.layers is not None and not kind_of(path.suffix.lower()).cuts:
            job = replace(job, pieces=posed_pieces(request))
        files = export_files(job, path)
    verdict = judged(request, made, as_cut, verified)
    place = files[0]
    if output.record:
        files = (*files, write_sidecar(job, sidecar_path(path), files, verdict.to_json()))
    return ExportedFiles(place, made, verified, motion=motion, verdict=verdict, files=files)


def _grips_on_tiles(request: CutRequest, made: Planned) -> tuple[str, str] | None:
    """Ids of the tiles to hold and to pull; None where too few hang together."""
    from kirigami_studio.studio.as_cut import grips_on_tiles

    assert made.layers is not None
    columns = request.deployment.topology.columns + 1
    tiles = {row * columns + column: one.id for one in made.layers.assembly.pieces for row, column in [one.panel]}
    if len(tiles) < 2:
        return None
    try:
        held, pulled = grips_on_tiles(
            request.candidate, request.deployment, made.plan, request.settings.width_mm, list(tiles)
        )
    except MechanicsError:
        return None
    return tiles[held], tiles[pulled]


def exporting(
    request: CutRequest, output: Output, many_pages: bool, cancel: Cancel
) -> Iterator[ExportedFiles | ManyPages]:
    """Write one file or a whole set; cut files are planned, checked, read back and judged.

    A PDF of many pages is written only where ``many_pages`` are wanted.
    """
    importing.import_exporters()
    importing.import_as_cut()
    from kirigami_studio.export.registry import export, find_writer

    path = output.path
    if request.is_pinned and writes_layers(request, output):
        yield written_pieces(request, output)
        return
    if output.name is None and not writes_layers(request, output):
        find_writer(path)  # an unknown kind is refused before anything is planned
        if not kind_of(path.suffix).cuts:
            yield ExportedFiles(export(picture_job(request), path), None)
            return
    made = planned(request, cancel)
    size, paper = made.plan.copies.spread_mm, request.settings.paper
    if output.has_pdf and not many_pages and (many := many_pages_of(size, paper)):
        yield many
        return

    def stop_if_asked(_: Path) -> None:
        collect()
        if cancel():
            raise Cancelled("export.stopped", folder=path)

    as_cut = closed(request, made)
    with importing.collecting_between() as collect:
        found = written(request, made, output, as_cut, on_written=stop_if_asked)
        collect()
    yield found


def many_pages_of(size: tuple[float, float], paper: str) -> ManyPages | None:
    """Warning before a PDF (width, height; mm) of many pages is written; None for few."""
    from kirigami_studio.export.paper import page_notes, tile

    notes = page_notes(size, paper)
    return ManyPages(len(tile(size, paper).tiles), notes[0].text) if notes else None


def exporting_artwork(
    request: CutRequest, folder: Path, many_pages: bool, cancel: Cancel
) -> Iterator[ExportedFiles | ManyPages]:
    """Write the printed parts in register with the cuts, and a picture of them opened.

    Where the PDF has many pages, nothing is written unless ``many_pages`` are wanted.
    """
    importing.import_exporters()
    from kirigami_studio.export.artwork_files import ArtworkJob, write_artwork

    if request.artwork is None:
        raise ProjectError("artwork.none")
    job, beds = printed_parts(request, cancel)
    works = [ArtworkJob.usual(request.artwork, job, bed) for bed in beds]
    pages = [many_pages_of(work.page_mm, request.settings.paper) for work in works]
    if not many_pages and any(pages):
        yield max(filter(None, pages), key=lambda many: many.pages)
        return
    with importing.collecting_between():
        for work in works:
            write_artwork(work, folder)
    yield ExportedFiles(folder, None)


def exporting_coupon(
    material: Material, path: Path, settings: FabricationSettings, cancel: Cancel
) -> Iterator[ExportedFiles]:
    """Write the calibration coupon of a material as a cut file, and read it back."""
    from kirigami_studio.export.dxf import write_dxf
    from kirigami_studio.export.profile import find_profile
    from kirigami_studio.export.verification import verify_export
    from kirigami_studio.fabricate.checks import check_plan
    from kirigami_studio.fabricate.coupon import plan_coupon
    from kirigami_studio.studio.verdict import SIGNS_OF_A_JAM, Verdict

    if path.suffix.lower() != ".dxf":
        raise UsageError("coupon.not_dxf", name=path.name)
    plan = plan_coupon(material)
    with TemporaryDirectory(prefix="kirigami-", ignore_cleanup_errors=True) as folder:
        draft = Path(folder) / path.name
        write_dxf(plan, draft, settings.dxf_version, find_profile(settings.profile))
        found = verify_export(plan, draft, settings.profile, settings.dxf_version)
        # Flaps have no voids, and a coupon neither closes nor jams.
        findings = tuple(finding for finding in found.findings if finding.code not in SIGNS_OF_A_JAM)
        found = replace(found, path=path, findings=findings, void_miss_um=None)
        write_atomically(path, draft.read_bytes())
    yield ExportedFiles(path, Planned(plan, check_plan(plan), Verdict()), (found,))


def jam_of(as_cut: AsCut | str | None) -> float | None:
    """Where a simulated sheet jams (radians); None where that is unknown."""
    return None if as_cut is None or isinstance(as_cut, str) else as_cut.jam_phi


# the sheet as cut -----------------------------------------------------------------------------------------------------


@dataclass(frozen=True, slots=True)
class Estimated:
    """Estimates of some designs as cut, and their material.

    Designs that cannot be cut at all are left out.
    """

    found: tuple[tuple[Candidate, AsCut], ...]
    material: Material


def simulating(request: CutRequest, made: Planned, cancel: Cancel) -> Iterator[SimulatedSheet | None]:
    """Close a sheet on the connectors of its plan; None after every step, so that other jobs have their turn."""
    from kirigami_studio.studio.as_cut import simulate

    candidate = request.candidate
    kept = None if candidate.trim is None else candidate.trim.kept
    steps = simulate(
        request.deployment,
        made.plan,
        request.settings.width_mm,
        candidate.final_phi,
        request.target,
        kept,
        pose=candidate.final_pose,
    )
    yield from in_turns(steps, cancel)


def animating(
    request: CutRequest, path: Path, motion: Motion, sheet: SimulatedSheet | None, cancel: Cancel
) -> Iterator[ExportedFiles | None]:
    """Write an animation; None after every step of the simulation that it may need.

    Parameters
    ----------
    request : CutRequest
    path : Path
    motion : Motion
        A sheet whose cuts cannot be planned or closed is shown in its ideal motion, and the report says why.
    sheet : SimulatedSheet or None
        The design as cut, if it is known already.
    cancel : function
    """
    importing.import_exporters()
    from kirigami_studio.export.registry import export

    why = ""
    if motion is Motion.AS_CUT and sheet is None and not request.is_pinned:  # pieces close by their exact motion
        try:
            for found in simulating(request, planned(request, cancel), cancel):
                sheet = found
                yield None
        except Cancelled:
            raise
        except KirigamiError as error:
            why = str(error)
    shown = None if sheet is None or motion is Motion.IDEAL else sheet.motion
    job = picture_job(request) if shown is None else export_job(request, None)
    written = export(replace(job, motion=shown), path)
    yield ExportedFiles(written, None, motion=shown, not_as_cut=why)


def judging(
    request: CutRequest,
    made: Planned,
    as_cut: AsCut | str,
    others: Mapping[str, Candidate],
    run: Request | None,
    cancel: Cancel,
) -> Iterator[Verdict | Advice | None]:
    """Judge a sheet, and where it is not ready to cut, try changes on its design, see :func:`fixing`."""
    verdict = judged(request, made, as_cut)
    yield verdict
    if not verdict.ok:
        yield from fixing(request, verdict, others, run, cancel)


def fixing(
    request: CutRequest, verdict: Verdict, others: Mapping[str, Candidate], run: Request | None, cancel: Cancel
) -> Iterator[Advice | None]:
    """Try changes on a design that is not ready to cut; None after every step, so that other jobs have their turn.

    ``others`` are the designs by their names.  ``run`` is what designs on coarser grids are asked for by; without one
    there are none.
    """
    from kirigami_studio.studio.fixes import coarser_designs, find_fixes, find_piece_fixes
    from kirigami_studio.studio.verdict import refused

    coarser = () if run is None else coarser_designs(request.candidate, run)
    if request.is_pinned and request.target is not None:
        steps = find_piece_fixes(request.candidate, request.settings, verdict, request.target, others, coarser)
        yield from in_turns(steps, cancel)
        return
    try:
        planned(request, cancel)
    except Cancelled:
        raise
    except KirigamiError as error:
        verdict = refused(error)  # with its numbers, which lead to the first changes
    steps = find_fixes(request.candidate, request.settings, verdict, others, coarser, request.target)
    yield from in_turns(steps, cancel)


def gripping(
    sheet: SimulatedSheet, deployment: Deployment, width_mm: float, cancel: Cancel
) -> Iterator[Gripping | None]:
    """Find where to hold and pull a sheet as far as it comes; None after every step, so that other jobs have turns."""
    from kirigami_studio.mechanics.closing import CLOSED
    from kirigami_studio.mechanics.gripping import grip_steps

    end = max(sheet.as_cut.reached, CLOSED)
    steps = grip_steps(sheet.made or deployment, sheet.closing.sheet, width_mm, end)
    yield from in_turns(steps, cancel)


def timing(requests: tuple[CutRequest, ...], cancel: Cancel) -> Iterator[TimedDesign]:
    """Yield the cutting times of designs, but for those whose cuts cannot be planned."""
    importing.import_as_cut()
    for request in requests:
        try:
            if is_printed(request.settings):
                continue  # the slicer knows
            seconds = (pieces_of(request) if request.is_pinned else planned(request, cancel)).seconds
        except (FabricationError, UsageError):
            continue  # which planning explains once it is chosen
        yield TimedDesign(request.candidate, request.settings, seconds)


def estimating(
    designs: tuple[tuple[Candidate, Deployment, FabricationSettings], ...], cancel: Cancel
) -> Iterator[Estimated]:
    """Estimate whether designs close, each as it would be cut, a few at a time; all are of one material."""
    from kirigami_studio.studio.as_cut import estimate

    material = sheet_material(designs[0][2])
    for start in range(0, len(designs), AT_ONCE):
        found = []
        for candidate, deployment, settings in designs[start : start + AT_ONCE]:
            try:
                # On several threads, narrow matrices wait for each other, and the window for them.
                with one_blas_thread():
                    found.append((candidate, estimate(deployment, settings, candidate.final_phi, material)))
            except KirigamiError:
                continue  # its cuts cannot be planned, which planning explains once it is chosen
        yield Estimated(tuple(found), material)
