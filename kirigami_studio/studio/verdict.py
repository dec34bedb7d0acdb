"""The verdict on a design: does it match, fit the material, close as cut; are its files right.

One value for a design and the settings that it is cut with, made of what reading its files back found, of the check of
its cut plan, of how the sheet does as cut, and of what the material bears.  Window, report, record, command line and
Python show this one value.  What is only estimated says so, and gives way to the simulation.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Generator, Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from enum import Enum
from typing import TYPE_CHECKING, TypeVar

import numpy as np

from kirigami_studio.assembly.checks import closed_holes
from kirigami_studio.evaluate.candidate import Candidate, Origin
from kirigami_studio.fabricate.checks import PlanReport
from kirigami_studio.fabricate.cut_plan import CutPlan
from kirigami_studio.fabricate.findings import Note, Problem, Severity
from kirigami_studio.fabricate.machine import MachineKind
from kirigami_studio.fabricate.material import Material
from kirigami_studio.fabricate.strain import StrainFigure, strain_note
from kirigami_studio.foundation.errors import Cancelled, KirigamiError
from kirigami_studio.foundation.steps import result_of
from kirigami_studio.foundation.words import mark, number, tr
from kirigami_studio.lattice.deployment import Deployment, deploy
from kirigami_studio.outlines.outline import Outline
from kirigami_studio.pipeline.rank import Ranking
from kirigami_studio.settings.fabrication import FabricationSettings, is_pinned, is_printed
from kirigami_studio.studio.as_cut import (
    CLOSE_TO,
    ESTIMATE_CLOSES,
    AsCut,
    Outcome,
    Source,
    jam_json,
    simulate,
)
from kirigami_studio.studio.assembling import Assembled, assembled, beyond_the_bed
from kirigami_studio.studio.backing import checked_plan
from kirigami_studio.studio.cutting import plan_of

if TYPE_CHECKING:
    from kirigami_studio.export.verification import Verification

#: What the check of a plan finds about strain; the verdict has one sentence for it, without advice that nobody tried.
STRAINED = frozenset({"plan.strain_choose_style", "plan.strain_larger_sheet"})
#: Fields that both have.
STRAIN_FIELDS = ("strain_percent", "limit_percent", "material", "why")
#: Warnings of that check that mean that the sheet does not survive.
FATAL = frozenset({"plan.material_does_not_hold", "plan.material_needs_backing"})
#: Findings about panels smaller than the material needs.
TOO_SMALL = frozenset(
    {
        "plan.panel_edge_small",
        "plan.panel_neck_small",
        "plan.trimmed_neck_small",
        "backed.tile_narrow",
        "backed.tiles_missing",
    }
)
#: Notes of a plan that mean that a person does not get what was asked for.
NOT_AS_ASKED = frozenset({"plan.connectors_narrowed"})
#: Signs of a jam that count only where nobody has closed the sheet on its connectors.
SIGNS_OF_A_JAM = frozenset(
    {
        "plan.off_centre",
        "plan.no_room_to_centre",
        "plan.no_room_made_in_trimmed",
        "verify.voids_miss",
    }
)
#: Worth that a connector which stretches by its whole width costs: where designs match alike, calm connectors decide.
STRETCH = 0.05
#: Match (IoU) from which a silhouette counts as that of its target.  For a disc it means an edge that is 5 % of the
#: radius off all round: 2.5 mm on a shape 100 mm wide.
MATCHES = 0.90
#: Below this it is another shape: a plain square comes to 0.66 on a star and to 0.70 on a butterfly.
MATCHES_ROUGHLY = 0.75
#: A jam that costs no more match (IoU) than this is no more than nearly a jam: being forced shut costs film as much.
LITTLE_LOST = 0.02
#: A few degrees at the end that cost no more match than this are told and are no problem: an edge that is 0.25 % of the
#: radius off all round, 0.13 mm on a disc 100 mm wide, is less than what a cut is off.
UNSEEN_LOST = 0.005
#: Share of its way that a thin sheet has to come flat.  Film passes jams by bending out of the plane, as straight
#: hearts do which jam at 69 to 74 of 180 degrees and match there with 0.87; sheets that jam at 121 to 148 degrees
#: match with 0.72 to 0.74, and want their connectors stretched by 2 to 5 widths.
HALF_WAY = 0.5
#: Of a sheet that comes within a few degrees of its angle, or loses hardly any match.
NEARLY = "as_cut.nearly"
#: What a close look lets pass: ranking counts the match that is lost.
BEARABLE = frozenset({NEARLY, "as_cut.loses_match", "pinned.target_missed"})
#: The same of covers on pins that do not miss the target: ranking has a price for what they give up of the flat sheet.
BEARABLE_OF_COVERS = BEARABLE - {"pinned.target_missed"} | {"pinned.flat_outline_spoilt"}
#: Warnings about a file that are about importing it, not about the sheet.
ABOUT_IMPORTING = frozenset({"verify.no_unit_in_r12"})


class Level(Enum):
    """The verdict in a word; the values are the names in JSON."""

    READY = "ready_to_cut"
    CARE = "cut_with_care"
    FAILS = "will_not_work"

    @property
    def words(self) -> str:
        """As it is shown."""
        return tr(_WORDS[self])


_WORDS = {Level.READY: mark("Ready to cut"), Level.CARE: mark("Cut with care"), Level.FAILS: mark("Will not work")}
_PRINTED = {Level.READY: mark("Ready to print"), Level.CARE: mark("Print with care")}
Told = TypeVar("Told", bound=Note)
#: From best to worst.
RANK = {level: place for place, level in enumerate(Level)}


class Question(Enum):
    """The four questions about a design; the values are the names in JSON."""

    MATCHES = "matches"  #: does it show the target
    FITS = "fits_material"  #: room for connectors, least sizes, strain
    CLOSES = "closes"  #: does it come to its angle as cut
    FILES = "files"  #: do its files read back as planned


class AnswerState(Enum):
    """How a question is answered; the values are the names in JSON."""

    GOOD = "good"
    CARE = "care"
    BAD = "bad"
    OPEN = "open"  #: nobody has looked so far


#: What each answer is called; how a sheet closes has its own words.
_ANSWERS = {
    (Question.MATCHES, AnswerState.GOOD): mark("matches"),
    (Question.MATCHES, AnswerState.CARE): mark("matches roughly"),
    (Question.MATCHES, AnswerState.BAD): mark("does not match"),
    (Question.MATCHES, AnswerState.OPEN): mark("match not known"),
    (Question.FITS, AnswerState.GOOD): mark("fits the material"),
    (Question.FITS, AnswerState.CARE): mark("hardly fits the material"),
    (Question.FITS, AnswerState.BAD): mark("does not fit the material"),
    (Question.FITS, AnswerState.OPEN): mark("material not checked"),
    (Question.CLOSES, AnswerState.GOOD): mark("closes"),
    (Question.CLOSES, AnswerState.CARE): mark("closing not known"),
    (Question.CLOSES, AnswerState.BAD): mark("overlaps itself"),
    (Question.CLOSES, AnswerState.OPEN): mark("not closed yet"),
    (Question.FILES, AnswerState.GOOD): mark("files are right"),
    (Question.FILES, AnswerState.CARE): mark("files need a look"),
    (Question.FILES, AnswerState.BAD): mark("files are wrong"),
    (Question.FILES, AnswerState.OPEN): mark("no cut file checked yet"),
}
#: Findings that answer a question; files have those of their reading, the material all others.
_MATCH_FINDINGS = frozenset(
    {"as_cut.loses_match", "as_cut.does_not_match", "trim.hole_too_small", "trim.hole_holds_sheet"}
)
_CLOSING_FINDINGS = frozenset(
    {
        NEARLY,
        "as_cut.jams_while_flat",
        "as_cut.jams_touching",
        "as_cut.jams_stretched",
        "as_cut.hardly_opens",
        "as_cut.not_known",
        "rank.not_feasible",
        "verdict.not_made",
    }
)


def question_of(finding: Note) -> Question:
    """The question that a finding is about."""
    if finding.code in _MATCH_FINDINGS:
        return Question.MATCHES
    if finding.code in _CLOSING_FINDINGS:
        return Question.CLOSES
    if finding.code.startswith("verify.") or finding.code == "as_cut.file_jams":
        return Question.FILES
    return Question.FITS


@dataclass(frozen=True, slots=True)
class VerdictAnswer:
    """The answer to a question, in a word."""

    question: Question
    state: AnswerState
    word: str


@dataclass(frozen=True, slots=True)
class Verdict:
    """Expectations of a design that is cut, and the reasons.

    A design may match as roughly as it does and be ready to cut: only a match that is lost by cutting is a problem.
    """

    #: Worst first.  With an error the sheet will not work, with a warning it is cut with care.
    problems: tuple[Problem, ...] = ()
    notes: tuple[Note, ...] = ()  #: What is worth knowing beside them
    #: An estimate gives way to the simulation; None where neither can be, because no cuts can be planned or no sheet
    #: hangs together
    source: Source | None = None
    as_cut: AsCut | None = None  #: How it does as cut, by the same source; None where that is not known
    match: float | None = None  #: IoU with the target: as cut where that is known, else as designed
    read: bool = False  #: Whether its files were read back
    printed: bool = False  #: Whether it is printed and not cut
    cover_on_pins: bool = False  #: Whether panels are given up of it, and the others turn on pins

    @property
    def level(self) -> Level:
        """By the worst of the problems."""
        return _level_of(self.problems)

    @property
    def level_words(self) -> str:
        """The level, as it is shown of what is cut or printed."""
        return tr(_PRINTED[self.level]) if self.printed and self.level in _PRINTED else self.level.words

    @property
    def ok(self) -> bool:
        """Ready to cut, without a problem."""
        return self.level is Level.READY

    @property
    def refusal(self) -> Problem | None:
        """The problem for which others are ranked before it, if any; lost match is none.

        A cover on pins may spoil its flat outline or miss the target, but not both.
        """
        refusal = _refusal(self.problems)
        return _refusal(self.problems, BEARABLE_OF_COVERS) if refusal is not None and self.cover_on_pins else refusal

    @property
    def is_estimate(self) -> bool:
        """Whether the simulation is still to come."""
        return self.source is Source.ESTIMATE

    @property
    def words(self) -> str:
        """The level, marked where it is an estimate."""
        if not self.is_estimate:
            return self.level_words
        return tr("{level} (estimate)", level=self.level_words) if self.is_checked else tr("Not checked yet")

    @property
    def is_checked(self) -> bool:
        """Whether there is a verdict: a sheet without a problem that nobody has closed has none."""
        return self.as_cut is not None or bool(self.problems) or not self.is_estimate

    @property
    def answers(self) -> tuple[VerdictAnswer, ...]:
        """To each question one, in their order."""
        return tuple(self.answer(question) for question in Question)

    def answer(self, question: Question) -> VerdictAnswer:
        """The answer to a question: by the worst problem that is about it."""
        found = [problem for problem in self.problems if question_of(problem) is question]
        state = _STATES[_level_of(found)] if found or self._knows(question) else AnswerState.OPEN
        if question is Question.MATCHES and self.match is not None:
            own = AnswerState.GOOD if self.match >= MATCHES else AnswerState.CARE
            state = AnswerState.BAD if self.match < MATCHES_ROUGHLY else max(state, own, key=list(AnswerState).index)
        word = tr(_ANSWERS[question, state])
        if question is Question.CLOSES and self.as_cut is not None and "rank.not_feasible" not in _codes(found):
            word = self.as_cut.word
        return VerdictAnswer(question, state, word)

    def _knows(self, question: Question) -> bool:
        """Whether somebody has looked for the answer."""
        return {
            Question.MATCHES: self.match is not None,
            Question.FITS: self.source is not None,
            Question.CLOSES: self.as_cut is not None,
            Question.FILES: self.read,
        }[question]

    @property
    def lines(self) -> tuple[str, ...]:
        """The list that is shown everywhere: level, problems, answers, notes."""
        problems, notes = ([note.text for note in part] for part in (self.problems, self.notes))
        return (self.words, *problems, self.summary, *notes)

    @property
    def summary(self) -> str:
        """All answers in one line, an estimate marked."""
        words = {answer.question: answer.word for answer in self.answers}
        if self.match is not None:
            words[Question.MATCHES] += f" ({number(100.0 * self.match, '.1f')} %)"
        if self.as_cut is not None and self.as_cut.source is Source.ESTIMATE:
            words[Question.CLOSES] = tr("{answer} (estimate)", answer=words[Question.CLOSES])
        return ", ".join(words.values())

    def better_than(self, other: Verdict) -> bool:
        """Whether less is to be feared."""
        return RANK[self.level] < RANK[other.level]

    def to_json(self) -> dict[str, object]:
        """For the record and the command line."""
        return {
            "level": self.level.value,
            "ok": self.ok,
            "from": None if self.source is None else self.source.value,
            "answers": {
                answer.question.value: {"state": answer.state.value, "word": answer.word} for answer in self.answers
            },
            "match": self.match,
            **jam_json(self.as_cut),
            "problems": [
                {
                    "severity": problem.severity.value,
                    "question": question_of(problem).value,
                    "code": problem.code,
                    "text": problem.text,
                    "where": None if problem.where is None else [float(side) for side in problem.where],
                }
                for problem in self.problems
            ],
            "notes": [note.text for note in self.notes],
        }


_STATES = {Level.READY: AnswerState.GOOD, Level.CARE: AnswerState.CARE, Level.FAILS: AnswerState.BAD}


def _codes(found: Iterable[Note]) -> set[str]:
    return {note.code for note in found}


def _level_of(problems: Sequence[Problem]) -> Level:
    if not problems:
        return Level.READY
    return Level.FAILS if any(problem.severity is Severity.ERROR for problem in problems) else Level.CARE


@dataclass(frozen=True, slots=True, eq=False)
class Assessment:
    """A design whose cuts were planned, checked, and closed on their connectors."""

    plan: CutPlan
    report: PlanReport
    as_cut: AsCut | str  #: How the sheet does as cut, or a sentence on why that cannot be told
    verdict: Verdict


def assess(
    candidate: Candidate,
    settings: FabricationSettings,
    target: Outline | None = None,
    deployment: Deployment | None = None,
    planned: tuple[CutPlan, PlanReport] | None = None,
    verifications: Sequence[Verification] = (),
) -> Assessment:
    """Plan the cuts of a design, check them, close the sheet, and judge, all in one go.

    Parameters
    ----------
    candidate : Candidate
    settings : FabricationSettings
    target : Outline, optional
        For the match as cut.
    deployment : Deployment, optional
        Of the candidate's final sheet, if it is known already.
    planned : (CutPlan, PlanReport), optional
        If they are known already.
    verifications : sequence of Verification
        Of files that were written of it.

    Raises
    ------
    FabricationError
        No such material, or a plan that cannot be made.
    """
    motion = deploy(candidate.final_sheet) if deployment is None else deployment
    if planned is None:
        plan = plan_of(candidate, settings, motion)
        planned = plan, checked_plan(candidate, plan, motion, settings)[0]
    plan, report = planned
    as_cut = closed_as_cut(candidate, motion, plan, settings.width_mm, target)
    return Assessment(plan, report, as_cut, judge(candidate, plan, report, as_cut, verifications))


def closed_as_cut(
    candidate: Candidate, deployment: Deployment, plan: CutPlan, width_mm: float, target: Outline | None = None
) -> AsCut | str:
    """How a planned sheet of a width (mm) does as cut, simulated in one go, or why that is open."""
    return result_of(closing_as_cut(candidate, deployment, plan, width_mm, target))


def closing_as_cut(
    candidate: Candidate, deployment: Deployment, plan: CutPlan, width_mm: float, target: Outline | None = None
) -> Generator[None, None, AsCut | str]:
    """The same step by step."""
    kept = None if candidate.trim is None else candidate.trim.kept
    try:
        sheet = yield from simulate(
            deployment, plan, width_mm, candidate.final_phi, target, kept, pose=candidate.final_pose
        )
    except KirigamiError as error:
        return str(error)
    return sheet.as_cut


@dataclass(frozen=True, slots=True)
class CloseLook:
    """Findings of a close look at a design."""

    #: Why it cannot be cut; None where it can: its cuts can be planned, the sheet comes to its angle, no connector
    #: breaks and no panel is too small
    refusal: Note | None
    #: How it does as cut; None where nobody had to look so far, or where that cannot be told
    as_cut: AsCut | None = None
    gained: float = 0.0  #: Match (IoU) that pieces on pins have beyond their sheet

    @property
    def loss(self) -> float:
        """Worth (IoU) lost by being cut: match, and for the stretch of its connectors."""
        if self.as_cut is None:
            return 0.0
        return (self.as_cut.lost or 0.0) + STRETCH * self.as_cut.stretch - self.gained


def look_at(candidate: Candidate, settings: FabricationSettings, target: Outline | None = None) -> CloseLook:
    """Plan and check the cuts of a design, and close it on its connectors, in one go."""
    return result_of(looking(candidate, settings, target))


def looking(
    candidate: Candidate,
    settings: FabricationSettings,
    target: Outline | None = None,
    cancel: Callable[[], bool] = lambda: False,
) -> Generator[None, None, CloseLook]:
    """Look at a design closely, see :func:`look_at`; yields between the steps, for other jobs.

    Raises
    ------
    Cancelled
        ``cancel`` returned true.
    """
    if target is not None and is_pinned(settings):
        return _look_at_pieces(candidate, settings, target)
    try:
        motion = deploy(candidate.final_sheet)
        plan = plan_of(candidate, settings, motion, cancel)
    except Cancelled:
        raise
    except KirigamiError as error:
        return CloseLook(Note(error.code, error.fields))
    yield
    if (crowded := _crowded(plan)) is not None:
        return CloseLook(crowded)
    try:
        report, _ = checked_plan(candidate, plan, motion, settings)
    except KirigamiError as error:
        return CloseLook(Note(error.code, error.fields))
    found = judge(candidate, plan, report, None)
    small = next((problem for problem in found.problems if problem.code in TOO_SMALL), None)
    if found.level is Level.FAILS or small is not None:
        return CloseLook(small or found.problems[0])
    as_cut = yield from closing_as_cut(candidate, motion, plan, settings.width_mm, target)
    new = [one for one in judge(candidate, plan, report, as_cut).problems if one not in found.problems]
    return CloseLook(_refusal(new), None if isinstance(as_cut, str) else as_cut)


def _refusal(problems: Sequence[Problem], bearable: frozenset[str] = BEARABLE) -> Problem | None:
    return next((problem for problem in problems if problem.code not in bearable), None)


def _crowded(plan: CutPlan) -> Note | None:
    """The note on a trimmed sheet whose file would be refused: panels cannot make room there."""
    crowded = next((note for note in plan.notes if note.code == "plan.no_room_made_in_trimmed"), None)
    if crowded is None:
        return None
    from kirigami_studio.export.profile import find_profile
    from kirigami_studio.export.strokes import sheet_strokes
    from kirigami_studio.export.verification import file_voids, void_findings

    profile = find_profile("any")
    found = void_findings(file_voids(sheet_strokes(plan, profile), plan, profile), plan)
    return None if all(one.ok for one in found) else crowded


def _look_at_pieces(candidate: Candidate, settings: FabricationSettings, target: Outline) -> CloseLook:
    try:
        made = assembled(candidate, settings, target, only_whole=True)
    except KirigamiError as error:
        return CloseLook(Note(error.code, error.fields))
    found = judge_assembled(candidate, made, settings)
    gained = made.report.figures.match - candidate.match
    return CloseLook(found.refusal, made.as_cut, gained)


def refused(error: KirigamiError) -> Verdict:
    """The verdict on a design whose cuts cannot be planned."""
    return Verdict((Problem(error.code, dict(error.fields), Severity.ERROR),))


def judge(
    candidate: Candidate,
    plan: CutPlan,
    report: PlanReport,
    as_cut: AsCut | str | None,
    verifications: Sequence[Verification] = (),
) -> Verdict:
    """Judge a sheet by all that is known of it.

    Parameters
    ----------
    candidate : Candidate
        The design.
    plan, report : CutPlan, PlanReport
        Its cuts, and what their check found for the design's angle.
    as_cut : AsCut, str or None
        How it does as cut; a sentence on why that cannot be told; None where nobody has looked.
    verifications : sequence of Verification
        Of files that were written of it.
    """
    known = as_cut if isinstance(as_cut, AsCut) else None
    problems = [
        *_of_files(verifications, candidate.final_phi, known),
        *_of_design(candidate),
        *_of_holes(candidate, plan.size_mm[0]),
        *(_weighed(problem) for problem in report.problems if problem.code not in STRAINED),
        *_of_wishes(plan),
        *_of_jam(known),
        *_of_strain(plan, report, known),
        *_of_match(known),
    ]
    if isinstance(as_cut, str):
        problems.append(Problem.warning("as_cut.not_known", reason=as_cut))
    warned = (note for one in verifications for note in one.warnings)
    notes: list[Note] = [*plan.notes, *_strain_notes(plan, known), *warned]
    if known is not None and _as_good_as_closed(known):
        notes.append(Note(NEARLY, _angles(known)))
    if known is not None and (known.closes or _as_good_as_closed(known)):
        notes = [note for note in notes if note.code not in SIGNS_OF_A_JAM]
    told = {problem.text for problem in problems}
    return Verdict(
        _worst_first(problems),
        tuple(note for note in _once(notes) if note.text not in told),
        None if isinstance(as_cut, str) else Source.ESTIMATE if known is None else known.source,
        known,
        match_of(candidate, known),
        bool(verifications),
        MachineKind.of(plan.material.machine) is MachineKind.PRINTER,
    )


def judge_assembled(
    candidate: Candidate,
    made: Assembled,
    settings: FabricationSettings,
    verifications: Sequence[Verification] = (),
) -> Verdict:
    """Judge the pieces of a pinned design, and whether its machine reaches all of each; its motion is exact."""
    problems = [
        *_of_files(verifications, candidate.final_phi, made.as_cut),
        *_of_design(candidate),
        *made.report.problems,
        *beyond_the_bed(made, settings),
    ]
    notes = [note for one in verifications for note in one.warnings]
    if made.assembly.left_out:
        notes.append(Note.of("pinned.pins_left_out", count=made.assembly.left_out))
    if settings.options.copies != 1:
        notes.append(Note.of("copies.only_of_sheets"))
    told = {problem.text for problem in problems}
    return Verdict(
        _worst_first(problems),
        tuple(note for note in _once(notes) if note.text not in told),
        Source.SIMULATION,
        made.as_cut,
        made.as_cut.iou,
        bool(verifications),
        is_printed(settings),
        candidate.trim is not None and candidate.trim.given_up > 0,
    )


def expected(
    candidate: Candidate, ranking: Ranking, as_cut: AsCut | None = None, material: Material | None = None
) -> Verdict:
    """An estimate of the verdict on a design whose cuts nobody has planned.

    Parameters
    ----------
    candidate : Candidate
    ranking : Ranking
        With the sheet's width, the least feature of the material, and what close looks have found.
    as_cut : AsCut, optional
        As estimated, or simulated in a close look.
    material : Material, optional
        For the strain that its connectors bear.
    """
    refusal = ranking.refusals.get(candidate)
    problems = [
        *_of_design(candidate),
        *_of_holes(candidate, ranking.width_mm),
        *_of_room(candidate, ranking),
        *([] if refusal is None else _of_refusal(refusal)),
        *_of_jam(as_cut),
        *([] if as_cut is None or material is None else _of_expected_strain(material, as_cut)),
        *_of_match(as_cut),
    ]
    return Verdict(_worst_first(problems), (), Source.ESTIMATE, as_cut, match_of(candidate, as_cut))


def match_of(candidate: Candidate, as_cut: AsCut | None) -> float:
    """IoU with the target: as cut where that is known, else as designed and trimmed."""
    if as_cut is not None and as_cut.iou is not None:
        return as_cut.iou
    return candidate.match


def _worst_first(problems: Iterable[Problem]) -> tuple[Problem, ...]:
    return tuple(_once(sorted(problems, key=lambda problem: problem.severity is not Severity.ERROR)))


def _once(notes: Iterable[Told]) -> list[Told]:
    """Each sentence once."""
    return list({note.text: note for note in notes}.values())


def _weighed(problem: Problem) -> Problem:
    return replace(problem, severity=Severity.ERROR) if problem.code in FATAL else problem


def _of_wishes(plan: CutPlan) -> list[Problem]:
    """Warnings about what was asked for and is cut otherwise, at the narrowest connector."""
    found = [note for note in plan.notes if note.code in NOT_AS_ASKED]
    if not found:
        return []
    narrowest = min(plan.hinges.narrowed.tolist(), key=plan.hinges.requested_mm.__getitem__)
    x, y = plan.hinges.position[narrowest]
    return [Problem(note.code, note.fields, Severity.WARNING, (float(x), float(y))) for note in found]


def _of_design(candidate: Candidate) -> list[Problem]:
    """A sheet that was fitted for trimming is free of contacts; its score is that of the sheet before."""
    trim = candidate.trim
    fitted = trim is not None and (candidate.origin is not Origin.EDITED or trim.sheet != candidate.sheet)
    return [] if candidate.score.feasible or fitted else [Problem.error("rank.not_feasible")]


def _of_holes(candidate: Candidate, width_mm: float) -> list[Problem]:
    """Holes of the target that the trimmed sheet does not show, and where on it they would be."""
    trim = candidate.trim
    if trim is None or not trim.holes:
        return []
    flat = deploy(trim.sheet).compact
    return closed_holes(trim.holes, flat.min(axis=0), width_mm / float(np.ptp(flat[:, 0])))


def _of_room(candidate: Candidate, ranking: Ranking) -> list[Problem]:
    """Panels that are too small, or pins too near, by the design's own sizes."""
    if not ranking.pins_apart(candidate):
        note = ranking.pins_note(candidate)
        return [Problem(note.code, note.fields, Severity.ERROR)]
    if ranking.wide_enough(candidate):
        return []
    size = candidate.score.evenness.least_feature_mm(ranking.width_mm)
    return [Problem.warning("rank.too_thin", smallest_mm=size, least_mm=ranking.least_feature_mm)]


