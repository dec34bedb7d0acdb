"""The verdict on a sheet that is to be cut: ready to cut, cut with care, or will not work, with all reasons in order.

It is made of what reading the file back found, what the check of the plan found, how the sheet does as cut, and what
the material bears.  Window, report, record and command line show this one list.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Generator, Iterable, Sequence
from dataclasses import dataclass, replace
from enum import Enum
from typing import TYPE_CHECKING, TypeVar

from kirigami_studio.evaluate.candidate import Candidate
from kirigami_studio.fabricate.checks import PlanReport, check_plan
from kirigami_studio.fabricate.cut_plan import CutPlan
from kirigami_studio.fabricate.findings import Note, Problem, Severity
from kirigami_studio.fabricate.strain import StrainFigure, strain_note
from kirigami_studio.foundation.errors import Cancelled, KirigamiError
from kirigami_studio.foundation.steps import result_of
from kirigami_studio.foundation.words import mark, tr
from kirigami_studio.lattice.deployment import Deployment, deploy
from kirigami_studio.outlines.outline import Outline
from kirigami_studio.settings.fabrication import FabricationSettings
from kirigami_studio.studio.as_cut import CLOSE_TO, ESTIMATE_CLOSES, AsCut, Outcome, simulate
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
TOO_SMALL = frozenset({"plan.panel_edge_small", "plan.panel_neck_small", "plan.trimmed_neck_small"})
#: Notes of a plan that mean that a person does not get what was asked for.
NOT_AS_ASKED = frozenset({"plan.connectors_narrowed"})
#: Signs of a jam that count only where nobody has closed the sheet on its connectors.
SIGNS_OF_A_JAM = frozenset(
    {
        "plan.off_centre",
        "plan.no_room_to_centre",
        "plan.no_room_made_in_trimmed",
        "verify.voids_miss",
        "verify.sheet_jams",
    }
)
#: Worth that a connector which stretches by its whole width costs: where designs match alike, calm connectors decide.
STRETCH = 0.05
#: Of a sheet that comes within a few degrees of its angle.
NEARLY = "as_cut.nearly"
#: Warnings about a file that are about importing it, not about the sheet.
ABOUT_IMPORTING = frozenset({"verify.no_unit_in_r12"})


class Level(Enum):
    """What is to be expected; the values are the names in JSON."""

    READY = "ready_to_cut"
    CARE = "cut_with_care"
    FAILS = "will_not_work"

    @property
    def words(self) -> str:
        """As a person reads it."""
        return tr(_WORDS[self])


_WORDS = {Level.READY: mark("Ready to cut"), Level.CARE: mark("Cut with care"), Level.FAILS: mark("Will not work")}
Told = TypeVar("Told", bound=Note)
#: From best to worst.
RANK = {level: place for place, level in enumerate(Level)}


@dataclass(frozen=True, slots=True)
class Verdict:
    """What is to be expected of a sheet, and why.

    Attributes
    ----------
    problems : tuple of Problem
        Worst first.  With an error the sheet will not work, with a warning it is cut with care.
    notes : tuple of Note
        What is worth knowing beside them.
    """

    problems: tuple[Problem, ...] = ()
    notes: tuple[Note, ...] = ()

    @property
    def level(self) -> Level:
        """By the worst of the problems."""
        if not self.problems:
            return Level.READY
        return Level.FAILS if self.problems[0].severity is Severity.ERROR else Level.CARE

    @property
    def ok(self) -> bool:
        """Ready to cut, without a problem."""
        return self.level is Level.READY

    @property
    def lines(self) -> tuple[str, ...]:
        """The list that is shown everywhere: its level, then every problem, then every note."""
        return (self.level.words, *(problem.text for problem in self.problems), *(note.text for note in self.notes))

    def better_than(self, other: Verdict) -> bool:
        """Whether less is to be feared."""
        return RANK[self.level] < RANK[other.level]

    def to_json(self) -> dict[str, object]:
        """For the record and the command line."""
        return {
            "level": self.level.value,
            "ok": self.ok,
            "problems": [
                {
                    "severity": problem.severity.value,
                    "code": problem.code,
                    "text": problem.text,
                    "where": None if problem.where is None else [float(side) for side in problem.where],
                }
                for problem in self.problems
            ],
            "notes": [note.text for note in self.notes],
        }


@dataclass(frozen=True, slots=True, eq=False)
class Assessment:
    """A design whose cuts were planned, checked, and closed on their connectors.

    Attributes
    ----------
    plan : CutPlan
    report : PlanReport
    as_cut : AsCut or str
        How the sheet does as cut, or a sentence on why that cannot be told.
    verdict : Verdict
    """

    plan: CutPlan
    report: PlanReport
    as_cut: AsCut | str
    verdict: Verdict


def assess(
    candidate: Candidate,
    settings: FabricationSettings,
    target: Outline | None = None,
    deployment: Deployment | None = None,
    planned: tuple[CutPlan, PlanReport] | None = None,
    verifications: Sequence[Verification] = (),
) -> Assessment:
    """Plan the cuts of a design, check them, close the sheet on its connectors, and judge, all in one go.

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
        planned = plan, check_plan(plan, phi=candidate.final_phi)
    plan, report = planned
    as_cut = closed_as_cut(candidate, motion, plan, settings.width_mm, target)
    return Assessment(plan, report, as_cut, judge(candidate, plan, report, as_cut, verifications))


