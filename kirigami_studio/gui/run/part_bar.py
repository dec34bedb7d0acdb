"""The parts of a target of several pieces: which one is shown, and how far each is."""

from __future__ import annotations

from PySide6.QtCore import QObject, QSignalBlocker, Qt, Signal
from PySide6.QtWidgets import QSizePolicy, QTabBar, QToolButton

from kirigami_studio.foundation.words import tr
from kirigami_studio.gui.run.generation import Generation
from kirigami_studio.gui.session.session import Session
from kirigami_studio.gui.stage.hand_editor import HandEditor
from kirigami_studio.project import target_parts
from kirigami_studio.project.document import Document

#: Letters of a name on a tab.
LONGEST = 24


class PartBar(QTabBar):
    """A tab for each part of the target; out of sight for a target of one."""

    part_wanted = Signal(int)  #: place of a part among all

    def __init__(self) -> None:
        super().__init__()
        self.setObjectName("partBar")
        self.setAccessibleName(tr("Parts of the target"))
        self.setToolTip(tr("The parts of the target: each is a sheet of its own, all open to one scale."))
        self.setDrawBase(False)
        self.setExpanding(False)
        self.setUsesScrollButtons(True)
        self.setElideMode(Qt.TextElideMode.ElideRight)
        self.setSizePolicy(QSizePolicy.Policy.Ignored, QSizePolicy.Policy.Fixed)
        for name, text in (("ScrollLeftButton", tr("Earlier parts")), ("ScrollRightButton", tr("Later parts"))):
            button = self.findChild(QToolButton, name)
            if isinstance(button, QToolButton):  # Qt has no translation of its own for them
                button.setAccessibleName(text)
        self.setVisible(False)
        self.currentChanged.connect(self.part_wanted.emit)

    def show_parts(self, document: Document) -> None:
        """Show the parts of a document, and which of them is shown."""
        texts = [text_of(part) for part in document.parts] if document.other_parts else []
        with QSignalBlocker(self):
            while self.count() > len(texts):
                self.removeTab(self.count() - 1)
            while self.count() < len(texts):
                self.addTab("")
            for number, text in enumerate(texts):
                if self.tabText(number) != text:
                    self.setTabText(number, text)
            if texts:
                self.setCurrentIndex(document.part)
        self.setVisible(bool(texts))


def text_of(part: Document) -> str:
    """Name of a part, and the match of its chosen design, for a tab."""
    name = "" if part.target is None else tr(part.target.name)
    short = name if len(name) <= LONGEST else name[: LONGEST - 1] + "\N{HORIZONTAL ELLIPSIS}"
    shown = short.replace("&", "&&")  # or Qt takes it for a shortcut
    chosen = part.candidate
    if chosen is None:
        return tr("{name}  \N{MIDDLE DOT}  no design yet", name=shown)
    return tr("{name}  \N{MIDDLE DOT}  {percent:.1f} %", name=shown, percent=100.0 * chosen.match)


class PartPresenter(QObject):
    """Shows the part that is asked for, unless a run is under way, which has a part of its own."""

    def __init__(self, bar: PartBar, session: Session, generation: Generation, hand: HandEditor) -> None:
        super().__init__(bar)
        self._bar, self._session, self._run, self._hand = bar, session, generation.run, hand
        bar.part_wanted.connect(self.show_part)

    def show_part(self, number: int) -> None:
        """Show another part with its designs."""
        if self._hand.postpones(lambda: self.show_part(number)):
            return
        session = self._session
        if not self._run.running and number != session.document.part:
            session.apply(target_parts.show_part(session.document, number))
            session.history.end_drag()

    def show_document(self, document: Document) -> None:
        """The document, or whether a run goes on, has changed."""
        self._bar.show_parts(document)
        self._bar.setEnabled(not self._run.running)
