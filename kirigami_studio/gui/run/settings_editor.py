"""How the next run searches: changes of the design settings, each an edit."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Unpack

from kirigami_studio.foundation.errors import KirigamiError
from kirigami_studio.gui.session.session import Session
from kirigami_studio.project import edits
from kirigami_studio.project.edits import SettingsChange


class SettingsEditor:
    """Changes the design settings, or says why it cannot.

    Parameters
    ----------
    readers : mapping of str to callable
        Stops reading the value of a field, by its name: another value was chosen.
    """

    def __init__(self, session: Session, readers: Mapping[str, Callable[[], None]]) -> None:
        self._session, self._readers = session, readers

    def change(self, **changes: Unpack[SettingsChange]) -> None:
        """Change how the next run searches."""
        for field, stop in self._readers.items():
            if field in changes:
                stop()
        try:
            self._session.apply(edits.set_settings(self._session.document, **changes))
        except KirigamiError as error:
            self._session.refuse(error)
