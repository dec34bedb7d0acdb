"""The target: its sources, its drawing board, the designs that a change of it discards; and the start beside it."""

from __future__ import annotations

import math
from collections.abc import Callable
from functools import partial

from PySide6.QtCore import QObject

from kirigami_studio.foundation.errors import KirigamiError
from kirigami_studio.foundation.words import tr
from kirigami_studio.gui.run.settings_editor import SettingsEditor
from kirigami_studio.gui.run.settings_panel import SettingsPanel
from kirigami_studio.gui.run.start_tile import StartTile
from kirigami_studio.gui.session.collection import DiscardedDesigns
from kirigami_studio.gui.session.messages import Message, Tone
from kirigami_studio.gui.session.session import Session
from kirigami_studio.gui.target.design_preview import DesignPreview
from kirigami_studio.gui.target.pasting import PasteReader
from kirigami_studio.gui.target.reshaping import TargetReshaper
from kirigami_studio.gui.target.sketch_context import Change
from kirigami_studio.gui.target.target_panel import DONE_HINT, TargetPanel
from kirigami_studio.gui.target.target_view import Tool
from kirigami_studio.gui.target.targeting import StartReader, Targeting
from kirigami_studio.gui.widgets.readable import rough_time
from kirigami_studio.outlines.outline import Outline
from kirigami_studio.outlines.starts import StartShape
from kirigami_studio.project import edits
from kirigami_studio.project.document import Document
from kirigami_studio.project.sheet_size import size_of, target_as_cut
from kirigami_studio.settings.design import USUAL_GRID
from kirigami_studio.studio.cutting import expected_seconds, times_too_small
from kirigami_studio.studio.designing import limit_of
from kirigami_studio.studio.two_states import flat_size, starts_as

#: Seconds of cutting from which on it is said before a run.
LONG_CUT = 2.0 * 3600.0