def _of_refusal(refusal: Note) -> list[Problem]:
    """The finding of a close look; a rank by an estimate, or without a look, is none."""
    if refusal.code in ("rank.jams", "rank.not_looked_at"):
        return []
    return [refusal if isinstance(refusal, Problem) else Problem(refusal.code, refusal.fields, Severity.ERROR)]


def _of_match(as_cut: AsCut | None) -> list[Problem]:
    """Match that is lost by cutting; that of the design itself is an answer, and no problem."""
    if as_cut is None or as_cut.iou is None or as_cut.ideal_iou is None or (as_cut.lost or 0.0) <= LITTLE_LOST:
        return []
    values = {"match_percent": 100.0 * as_cut.iou, "designed_percent": 100.0 * as_cut.ideal_iou}
    if as_cut.iou < MATCHES_ROUGHLY <= as_cut.ideal_iou:
        return [Problem.error("as_cut.does_not_match", **values, least_percent=100.0 * MATCHES_ROUGHLY)]
    return [Problem.warning("as_cut.loses_match", **values)]


def _of_files(verifications: Sequence[Verification], phi: float, as_cut: AsCut | None) -> list[Problem]:
    """Findings of two readers, once where several files have them, and jams that only a file shows."""
    names: dict[tuple[Severity, str], list[str]] = {}
    jams = []
    for one in verifications:
        for finding in one.findings:
            if not finding.ok:
                names.setdefault((Severity.ERROR, finding.text), []).append(one.path.name)
            elif finding.warning and finding.code not in ABOUT_IMPORTING | SIGNS_OF_A_JAM:
                names.setdefault((Severity.WARNING, finding.text), []).append(one.path.name)
        jam = one.jam_phi
        if jam is not None and jam > max(phi + CLOSE_TO, ESTIMATE_CLOSES) and (as_cut is None or as_cut.closes):
            jams.append(Problem.warning("as_cut.file_jams", name=one.path.name))
    found = [
        Problem("verify.in_file", {"name": ", ".join(files), "finding": text}, severity)
        for (severity, text), files in names.items()
    ]
    return [*found, *jams[:1]]


