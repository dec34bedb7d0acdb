"""The target: its sources, its drawing board, the designs that a change of it discards; the start beside it; and the
second target.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from typing import TYPE_CHECKING

from PySide6.QtCore import QObject

from kirigami_studio.foundation.errors import KirigamiError
from kirigami_studio.foundation.words import tr
from kirigami_studio.gui.run.start_tile import DRAWN_START, FILE_START, LIBRARY_START, PAIRS
from kirigami_studio.gui.session.collection import DiscardedDesigns
from kirigami_studio.gui.session.messages import Message, Tone
from kirigami_studio.gui.target.reshaping import TargetReshaper
from kirigami_studio.gui.target.sketch_context import Change
from kirigami_studio.gui.target.target_view import Tool
from kirigami_studio.gui.window.controller import Controller
from kirigami_studio.outlines.outline import Outline
from kirigami_studio.outlines.starts import StartShape
from kirigami_studio.project import edits
from kirigami_studio.project.document import Document
from kirigami_studio.studio.parts import Purpose
from kirigami_studio.studio.two_states import flat_size, starts_as

if TYPE_CHECKING:
    from kirigami_studio.gui.window.main_window import MainWindow


class TargetConnections(QObject):
    """Connects the target panel with the controller, and withdraws error messages that no longer apply."""

    def __init__(self, window: MainWindow, controller: Controller) -> None:
        super().__init__(window)
        self._window = window
        self._controller = controller
        self._errors: list[Message] = []
        self._question: Message | None = None
        self._asked_in = 0  # which project the question is about
        self._offered: Outline | None = None
        self._shown = Document()
        self.reshaping = TargetReshaper(window.target.view.context, controller.session, self)
        self.discarded = DiscardedDesigns(controller.session, self)
        self._connect_sources()
        self._connect_board()
        self.discarded.undo_wanted.connect(controller.undo)
        controller.session.document_changed.connect(self._show_document)
        self._show_target(controller.document)

    def _connect_sources(self) -> None:
        window, targeting = self._window, self._controller.targeting
        window.target.open_wanted.connect(window.files.ask_target)
        window.target.wants_silhouette.connect(window.dialogs.show_library)
        window.target.clear_wanted.connect(targeting.clear)
        window.target.view.file_dropped.connect(window.files.open)
        window.target.view.content_dropped.connect(window.pasting.take)
        window.target.threshold.changed.connect(targeting.change_threshold)
        window.target.threshold.automatic_wanted.connect(lambda: targeting.change_threshold(None))
        window.target.threshold.edited.connect(targeting.tracer.end_drag)
        targeting.reader.design_read.connect(window.files.open_design)
        ask, reader = window.dialogs.show_parts, targeting.reader
        reader.choice_wanted.connect(partial(ask, Purpose.TARGET, reader.take_chosen))
        targeting.reader.failed.connect(self._note_unread)
        targeting.source_read.connect(self._drop_errors)
        targeting.question_wanted.connect(self._ask)

    def _connect_board(self) -> None:
        window, controller, reshaping = self._window, self._controller, self.reshaping
        window.target.view.context.changed.connect(reshaping.take)
        window.target.view.context.guides_changed.connect(self._take_guides)
        window.target.view.hint.connect(self._show_hint)
        window.target.tools.mirror_wanted.connect(reshaping.mirror)
        window.target.refine.previewed.connect(reshaping.preview)
        window.target.refine.refined.connect(reshaping.refine)
        window.target.refine.size_wanted.connect(reshaping.resize)
        reshaping.edited.connect(controller.targeting.reshape)
        reshaping.edited.connect(self._drop_errors)
        reshaping.refused.connect(self._refuse)
        reshaping.previewed.connect(window.target.view.show_preview)
        reshaping.restarted.connect(window.target.refine.restart)
        controller.run.started.connect(lambda _: window.target.set_editing(False))

    def _take_guides(self, gesture: str) -> None:
        session = self._controller.session
        context = self._window.target.view.context
        session.apply(edits.set_guides(session.document, context.guides, gesture))
        if context.guides != session.document.guides:  # no room for more
            context.show_guides(session.document.guides)

    def _refuse(self, error: KirigamiError) -> None:
        """A shape could not be made; the message stays until one can be."""
        self._errors.append(Message(str(error), Tone.ERROR))
        self._controller.session.refuse(error)

    def _note_unread(self, sentence: str, trace: str) -> None:
        """A file could not be read as a target; the message stays until there is another target."""
        self._errors.append(Message(sentence, Tone.ERROR, trace))

    def _ask(self, outline: Outline) -> None:
        """A target was read while there is one that was drawn by hand: ask what is to become of that."""
        self._drop_question()
        session, name = self._controller.session, tr(outline.name)
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
            (tr("Replace"), partial(self._answer, partial(self._controller.targeting.set_target, outline))),
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
            self._window.messages.drop(self._question)
            self._question = None

    def _add_beside(self, outline: Outline) -> None:
        """Lay a target that was read on the board as one more object, selected, to be moved where it belongs."""
        targeting, panel = self._controller.targeting, self._window.target
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
            self._window.messages.drop(error)
        self._errors.clear()

    def _show_hint(self, text: str) -> None:
        if text:
            self._window.status_text.setText(text)

    def _show_document(self, document: Document) -> None:
        before, self._shown = self._shown, document
        if self._question is not None and self._asked_in != self._controller.session.project:
            self._drop_question()
        elif self._question is not None and not document.drawn_by_hand:
            self._drop_question()  # what was drawn is gone by another way, and with it what could be replaced
            if self._offered is not None:
                name = tr(self._offered.name)
                sentence = tr("{name} was not taken. Open it again to use it.", name=name)
                self._controller.session.post(Message(sentence, Tone.HINT))
        if document.target is not before.target or document.drawing != before.drawing or _moved(document, before):
            self._show_target(document)
        elif document.settings.grid != before.settings.grid:
            self._window.target.show_reach(document.settings.grid)
        if document.guides != before.guides:
            self._window.target.view.context.show_guides(document.guides)

    def _show_target(self, document: Document) -> None:
        panel = self._window.target
        picture = self._controller.targeting.tracer.picture_of(document.target)
        panel.show_target(document.target, picture, document.drawing)
        self.reshaping.follow()
        panel.show_reach(document.settings.grid)


def _moved(document: Document, before: Document) -> bool:
    """Whether other objects are there: equal ones may lie elsewhere."""
    return any(one is not other for one, other in zip(document.drawing, before.drawing, strict=False))


class StartConnections(QObject):
    """Connects the tile beside the target and the settings' list of starts with the controller."""

    def __init__(self, window: MainWindow, controller: Controller) -> None:
        super().__init__(window)
        self._window = window
        self._controller = controller
        self._open = {
            LIBRARY_START: lambda: window.dialogs.show_start_library(window.settings.start),
            FILE_START: lambda: window.files.ask_start(),
            DRAWN_START: lambda: window.dialogs.show_start_board(),
            PAIRS: lambda: window.dialogs.show_pairs(),
        }
        tile = window.target.start
        tile.chosen.connect(self._choose)
        tile.file_dropped.connect(controller.start.open)
        tile.other_wanted.connect(self.open_other)
        ask, reader = window.dialogs.show_parts, controller.start
        reader.choice_wanted.connect(partial(ask, Purpose.START, reader.take_chosen))
        window.settings.other_start_wanted.connect(self.open_other)
        controller.reader.known.connect(lambda _: self._show(controller.document))
        controller.session.document_changed.connect(self._show)
        controller.session.display.stage_changed.connect(lambda _: self._show(controller.document))
        self._show(controller.document)

    def open_other(self, kind: str) -> None:
        """Open the library, a file, the board or the pairs."""
        self._open[kind]()

    def _choose(self, start: StartShape) -> None:
        self._controller.change_settings(start=start)
        self._controller.end_drag()

    def _show(self, document: Document) -> None:
        settings = self._window.settings
        grid = (settings.rows.value(), settings.columns.value())  # the one that the next run will choose, too
        start, width_mm = document.settings.start, document.fabrication.width_mm
        stage, flat = self._controller.stage, None
        if stage is not None and starts_as(stage.candidate, start):
            flat = flat_size(stage.design.deployment, self._controller.session.width_of(stage.candidate))
        self._window.target.start.show_start(start, grid, width_mm, flat)


class SecondConnections(QObject):
    """Connects the second target among the settings with the controller."""

    def __init__(self, window: MainWindow, controller: Controller) -> None:
        super().__init__(window)
        row = window.settings.second
        self._open = {
            LIBRARY_START: lambda: window.dialogs.show_second_library(row.shape),
            FILE_START: lambda: window.files.ask_second(),
            DRAWN_START: lambda: window.dialogs.show_second_board(),
        }
        row.other_wanted.connect(lambda kind: self._open[kind]())
        row.file_dropped.connect(controller.second.open)
        ask, reader = window.dialogs.show_parts, controller.second
        reader.choice_wanted.connect(partial(ask, Purpose.SECOND, reader.take_chosen))