class TargetPresenter(QObject):
    """Shows the target, takes drawings over, and withdraws errors that no longer apply.

    Parameters
    ----------
    pasting : PasteReader
        Reads what is dropped on the panel.
    """

    def __init__(
        self,
        panel: TargetPanel,
        session: Session,
        *,
        targeting: Targeting,
        pasting: PasteReader,
        preview: DesignPreview,
        undo: Callable[[], None],
    ) -> None:
        super().__init__(panel)
        self._panel, self._session, self._targeting = panel, session, targeting
        self._errors: list[Message] = []
        self._grid: tuple[int, int] | None = None
        self._question: Message | None = None
        self._asked_in = 0  # which project the question is about
        self._offered: Outline | None = None
        self._shown = Document()
        self._size = size_of(self._shown)
        self.reshaping = TargetReshaper(panel.view.context, session, self)
        self.discarded = DiscardedDesigns(session, self)
        self.discarded.undo_wanted.connect(undo)
        self._connect_sources(pasting)
        self._connect_board()
        self._connect_preview(preview)
        self._show_target(session.document)

    def _connect_sources(self, pasting: PasteReader) -> None:
        panel, targeting = self._panel, self._targeting
        panel.buttons["clearTarget"].clicked.connect(targeting.clear)
        panel.fill.toggled.connect(self._fill_holes)
        panel.view.drops.content_dropped.connect(pasting.take)
        panel.threshold.changed.connect(targeting.change_threshold)
        panel.threshold.automatic.clicked.connect(lambda: targeting.change_threshold(None))
        panel.threshold.edited.connect(targeting.tracer.end_drag)
        targeting.reader.failed.connect(self._note_unread)
        targeting.source_read.connect(self._drop_errors)
        targeting.question_wanted.connect(self._ask)
        targeting.on_board = self._on_board

    def _connect_board(self) -> None:
        panel, reshaping = self._panel, self.reshaping
        panel.view.context.changed.connect(reshaping.take)
        panel.view.context.guides_changed.connect(self._take_guides)
        panel.view.hint.connect(self._show_hint)
        panel.tools.mirror_wanted.connect(reshaping.mirror)
        panel.refine.proposed.connect(reshaping.propose)
        panel.refine.refined.connect(reshaping.refine)
        panel.refine.size_wanted.connect(reshaping.resize)
        reshaping.edited.connect(self._targeting.reshape)
        reshaping.edited.connect(self._drop_errors)
        reshaping.refused.connect(self._refuse)
        reshaping.proposed.connect(panel.view.show_proposal)
        reshaping.restarted.connect(panel.refine.restart)

    def _connect_preview(self, preview: DesignPreview) -> None:
        self.reshaping.proposed.connect(preview.propose)
        preview.found.connect(self._panel.show_preview)
        preview.refused.connect(self._panel.show_no_preview)

    def _on_board(self, outline: Outline) -> Outline:
        """Lay a contour at another threshold on its picture, which lies still meanwhile."""
        picture = self._targeting.tracer.picture_of(outline)
        return self._panel.view.on_picture(outline, None if picture is None else picture.traced)

    def _fill_holes(self, on: bool) -> None:
        """Fill the target's holes, or open them again."""
        gesture, drawing = tr("Fill holes") if on else tr("Open holes"), self._panel.view.context.drawing
        if self._session.document.drawing:
            self.reshaping.take(Change(gesture, lambda: drawing.with_holes(on)))
        else:
            self._targeting.change_holes(on, gesture)

    def _take_guides(self, gesture: str) -> None:
        session = self._session
        context = self._panel.view.context
        session.apply(edits.set_guides(session.document, context.guides, gesture))
        if context.guides != session.document.guides:  # no room for more
            context.show_guides(session.document.guides)

    def _refuse(self, error: KirigamiError) -> None:
        """A shape could not be made; the message stays until one can be."""
        self._errors.append(Message(str(error), Tone.ERROR))
        self._session.refuse(error)

    def _note_unread(self, sentence: str, trace: str) -> None:
        """A file could not be read as a target; the message stays until there is another target."""
        self._errors.append(Message(sentence, Tone.ERROR, trace))

    def _ask(self, outline: Outline) -> None:
        """A target was read while there is one that was drawn by hand: ask what is to become of that."""
        self._drop_question()
        session, name = self._session, tr(outline.name)
        if session.document.drawing:
            sentence = tr(
                "The drawing board holds several objects. Replace them with {name}, or add {name} beside them?",
                name=name,
            )
        else:
            sentence = tr(
                "You drew or changed the target by hand. Replace it with {name}, or add {name} beside it?", name=name
            )
        actions = (
            (tr("Replace"), partial(self._answer, partial(self._targeting.set_target, outline))),
            (tr("Add beside"), partial(self._answer, partial(self._add_beside, outline))),
            (tr("Cancel"), partial(self._answer, lambda: session.set_status(tr("Nothing changed.")))),
        )
        self._offered = outline
        self._question, self._asked_in = Message(sentence, Tone.WARNING, actions=actions), session.project
        session.post(self._question)

    def _answer(self, act: Callable[[], None]) -> None:
        self._drop_question()
        act()

    def _drop_question(self) -> None:
        if self._question is not None:
            self._session.withdraw(self._question)
            self._question = None

    def _add_beside(self, outline: Outline) -> None:
        """Lay a target that was read on the board as one more object, selected, to be moved where it belongs."""
        targeting, panel = self._targeting, self._panel
        drawing = panel.view.context.drawing
        change = Change(tr("Add {name} beside", name=tr(outline.name)), lambda: drawing.beside(outline))
        if not self.reshaping.take(change):
            return
        targeting.source_read.emit(targeting.reader.source)
        panel.set_editing(True)
        panel.set_tool(Tool.POSE)
        panel.view.fit()

    def _drop_errors(self) -> None:
        for error in self._errors:
            self._session.withdraw(error)
        self._errors.clear()

    def _show_hint(self, text: str) -> None:
        if text == tr(DONE_HINT) and self._session.document.candidates:
            self._session.set_status("")
        elif text:
            self._session.set_status(text)

    def show_document(self, document: Document) -> None:
        """Show target, objects and guides of the document, and drop questions that are settled."""
        before, self._shown = self._shown, document
        if self._question is not None and self._asked_in != self._session.project:
            self._drop_question()
        elif self._question is not None and not document.drawn_by_hand:
            self._drop_question()  # what was drawn is gone by another way, and with it what could be replaced
            if self._offered is not None:
                name = tr(self._offered.name)
                self._session.hint(tr("{name} was not taken. Open it again to use it.", name=name))
        drawn = document.target is not before.target or document.drawing != before.drawing or _moved(document, before)
        if drawn or size_of(document) != self._size:
            self._show_target(document)
        elif document.settings.grid != before.settings.grid:
            self._panel.show_reach(document.settings.grid)
        limit = limit_of(document)
        self._panel.show_limit("" if limit is None else limit.text)
        self._show_cutting_time(document)
        if document.guides != before.guides:
            self._panel.view.context.show_guides(document.guides)

    def expect_grid(self, grid: tuple[int, int] | None) -> None:
        """Take the grid that the next run will choose, None where that is not known."""
        if grid != self._grid:
            self._grid = grid
            self._show_cutting_time(self._session.document)

    def _show_cutting_time(self, document: Document) -> None:
        """Warn before a run of a sheet too small for its connectors, or of hours of cutting."""
        settings = document.settings
        grid = (self._grid or USUAL_GRID) if settings.auto_grid else settings.grid
        if document.target is None or document.candidates:
            self._panel.show_cutting_time("", "")
            return
        cut = document.fabrication
        times = times_too_small(cut, grid, settings.start)
        if times > 1.0:
            sentence = tr(
                "This size is too small for connectors in this material on {rows} \N{MULTIPLICATION SIGN} "
                "{columns} voids: make it {times:.1f} times larger, or take fewer voids.",
                rows=grid[0],
                columns=grid[1],
                times=math.ceil(10.0 * times) / 10.0,
            )
            self._panel.show_cutting_time(sentence, tr("Too small for this material."))
            return
        seconds = expected_seconds(cut, grid)
        if seconds < LONG_CUT:
            self._panel.show_cutting_time("", "")
            return
        time = rough_time(seconds)
        sentence = tr("The machine will cut for about {time}. A smaller sheet, or fewer voids, takes less.", time=time)
        self._panel.show_cutting_time(sentence, tr("Cutting takes about {time}.", time=time))

    def _show_target(self, document: Document) -> None:
        panel = self._panel
        picture = self._targeting.tracer.picture_of(document.target)
        target, drawing = target_as_cut(document)
        self._size = size_of(document)
        panel.show_target(target, picture, drawing, document.target)
        self.reshaping.follow()
        panel.show_reach(document.settings.grid)
        self._show_cutting_time(document)


