"""The View menu: the deployment, what is drawn over the layout, the pages of the stage, the theme."""

from __future__ import annotations

import math
from functools import partial
from typing import TYPE_CHECKING

from PySide6.QtCore import QObject
from PySide6.QtGui import QGuiApplication
from PySide6.QtWidgets import QAbstractButton, QComboBox

from kirigami_studio.foundation.words import language as spoken_language
from kirigami_studio.foundation.words import tr
from kirigami_studio.gui.session.command import Command, WindowState, Wording
from kirigami_studio.gui.session.messages import Message
from kirigami_studio.gui.session.overlays import Overlay
from kirigami_studio.gui.session.user_preferences import UserPreferences
from kirigami_studio.gui.widgets import theme
from kirigami_studio.gui.widgets.canvas import ZOOM_STEP
from kirigami_studio.project.preferences import Theme

if TYPE_CHECKING:
    from kirigami_studio.gui.window.main_window import MainWindow

#: The preferred theme that follows the desktop.
#: Commands that switch what is drawn over the layout.
OVERLAY_COMMANDS = {
    "show_target": Overlay.TARGET,
    "show_mismatch": Overlay.MISMATCH,
    "show_faults": Overlay.FAULTS,
    "show_stretch": Overlay.STRETCH,
    "show_grips": Overlay.GRIPS,
    "show_ratios": Overlay.RATIOS,
    "show_openings": Overlay.OPENINGS,
    "show_small_parts": Overlay.SMALL_PARTS,
    "show_panel_numbers": Overlay.PANEL_NUMBERS,
    "show_void_numbers": Overlay.VOID_NUMBERS,
}


class Appearance(QObject):
    """Theme and language of the window: the desktop's unless the preferences name others."""

    def __init__(self, window: MainWindow, preferences: UserPreferences) -> None:
        super().__init__(window)
        self._window = window
        self._preferences = preferences
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
        self._preferences.choose_language(language)
        self.offer_start()

    def offer_start(self) -> None:
        """Offer to open the window again in the preferred language, unless it speaks that already."""
        if self._offer is not None:
            self._window.messages.drop(self._offer)
            self._offer = None
        if self.language != spoken_language():
            sentence = tr("The language changes when Kirigami Studio is started again. Your project stays open.")
            self._offer = Message(sentence, actions=((tr("Start again now"), self._window.start_again),))
            self._window.messages.add(self._offer)

    def listen(self) -> None:
        """Change the theme whenever the desktop changes its own, if that is wanted."""
        QGuiApplication.styleHints().colorSchemeChanged.connect(self.refresh)

    def refresh(self) -> None:
        """Show the theme that the preferences ask for."""
        palette = theme.PALETTES.get(self._preferences.present.theme) or theme.system_palette()
        if palette is not self._window.palette_:
            self._window.set_theme(palette)
        self._window.commands.refresh()

    def switch(self) -> None:
        """Change between light and dark; the choice stays until the desktop is to be followed again."""
        self._preferences.choose_theme(Theme.LIGHT if self._window.palette_.dark else Theme.DARK)
        self.refresh()

    def follow_system(self) -> None:
        """Follow the desktop's theme, or stop at the present one."""
        self._preferences.choose_theme(Theme(self._window.palette_.name) if self.follows_system else Theme.SYSTEM)
        self.refresh()


def commands(window: MainWindow) -> tuple[Command, ...]:
    """Return the commands of the View menu."""
    return (
        *_deployment(window),
        *_overlays(window),
        *_faults(window),
        *_pages(window),
        *_zooms(window),
        *_themes(window),
    )


