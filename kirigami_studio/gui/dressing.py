"""Which look the window has: the desktop's, light or dark, by the preference or for now."""

from __future__ import annotations

from PySide6.QtCore import QObject
from PySide6.QtGui import QGuiApplication

from kirigami_studio.gui.look import theme
from kirigami_studio.gui.look.preferring import Preferring
from kirigami_studio.gui.shell import Shell

SYSTEM = "system"


class Dressing(QObject):
    """Follows the desktop until the user chooses a look, and again when asked to."""

    def __init__(self, window: Shell, preferring: Preferring) -> None:
        super().__init__(window)
        self._window = window
        self._preferring = preferring
        window.actions_["theme_system"].setChecked(self.follows)

    @property
    def follows(self) -> bool:
        """Whether the window looks as the desktop does."""
        return self._preferring.present.theme == SYSTEM

    def listen(self) -> None:
        """Change the look whenever the desktop changes its own, if that is wanted."""
        QGuiApplication.styleHints().colorSchemeChanged.connect(self.refresh)

    def refresh(self) -> None:
        """Put on what the preference says."""
        chosen = self._preferring.present.theme
        palette = theme.PALETTES.get(chosen) or theme.system_palette()
        self._window.actions_["theme_system"].setChecked(self.follows)
        if palette is not self._window.palette_:
            self._window.set_theme(palette)

    def switch(self) -> None:
        """Light becomes dark and dark light; the choice stays until the desktop is to be followed again."""
        self._preferring.choose_theme(theme.LIGHT.name if self._window.palette_.dark else theme.DARK.name)
        self.refresh()

    def follow(self) -> None:
        """Look as the desktop does, or stop at the present look."""
        self._preferring.choose_theme(self._window.palette_.name if self.follows else SYSTEM)
        self.refresh()
