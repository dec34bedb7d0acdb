"""Saving the project, and asking before unsaved changes would be lost."""

from __future__ import annotations

from collections.abc import Callable

from PySide6.QtCore import QObject
from PySide6.QtWidgets import QWidget

from kirigami_studio.foundation.words import mark, tr
from kirigami_studio.gui.files.file_dialogs import FileDialogs
from kirigami_studio.gui.files.open_project import OpenProject
from kirigami_studio.gui.session.messages import Message, Tone
from kirigami_studio.gui.session.session import Session
from kirigami_studio.gui.stage.hand_editor import HandEditor
from kirigami_studio.studio.projects import ChangedOnDisk

#: How it is asked before another project replaces this one.
NEW_PROJECT = mark("This project has unsaved changes. Save before you start a new project?")
OTHER_PROJECT = mark("This project has unsaved changes. Save before you open another project?")
SAMPLE = mark("This project has unsaved changes. Save before you open the sample project?")
PAIR = mark("This project has unsaved changes. Save before you open an example?")
RECOVERED = mark("This project has unsaved changes. Save before you recover another project?")


class UnsavedWork(QObject):
    """Saves the project of one window, and asks in its message bar before it is replaced or the window closes."""

    def __init__(
        self, window: QWidget, session: Session, project: OpenProject, hand: HandEditor, ask: FileDialogs
    ) -> None:
        super().__init__(window)
        self._window, self._session, self._project, self._hand = window, session, project, hand
        self._file_dialogs = ask
        self._discarded = False  # the user closes without saving
        self._quit_when_saved = False
        self._questions: list[Message] = []
        session.document_changed.connect(self._drop_questions)
        project.saved.connect(self._close_when_saved)
        project.files.save_failed.connect(self._stay)
        project.files.changed_on_disk.connect(self._ask_about_file)

    def save(self) -> bool:
        """Save where the project is; ask when it has no place yet.  False if the user cancelled."""
        if self._session.path is None:
            return self.save_as()
        self._project.save(self._session.path)
        return True

    def save_as(self) -> bool:
        """Save in a place of the user's choice; False if the user cancelled."""
        path = self._file_dialogs.save(f"{self.name}.kiri")
        if path is not None:
            self._project.save(path)
        return path is not None

    @property
    def name(self) -> str:
        """What files of the project are called."""
        if self._session.path is not None:
            return self._session.path.stem
        target = self._session.document.target
        return target.name if target is not None else "untitled"

    def guard(self, question: str, then: Callable[[], None]) -> None:
        """Do something that replaces the project; with unsaved changes ask first."""
        if self._hand.postpones(lambda: self.guard(question, then)):
            return
        if not self._session.history.unsaved:
            then()
            return
        actions = ((tr("Save first"), self._save_first), (tr("Don't save"), then))
        self._ask(Message(tr(question), Tone.WARNING, actions=actions))

    def may_close(self) -> bool:
        """Whether the window may close now; asks when work would be lost."""
        if self._hand.postpones(self._window.close):
            return False
        if self._discarded or not self._session.history.unsaved:
            return True
        sentence = tr("This project has unsaved changes. Save before you quit?")
        actions = ((tr("Save and quit"), self._save_and_quit), (tr("Quit without saving"), self._quit))
        self._ask(Message(sentence, Tone.WARNING, actions=actions))
        return False

    def _ask(self, question: Message) -> None:
        self._questions.append(question)
        self._session.post(question)

    def _drop_questions(self) -> None:
        """Close the questions that are still open once there are no unsaved changes."""
        if not self._session.history.unsaved:
            for question in self._questions:
                self._session.withdraw(question)
            self._questions.clear()

    def _ask_about_file(self, changed: ChangedOnDisk) -> None:
        """Somebody else wrote the project's file after it was read or written here: ask what is to become of it."""
        session, files = self._session, self._project.files
        project = session.project

        def overwrite() -> None:
            if session.project == project:
                files.overwrite(changed)

        sentence = tr(
            "{name} was changed on disk after you opened or saved it here, perhaps in another window. Overwrite it, "
            "or save a copy of your version?",
            name=changed.path.name,
        )
        actions = (
            (tr("Overwrite"), overwrite),
            (tr("Save a copy …"), self._save_copy),
            (tr("Cancel"), lambda: session.set_status(tr("Not saved."))),
        )
        self._ask(Message(sentence, Tone.WARNING, actions=actions))

    def _save_copy(self) -> None:
        path = self._file_dialogs.save(tr("{name} copy.kiri", name=self.name))
        if path is not None:
            self._project.save(path)

    def _save_first(self) -> None:
        self.save()

    def _save_and_quit(self) -> None:
        self._quit_when_saved = True
        if not self.save():
            self._quit_when_saved = False

    def _close_when_saved(self) -> None:
        if self._quit_when_saved:
            self._quit_when_saved = False
            self._window.close()  # which asks again if the work went on while the file was written

    def _stay(self) -> None:
        """The project could not be saved, so do not quit after a later save either."""
        self._quit_when_saved = False

    def _quit(self) -> None:
        self._discarded = True
        self._window.close()