def _moved(document: Document, before: Document) -> bool:
    """Whether other objects are there: equal ones may lie elsewhere."""
    return any(one is not other for one, other in zip(document.drawing, before.drawing, strict=False))


class StartPresenter(QObject):
    """Shows the start beside the target.

    Parameters
    ----------
    settings : SettingsPanel
        Has the list of starts, and the grid that a plain rectangle follows.
    """

    def __init__(
        self, tile: StartTile, settings: SettingsPanel, session: Session, reader: StartReader, editor: SettingsEditor
    ) -> None:
        super().__init__(tile)
        self._tile, self._settings, self._session, self._editor = tile, settings, session, editor
        tile.chosen.connect(self._choose)
        tile.drops.file_dropped.connect(reader.open)
        self.show()

    def _choose(self, start: StartShape) -> None:
        self._editor.change(start=start)
        self._session.history.end_drag()

    def show(self) -> None:
        """Show the present start, as large as the sheet on the stage that began as it."""
        grid = (self._settings.rows.value(), self._settings.columns.value())  # which the next run will choose, too
        document, stage = self._session.document, self._session.stage
        start, flat = document.settings.start, None
        if stage is not None and starts_as(stage.candidate, start):
            flat = flat_size(stage.design.deployment, self._session.width_of(stage.candidate))
        self._tile.show_start(start, grid, document.fabrication.width_mm, flat)