def _angles(as_cut: AsCut) -> dict[str, float]:
    return {"jam_deg": as_cut.jam_deg, "phi_deg": math.degrees(as_cut.phi)}


def _as_good_as_closed(as_cut: AsCut) -> bool:
    """Whether a sheet ends within a few degrees of its angle, at no loss of match that can be seen."""
    return as_cut.nearly_closes and as_cut.lost is not None and as_cut.lost <= UNSEEN_LOST


def _of_jam(as_cut: AsCut | None) -> list[Problem]:
    """By how far the sheet opens and how much match that costs."""
    if as_cut is None or as_cut.closes:
        return []
    angles = _angles(as_cut)
    if _as_good_as_closed(as_cut):
        return []
    if as_cut.nearly_closes or (as_cut.lost is not None and as_cut.lost <= LITTLE_LOST):
        return [Problem.warning(NEARLY, **angles)]
    if as_cut.figure is StrainFigure.OUT_OF_PLANE:
        share = {"opened_percent": 100.0 * as_cut.opened, "least_percent": 100.0 * HALF_WAY}
        if as_cut.opened >= HALF_WAY:
            return [Problem.warning("as_cut.jams_while_flat", **angles, **share)]
        return [Problem.error("as_cut.hardly_opens", **angles, **share)]
    if as_cut.outcome is Outcome.TOUCHING:
        return [Problem.error("as_cut.jams_touching", **angles)]
    return [Problem.error("as_cut.jams_stretched", stretch=as_cut.stretch, **angles)]