def _deployment(window: MainWindow) -> tuple[Command, ...]:
    bar, menu = window.stage.deployment, tr("&View")
    return (
        Command(
            "play",
            menu,
            tr("&Play / pause"),
            tr("Play the deployment"),
            partial(_play, window),
            shortcuts=("Space",),
            icon="play",
        ),
        Command(
            "slower",
            menu,
            tr("Slower"),
            tr("Play the deployment slower, down to a quarter of normal speed"),
            partial(bar.options.change_speed, -1),
            shortcuts=("<",),
        ),
        Command(
            "faster",
            menu,
            tr("Faster"),
            tr("Play the deployment faster, up to four times normal speed"),
            partial(bar.options.change_speed, 1),
            shortcuts=(">",),
        ),
        Command(
            "play_mode",
            menu,
            tr("Next play m&ode"),
            tr("Switch between back and forth, loop and once"),
            bar.options.next_mode,
            shortcuts=("Shift+P",),
        ),
        Command(
            "to_flat",
            menu,
            tr("&Flat sheet (180°)"),
            tr("Show the sheet flat"),
            partial(bar.set_phi, math.pi),
            shortcuts=("Ctrl+Left",),
        ),
        Command(
            "to_target",
            menu,
            tr("&Target angle"),
            tr("Show the target angle"),
            partial(_go_to_target, window),
            shortcuts=("Ctrl+Right",),
        ),
        Command(
            "as_cut",
            menu,
            tr("As &cut"),
            tr("Show the panels with their bows and connectors, as they are cut"),
            bar.as_cut.trigger,
            shortcuts=("Shift+C",),
            switch=bar.as_cut,
        ),
        Command(
            "ideal",
            menu,
            tr("Ideal beyond the &jam"),
            tr("Let the slider go on where the sheet would jam as cut"),
            bar.ideal.toggle,
            shortcuts=("Shift+J",),
            enabled_when=lambda now: now.ideal.enabled,
            checked_when=lambda now: now.ideal.checked,
        ),
    )


def _overlays(window: MainWindow) -> tuple[Command, ...]:
    stage = window.stage

    def overlay(name: str, text: str, key: str, icon: str, tip: str, gap: bool = False) -> Command:
        switch = stage.overlays[OVERLAY_COMMANDS[name]]
        return Command(name, tr("&View"), text, tip, switch.trigger, (key,), icon, gap, switch=switch)

    small = tr("Mark the shortest edges and narrowest necks, in mm between cut centre lines")
    stretch = tr("Colour connectors by their stretch at this angle, as cut")
    grips = tr("Mark the panels to hold and to pull so that the sheet opens as designed")
    opening = tr("Colour voids by their area at this angle, mm²")
    return (
        overlay("show_target", tr("Tar&get outline"), "T", "target", tr("Show the target's outline"), gap=True),
        overlay("show_mismatch", tr("&Mismatch"), "M", "mismatch", tr("Show missing and extra area")),
        overlay("show_faults", tr("F&aults"), "F", "fault", tr("Mark inverted panels and contacts")),
        overlay("show_stretch", tr("Connector stretch"), "Shift+X", "connector", stretch),
        overlay("show_grips", tr("Where to hold and pull"), "Shift+G", "grips", grips),
        overlay("show_ratios", tr("&Ratio heat map"), "Shift+H", "heat", tr("Colour voids by their ratio")),
        overlay("show_openings", tr("&Void opening"), "Shift+O", "opening", opening),
        overlay("show_small_parts", tr("&Smallest features"), "Shift+T", "small", small),
        overlay(
            "show_panel_numbers", tr("Panel &numbers"), "Shift+I", "numbers", tr("Number panels by row and column")
        ),
        overlay("show_void_numbers", tr("Vo&id numbers"), "Shift+N", "numbers", tr("Number voids by row and column")),
    )


def _faults(window: MainWindow) -> tuple[Command, ...]:
    return (
        Command(
            "next_fault",
            tr("&View"),
            tr("Ne&xt fault"),
            tr("Zoom to the next fault"),
            partial(window.stage.tour.step, 1),
            shortcuts=("F3",),
        ),
        Command(
            "previous_fault",
            tr("&View"),
            tr("Previo&us fault"),
            tr("Zoom to the previous fault"),
            partial(window.stage.tour.step, -1),
            shortcuts=("Shift+F3",),
        ),
    )


