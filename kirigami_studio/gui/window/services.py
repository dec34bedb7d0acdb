"""The services of one window, built on its session and closed with it."""

from __future__ import annotations

from PySide6.QtCore import QObject

from kirigami_studio.gui.files.open_project import OpenProject
from kirigami_studio.gui.gallery.chosen_design import ChosenDesign
from kirigami_studio.gui.make.cutting import CutPlanner, DesignExporter, FabricationEditor
from kirigami_studio.gui.make.verdict import VerdictKeeper
from kirigami_studio.gui.run.generation import Generation
from kirigami_studio.gui.run.look_alikes import LookAlikes
from kirigami_studio.gui.run.regularity import Regularity
from kirigami_studio.gui.run.settings_editor import SettingsEditor
from kirigami_studio.gui.run.target_reader import TargetReader
from kirigami_studio.gui.session.collection import DesignLabels, DesignMarks
from kirigami_studio.gui.session.session import Session
from kirigami_studio.gui.session.user_preferences import UserPreferences
from kirigami_studio.gui.stage.artwork import ArtworkKeeper
from kirigami_studio.gui.stage.as_cut import AsCutEstimates, AsCutReader
from kirigami_studio.gui.stage.curves import CurveReader
from kirigami_studio.gui.stage.gripping import GripFinder
from kirigami_studio.gui.stage.hand_editor import HandEditor
from kirigami_studio.gui.stage.piece_reader import PieceReader
from kirigami_studio.gui.target.design_preview import DesignPreview
from kirigami_studio.gui.target.targeting import SecondReader, StartReader, Targeting


class Services(QObject):
    """Builds the session and all that works on it, with the project of an ``earlier`` window.

    Attributes
    ----------
    session : Session
        Document, history, stage; the others report to the user through it.
    preferences : UserPreferences
    settings, reader, generation, run, regularity, alikes
        How the next run searches, what the target's shape says before it; runs, and the designs that they bring.
    hand, curves, as_cut, grips, estimates, pieces, artwork
        What is done to the design on the stage, or found out about it.
    marks, labels, chosen
        The designs of the gallery, and work on the chosen one.
    fabrication, cutting, exporter, verdict
        The numbers a design is cut with, its plan, its files, and what is to be expected of the sheet.
    targeting, start, second, preview
        Read targets, start outlines and second targets; fit a sheet to the target while that changes.
    project : OpenProject
        Replaces the project, saves it, goes along its history.
    """

    def __init__(self, parent: QObject | None = None, earlier: Services | None = None) -> None:
        super().__init__(parent)
        self.session: Session = Session(self, None if earlier is None else earlier.session)
        session = self.session
        self.preferences = UserPreferences(session)
        self.marks, self.labels = DesignMarks(session), DesignLabels(session)
        self.hand = HandEditor(session, self)
        self.curves = CurveReader(session, self)
        self.generation = Generation(session, self.hand, self)
        self.run = self.generation.run
        self.reader = TargetReader(session, self)
        self.run.grid_chosen.connect(self.reader.read_again)
        self.regularity = Regularity(session, self)
        self.alikes = LookAlikes(session, self)
        self.fabrication = FabricationEditor(session, self.preferences.note_choice)
        self.cutting = CutPlanner(session, self)
        self.as_cut = AsCutReader(session, self)
        self.grips = GripFinder(session, self.as_cut, self)
        self.estimates = AsCutEstimates(session, self)
        self.pieces = PieceReader(session, lambda: self.run.running, self)
        self.verdict = VerdictKeeper(session, self.as_cut, self)
        self.exporter = DesignExporter(session, self.cutting, self.as_cut, self.hand, self.preferences, self)
        self.chosen = ChosenDesign(session, self.hand, self.generation, self.regularity, self)
        self.targeting = Targeting(session, self.run, self.stop, self)
        self.start = StartReader(session, self)
        self.second = SecondReader(session, self)
        self.preview = DesignPreview(session, self.run, self.preferences, self)
        self.settings = SettingsEditor(session, {"start": self.start.stop, "second": self.second.stop})
        self.artwork = ArtworkKeeper(session, self)
        self.project = OpenProject(session, self.targeting, self.hand, self.preferences, self.stop, self)
        if earlier is not None:
            self.targeting.remember_sources(earlier.targeting)
        self.hand.drafted.connect(self.stop_on_design)
        self.generation.begun.connect(self.stop_on_design)
        self.generation.begun.connect(self.preview.stop)
        self.cutting.answered.connect(self.as_cut.read)
        self.cutting.answered.connect(self.verdict.take_plan)
        self.cutting.answered.connect(self.pieces.take)
        self.cutting.answered.connect(self.artwork.take)
        self.cutting.refused.connect(self.as_cut.forget)
        self.cutting.not_planned.connect(self.verdict.take_refusal)
        self.verdict.judged.connect(self.estimates.take_verdict)
        self.pieces.judged.connect(self.estimates.take_verdict)
        self.exporter.exported.connect(self.verdict.take_export)

    def stop_on_design(self) -> None:
        """Stop the work on the chosen design, which is about to change."""
        self.regularity.stop()
        self.chosen.stop()
        self.as_cut.forget()
        self.verdict.forget()

    def stop(self) -> None:
        """Stop all work for the present document, as another one comes."""
        self.targeting.stop()
        self.start.stop()
        self.second.stop()
        self.artwork.stop()
        self.pieces.stop()
        self.hand.stop()
        self.stop_on_design()
        self.run.abandon()

    def close(self) -> None:
        """Stop all work, and end the worker; the window is going away."""
        self.reader.close()
        self.preview.close()
        self.cutting.close()
        self.estimates.close()
        self.pieces.stop()
        self.hand.close()
        self.session.queue.close()
        self.project.close()
