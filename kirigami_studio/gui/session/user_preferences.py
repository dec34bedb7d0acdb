"""The preferences of the window: read once, written when a choice changes that outlives a project."""

from __future__ import annotations

from collections.abc import Collection
from pathlib import Path

from kirigami_studio.foundation.errors import KirigamiError
from kirigami_studio.gui.session.messages import Message, Tone
from kirigami_studio.gui.session.session import Session
from kirigami_studio.project import preferences
from kirigami_studio.project.document import Document
from kirigami_studio.project.preferences import Preferences

#: Fields of the fabrication settings that new projects share with the last one.
MACHINE_FIELDS = frozenset({"material", "profile", "dxf_version", "paper"})
SIZE_FIELDS = frozenset({"opened_mm", "width_mm"})


class UserPreferences:
    """Holds what new projects start with, and saves it once the path of its file is known."""

    def __init__(self, session: Session) -> None:
        self._session = session
        self.present = Preferences()
        self._path: Path | None = None

    def use(self, path: Path) -> None:
        """Start with the file's preferences and keep it up to date."""
        session = self._session
        untouched = session.document in (Document(), self.new_document()) and not session.history.steps
        try:
            self.present = preferences.load(path)
        except KirigamiError as error:
            session.post(Message(str(error), Tone.WARNING))
        else:
            self._path = path
        if untouched:
            session.restart(self.new_document(), session.path)

    def remember(self, document: Document) -> None:
        """A cut file of this document was written, or its machine or material was chosen."""
        self.keep(self.present.on_machine_of(document))

    def note_choice(self, fields: Collection[str]) -> None:
        """These fields of the fabrication settings were chosen in the present document: new projects have the same."""
        document = self._session.document
        if MACHINE_FIELDS.intersection(fields):
            self.remember(document)
        if SIZE_FIELDS.intersection(fields):
            self.keep(self.present.with_size_of(document))

    def keep(self, wanted: Preferences) -> None:
        """Start new projects, and the next window, with these from now on."""
        if wanted == self.present:
            return
        self.present = wanted
        if self._path is None:
            return
        try:
            preferences.save(wanted, self._path)
        except KirigamiError as error:
            self._session.post(Message(str(error), Tone.WARNING))

    def new_document(self) -> Document:
        """What a new project starts with."""
        return self.present.new_document()