def _pages(window: MainWindow) -> tuple[Command, ...]:
    stage, comparison, menu = window.stage, window.connections.side_by_side, tr("&View")
    return (
        Command(
            "before",
            menu,
            tr("&Before polish"),
            tr("Show the design before polishing"),
            stage.before.switch.trigger,
            shortcuts=("B",),
            icon="before",
            gap=True,
            switch=stage.before.switch,
        ),
        Command(
            "cuts",
            menu,
            tr("&Cuts"),
            tr("Show the cut plan at kerf width"),
            stage.cuts_switch.switch.trigger,
            shortcuts=("C",),
            icon="cuts",
            switch=stage.cuts_switch.switch,
        ),
        Command(
            "plots",
            menu,
            tr("P&lots"),
            tr("Show match, size and gaps at every angle"),
            stage.plots_switch.switch.trigger,
            shortcuts=("J",),
            icon="plots",
            switch=stage.plots_switch.switch,
        ),
        Command(
            "compare",
            menu,
            tr("Si&de by side"),
            tr("Compare two designs side by side"),
            window.gallery.bar.compare.switch.trigger,
            shortcuts=("K",),
            icon="compare",
            switch=window.gallery.bar.compare.switch,
        ),
        Command(
            "all_designs",
            menu,
            tr("All designs"),
            tr("Show all designs flat, half open and open in one window"),
            window.connections.all_designs.toggle,
            shortcuts=("A",),
            icon="table",
        ),
        Command(
            "swap",
            menu,
            tr("S&wap compared designs"),
            tr("Make the compared design the chosen one"),
            comparison.swap,
            shortcuts=("Shift+K",),
            icon="swap",
            enabled_when=lambda now: now.comparing,
        ),
    )


def _zooms(window: MainWindow) -> tuple[Command, ...]:
    """What is in sight is zoomed: the drawing board while it is open, else the stage."""
    board, stage, menu = window.target, window.stage, tr("&View")

    def zoom(factor: float) -> None:
        board.view.zoom(factor) if board.editing else stage.zoom(factor)

    return (
        Command(
            "fit",
            menu,
            tr("Show &everything"),
            tr("Zoom to show everything"),
            lambda: board.view.fit() if board.editing else stage.fit(),
            shortcuts=("0", "Ctrl+0"),
            icon="fit",
            gap=True,
        ),
        Command("zoom_in", menu, tr("Zoom in"), tr("Show it larger"), partial(zoom, ZOOM_STEP), ("Ctrl++", "Ctrl+=")),
        Command("zoom_out", menu, tr("Zoom out"), tr("Show it smaller"), partial(zoom, 1.0 / ZOOM_STEP), ("Ctrl+-",)),
        Command(
            "zoom_real",
            menu,
            tr("Actual size"),
            tr("Show a millimetre as long as it is on paper"),
            board.view.zoom_to_real_size,
            shortcuts=("Ctrl+1",),
            enabled_when=lambda now: now.editing_target,
        ),
        Command(
            "zoom_selection",
            menu,
            tr("Zoom to selection"),
            tr("Show what is selected as large as possible"),
            board.view.zoom_to_selection,
            shortcuts=("Ctrl+2",),
            enabled_when=lambda now: now.editing_target,
        ),
    )


def _themes(window: MainWindow) -> tuple[Command, ...]:
    return (
        Command(
            "theme",
            tr("&View"),
            tr("Dark t&heme"),
            tr("Switch between light and dark"),
            window.appearance.switch,
            shortcuts=("Ctrl+Alt+D",),
            icon="moon",
            gap=True,
            worded=_theme_wording,
        ),
        Command(
            "theme_system",
            tr("&View"),
            tr("Follow the s&ystem"),
            tr("Match the system theme"),
            window.appearance.follow_system,
            checked_when=lambda now: now.follows_system,
        ),
        Command(
            "still",
            tr("&View"),
            tr("Reduce motion"),
            tr("Nothing moves by itself, such as the sample on the empty stage"),
            window.connections.first_start.switch_motion,
            checked_when=lambda now: now.still,
        ),
    )


def _theme_wording(now: WindowState) -> Wording:
    tip = tr("Switch between light and dark")
    return Wording(tr("Light t&heme"), tip, "sun") if now.dark else Wording(tr("Dark t&heme"), tip, "moon")


def _play(window: MainWindow) -> None:
    """Space plays, unless the keyboard's focus is on a button or a list of choices, which use the key themselves.

    The mouse gives none of them the focus, so after a click Space plays.
    """
    focused = window.focusWidget()
    if isinstance(focused, QAbstractButton):
        focused.click()
    elif isinstance(focused, QComboBox):
        focused.showPopup()
    elif window.stage.player.play.isEnabled():
        window.stage.player.play.toggle()


def _go_to_target(window: MainWindow) -> None:
    entry = window.controller.stage
    if entry is not None:
        window.stage.deployment.set_phi(entry.design.phi_target)