def _of_strain(plan: CutPlan, report: PlanReport, as_cut: AsCut | None) -> list[Problem]:
    """One problem for connectors that break, by the larger of planned and simulated strain."""
    planned = [problem for problem in report.problems if problem.code in STRAINED]
    found = [{name: problem.fields[name] for name in STRAIN_FIELDS} for problem in planned]
    if as_cut is not None and as_cut.survival.breaks:
        found.append(dict(strain_note(plan.material, as_cut.survival).fields))
    return _strained(found, planned[0].where if planned else None)


def _of_expected_strain(material: Material, as_cut: AsCut) -> list[Problem]:
    found = as_cut.survival
    return _strained([strain_note(material, found).fields] if found.breaks else [])


def _strained(found: Sequence[Mapping[str, object]], where: tuple[float, float] | None = None) -> list[Problem]:
    """One sentence for connectors that break, of the strain that is furthest above its limit."""
    if not found:
        return []
    worst = max(found, key=lambda fields: float(str(fields["strain_percent"])) / float(str(fields["limit_percent"])))
    return [Problem.error("as_cut.breaks", where, **worst)]


def _strain_notes(plan: CutPlan, as_cut: AsCut | None) -> list[Note]:
    """Note on the strain that a sheet survives, and whether its connectors stay bent."""
    if as_cut is None or as_cut.survival.breaks:
        return []
    return [strain_note(plan.material, as_cut.survival)]