def closed_as_cut(
    candidate: Candidate, deployment: Deployment, plan: CutPlan, width_mm: float, target: Outline | None = None
) -> AsCut | str:
    """How a planned sheet of a width (mm) does as cut, simulated in one go, or why that cannot be told."""
    return result_of(closing_as_cut(candidate, deployment, plan, width_mm, target))


def closing_as_cut(
    candidate: Candidate, deployment: Deployment, plan: CutPlan, width_mm: float, target: Outline | None = None
) -> Generator[None, None, AsCut | str]:
    """The same step by step."""
    kept = None if candidate.trim is None else candidate.trim.kept
    try:
        sheet = yield from simulate(deployment, plan, width_mm, candidate.final_phi, target, kept)
    except KirigamiError as error:
        return str(error)
    return sheet.as_cut


@dataclass(frozen=True, slots=True)
class CloseLook:
    """What a close look at a design found.

    Attributes
    ----------
    refusal : Note or None
        Why it cannot be cut; None where it can: its cuts can be planned, the sheet comes to its angle, no connector
        breaks and no panel is too small.
    as_cut : AsCut or None
        How it does as cut; None where nobody had to look so far, or where that cannot be told.
    """

    refusal: Note | None
    as_cut: AsCut | None = None

    @property
    def loss(self) -> float:
        """Worth (IoU) that the design loses by being cut: match, and for the stretch of its connectors."""
        if self.as_cut is None:
            return 0.0
        iou, ideal = self.as_cut.iou, self.as_cut.ideal_iou
        missed = 0.0 if iou is None or ideal is None else max(0.0, ideal - iou)
        return missed + STRETCH * self.as_cut.stretch


def look_at(candidate: Candidate, settings: FabricationSettings, target: Outline | None = None) -> CloseLook:
    """Plan and check the cuts of a design as these settings ask for, and close it on its connectors, in one go."""
    return result_of(looking(candidate, settings, target))


