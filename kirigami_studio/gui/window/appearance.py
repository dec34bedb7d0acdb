"""Theme and language of the window: the desktop's unless the preferences name others."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

from PySide6.QtCore import QObject, Signal
from PySide6.QtGui import QGuiApplication
from PySide6.QtWidgets import QApplication, QWidget

from kirigami_studio.foundation.words import ShownUnit, tr
from kirigami_studio.foundation.words import language as spoken_language
from kirigami_studio.gui.session.messages import Message
from kirigami_studio.gui.session.session import Session
from kirigami_studio.gui.session.user_preferences import UserPreferences
from kirigami_studio.gui.widgets import theme
from kirigami_studio.gui.widgets.number_field import show_lengths
from kirigami_studio.gui.widgets.theme import Palette
from kirigami_studio.project.preferences import LengthUnit, Theme


class Appearance(QObject):
    """Gives a window and its application the preferred theme, and offers to change the language.

    Parameters
    ----------
    palette : Palette
        Worn once :meth:`set_theme` is called.
    start_again : callable
        Opens the window anew, in the preferred language.
    """

    changed = Signal(object)  #: the Palette, or whether it follows the desktop's
    unit_changed = Signal()  #: that lengths are shown in

    def __init__(
        self,
        window: QWidget,
        session: Session,
        preferences: UserPreferences,
        palette: Palette,
        start_again: Callable[[], None],
    ) -> None:
        super().__init__(window)
        self._window, self._session, self._preferences = window, session, preferences
        self.palette = palette
        self._start_again = start_again
        self._offer: Message | None = None

    @property
    def follows_system(self) -> bool:
        """Whether the window has the desktop's theme."""
        return self._preferences.present.theme is Theme.SYSTEM

    @property
    def language(self) -> str:
        """The preferred language, "system" or a code."""
        return self._preferences.present.language

    def choose_language(self, language: str) -> None:
        """Prefer another language; it is that of the next window."""
        self._preferences.keep(replace(self._preferences.present, language=language))
        self.offer_start()

    def offer_start(self) -> None:
        """Offer to open the window again in the preferred language, unless it speaks that already."""
        if self._offer is not None:
            self._session.withdraw(self._offer)
            self._offer = None
        if self.language != spoken_language():
            sentence = tr("The language changes when Kirigami Studio is started again. Your project stays open.")
            self._offer = Message(sentence, actions=((tr("Start again now"), self._start_again),))
            self._session.post(self._offer)

    def set_theme(self, palette: Palette) -> None:
        """Change to another palette."""
        self.palette = palette
        application = QApplication.instance()
        if isinstance(application, QApplication):
            theme.apply(application, palette)
        self.colour(self._window)
        self.changed.emit(palette)

    def colour(self, widget: QWidget) -> None:
        """Give a widget and its parts the colours of the theme."""
        for part in theme.themed((widget, *widget.findChildren(QWidget))):
            part.set_palette(self.palette)

    def listen(self) -> None:
        """Change the theme whenever the desktop changes its own, if that is wanted."""
        QGuiApplication.styleHints().colorSchemeChanged.connect(self.refresh)

    def refresh(self) -> None:
        """Show the theme and the unit that the preferences ask for."""
        self._show_unit()
        palette = theme.PALETTES.get(self._preferences.present.theme) or theme.system_palette()
        if palette is not self.palette:
            self.set_theme(palette)
        else:
            self.changed.emit(palette)

    @property
    def in_inches(self) -> bool:
        """Whether fields for lengths show inches."""
        return self._preferences.present.unit is LengthUnit.INCHES

    def switch_unit(self) -> None:
        """Show lengths in inches, or in mm again."""
        unit = LengthUnit.MILLIMETRES if self.in_inches else LengthUnit.INCHES
        self._preferences.keep(replace(self._preferences.present, unit=unit))
        self._show_unit()

    def _show_unit(self) -> None:
        if ShownUnit.inches != self.in_inches:
            show_lengths(self._window, self.in_inches)
            self.unit_changed.emit()

    def switch(self) -> None:
        """Change between light and dark; the choice stays until the desktop is to be followed again."""
        self._choose(Theme.LIGHT if self.palette.dark else Theme.DARK)

    def follow_system(self) -> None:
        """Follow the desktop's theme, or stop at the present one."""
        self._choose(Theme(self.palette.name) if self.follows_system else Theme.SYSTEM)

    def _choose(self, wanted: Theme) -> None:
        self._preferences.keep(replace(self._preferences.present, theme=wanted))
        self.refresh()
