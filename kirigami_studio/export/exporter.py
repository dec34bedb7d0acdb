"""The request for every kind of file."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace

from kirigami_studio.assembly.posed_pieces import PosedPieces
from kirigami_studio.assembly.solids import Printing
from kirigami_studio.evaluate.candidate import Candidate
from kirigami_studio.evaluate.posed_design import PosedDesign
from kirigami_studio.evaluate.similarity import Similarity
from kirigami_studio.evaluate.trimming import Trim
from kirigami_studio.export.artwork import Artwork
from kirigami_studio.export.cut_motion import CutMotion
from kirigami_studio.export.paper import Paper
from kirigami_studio.export.profile import DEFAULT_PROFILE, DxfVersion
from kirigami_studio.fabricate.cut_plan import CutPlan
from kirigami_studio.foundation.arrays import ShapeRings
from kirigami_studio.foundation.errors import ExportError
from kirigami_studio.foundation.frozen_mapping import FrozenMapping
from kirigami_studio.lattice.deployment import Deployment, deploy


@dataclass(frozen=True, slots=True, eq=False)
class ExportJob:
    """All that any kind of file may need."""

    deployment: Deployment
    phi: float = 0.0  #: radians; target angle
    plan: CutPlan | None = None  #: Needed by cut files (DXF, SVG, PDF)
    target: ShapeRings = None  #: (L, 2), and its holes; target outline, drawn behind pictures
    transform: Similarity = field(default_factory=Similarity)  #: Takes the layout's frame at ``phi`` to the target's
    dxf_version: DxfVersion = DxfVersion.R2010
    profile: str = DEFAULT_PROFILE  #: Key of the machine profile
    paper: Paper = Paper.NONE  #: Paper; that a PDF is spread over
    #: Where the design comes from: version of the program, name and hash of the model, seed, settings; every file
    #: repeats it
    provenance: Mapping[str, str] = field(default_factory=FrozenMapping)
    trim: Trim | None = None  #: What was cut off the edge panels; pictures show what stays
    markers: bool = False  #: A LightBurn project also marks the connectors, on a layer that LightBurn does not cut
    motion: CutMotion | None = None  #: What pictures and animations show: the sheet as cut; None for its ideal motion
    picture_phi: float | None = None  #: radians; angle that pictures show; the target angle unless given
    width_mm: float = 100.0  #: Of the flat sheet, before trimming
    artwork: Artwork | None = None  #: What is printed on the sheet; only a whole set of files has it
    record: bytes = b""  #: The design as a packed project, which DXF and SVG cut files carry; empty for none
    #: radians; where the planned sheet jams by its simulation, 0 if it closes; None where nobody has looked
    simulated_jam: float | None = None
    verdict: str = ""  #: Level of the verdict on the sheet, which every file repeats; "" where nobody has judged it
    #: How files of solids are made: the planned sheet, as thick as its material, unless given
    printing: Printing = field(default_factory=Printing)
    thickness_mm: float = 1.0  #: Of the material, for models of rigid parts
    pieces: PosedPieces | None = None  #: Shown in pictures of a design that is made of pieces, not its panels
    match: float | None = None  #: 0..1; IoU of its pieces with the target; None where the sheet's own is shown

    @classmethod
    def of(cls, candidate: Candidate, target: ShapeRings, plan: CutPlan | None = None) -> ExportJob:
        """The job of a candidate with its final sheet, pose and angle, trimmed if it is."""
        motion = deploy(candidate.final_sheet)
        return cls(motion, candidate.final_phi, plan, target, candidate.final_pose, trim=candidate.trim)

    @property
    def required_plan(self) -> CutPlan:
        """The plan, with the provenance of its design and the verdict on it.

        Raises
        ------
        ExportError
            The job has none.
        """
        if self.plan is None:
            raise ExportError("export.no_plan")
        origin = self.provenance or self.plan.origin
        return replace(self.plan, origin=origin, verdict=self.verdict or self.plan.verdict)

    @property
    def shown_phi(self) -> float:
        """Angle (radians) that pictures show."""
        return self.phi if self.picture_phi is None else self.picture_phi

    @property
    def posed(self) -> PosedDesign:
        """The moving sheet over its target; ask once for a whole animation.

        With a plan, or a motion as cut, it is the sheet that is cut, else the design, as the window shows it.
        """
        design = PosedDesign(self.deployment, self.transform, self.phi, self.trim)
        made = self.motion.made if self.motion is not None else None if self.plan is None else self.plan.made
        return design if made is None else design.laid_over(made)