def looking(
    candidate: Candidate,
    settings: FabricationSettings,
    target: Outline | None = None,
    cancel: Callable[[], bool] = lambda: False,
) -> Generator[None, None, CloseLook]:
    """Look at a design closely, see :func:`look_at`; yields between the steps, for others to have their turn.

    Raises
    ------
    Cancelled
        ``cancel`` returned true.
    """
    try:
        motion = deploy(candidate.final_sheet)
        plan = plan_of(candidate, settings, motion, cancel)
    except Cancelled:
        raise
    except KirigamiError as error:
        return CloseLook(Note(error.code, error.fields))
    yield
    report = check_plan(plan, phi=candidate.final_phi)
    found = judge(candidate, plan, report, None)
    small = next((problem for problem in found.problems if problem.code in TOO_SMALL), None)
    if found.level is Level.FAILS or small is not None:
        return CloseLook(small or found.problems[0])
    as_cut = yield from closing_as_cut(candidate, motion, plan, settings.width_mm, target)
    new = (one for one in judge(candidate, plan, report, as_cut).problems if one not in found.problems)
    refusal = next((problem for problem in new if problem.code != NEARLY), None)
    return CloseLook(refusal, None if isinstance(as_cut, str) else as_cut)


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
    """Judge a sheet by everything that is known of it.

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
        *(_weighed(problem) for problem in report.problems if problem.code not in STRAINED),
        *_of_wishes(plan),
        *([] if known is None else _of_jam(known)),
        *_of_strain(plan, report, known),
    ]
    if isinstance(as_cut, str):
        problems.append(Problem.warning("as_cut.not_known", reason=as_cut))
    warned = (note for one in verifications for note in one.warnings)
    notes: list[Note] = [*plan.notes, *_strain_notes(plan, known), *warned]
    if known is not None and known.closes:
        notes = [note for note in notes if note.code not in SIGNS_OF_A_JAM]
    worst_first = sorted(problems, key=lambda problem: problem.severity is not Severity.ERROR)
    told = {problem.text for problem in worst_first}
    return Verdict(tuple(_once(worst_first)), tuple(note for note in _once(notes) if note.text not in told))


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
    return [] if candidate.score.feasible or candidate.trim is not None else [Problem.error("rank.not_feasible")]


def _of_files(verifications: Sequence[Verification], phi: float, as_cut: AsCut | None) -> list[Problem]:
    """What two readers found in the files, once where several have it, and jams that only a file shows."""
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
            jams.append(Problem.warning("as_cut.file_jams", name=one.path.name, jam_deg=math.degrees(jam)))
    found = [
        Problem("verify.in_file", {"name": ", ".join(files), "finding": text}, severity)
        for (severity, text), files in names.items()
    ]
    return [*found, *jams[:1]]


def _of_jam(as_cut: AsCut) -> list[Problem]:
    if as_cut.closes:
        return []
    angles = {"jam_deg": math.degrees(as_cut.jam_phi), "phi_deg": math.degrees(as_cut.phi)}
    if as_cut.jam_phi <= as_cut.phi + ESTIMATE_CLOSES:
        return [Problem.warning(NEARLY, **angles)]
    if as_cut.figure is StrainFigure.OUT_OF_PLANE:
        return [Problem.warning("as_cut.jams_while_flat", **angles)]
    if as_cut.outcome is Outcome.TOUCHING:
        return [Problem.error("as_cut.jams_touching", **angles)]
    return [Problem.error("as_cut.jams_stretched", stretch=as_cut.stretch, **angles)]


def _of_strain(plan: CutPlan, report: PlanReport, as_cut: AsCut | None) -> list[Problem]:
    """One sentence for connectors that break, by the larger of the plan's estimate and the simulated strain."""
    planned = [problem for problem in report.problems if problem.code in STRAINED]
    found = [{name: problem.fields[name] for name in STRAIN_FIELDS} for problem in planned]
    if as_cut is not None and as_cut.survival.breaks:
        found.append(dict(strain_note(plan.material, as_cut.survival).fields))
    if not found:
        return []
    worst = max(found, key=lambda fields: float(str(fields["strain_percent"])) / float(str(fields["limit_percent"])))
    return [Problem.error("as_cut.breaks", planned[0].where if planned else None, **worst)]


def _strain_notes(plan: CutPlan, as_cut: AsCut | None) -> list[Note]:
    """Note on the strain that a sheet survives, and whether its connectors stay bent."""
    if as_cut is None or as_cut.survival.breaks:
        return []
    return [strain_note(plan.material, as_cut.survival)]
