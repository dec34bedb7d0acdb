"""The View menu: the deployment, what is drawn over the layout, the pages of the stage, the theme."""

from __future__ import annotations

import math
from collections.abc import Callable
from functools import partial

from PySide6.QtWidgets import QAbstractButton, QComboBox

from kirigami_studio.foundation.words import tr
from kirigami_studio.gui.session.command import Command, WindowState, Wording
from kirigami_studio.gui.session.overlays import Overlay
from kirigami_studio.gui.session.session import Session
from kirigami_studio.gui.target.target_panel import TargetPanel
from kirigami_studio.gui.widgets.canvas import ZOOM_STEP
from kirigami_studio.gui.window.appearance import Appearance
from kirigami_studio.gui.window.columns import Columns
from kirigami_studio.gui.window.presenters import Presenters
from kirigami_studio.gui.window.stage_panel import StagePanel

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


def commands(
    columns: Columns,
    session: Session,
    presenters: Presenters,
    appearance: Appearance,
) -> tuple[Command, ...]:
    """Return the commands of the View menu."""
    stage = columns.stage
    return (
        *_deployment(stage, session),
        *_overlays(stage),
        *_faults(stage),
        *_pages(columns, presenters),
        *_zooms(columns.target, stage),
        *_themes(appearance, presenters.welcome.switch_motion),
    )


def _deployment(stage: StagePanel, session: Session) -> tuple[Command, ...]:
    bar, menu = stage.deployment, tr("&View")
    return (
        Command(
            "play",
            menu,
            tr("&Play / pause"),
            tr("Play the deployment"),
            partial(_play, stage),
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
            partial(_go_to_target, stage, session),
            shortcuts=("Ctrl+Right",),
        ),
        Command(
            "as_cut",
            menu,
            tr("As cut"),
            tr("Show the panels with their bows and connectors, as they are cut"),
            bar.as_cut.trigger,
            shortcuts=("Shift+C",),
            icon="connector",
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


def _overlays(stage: StagePanel) -> tuple[Command, ...]:
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


def _faults(stage: StagePanel) -> tuple[Command, ...]:
    return (
        Command(
            "next_fault",
            tr("&View"),
            tr("Ne&xt fault"),
            tr("Zoom to the next fault"),
            partial(stage.tour.step, 1),
            shortcuts=("F3",),
        ),
        Command(
            "previous_fault",
            tr("&View"),
            tr("Previo&us fault"),
            tr("Zoom to the previous fault"),
            partial(stage.tour.step, -1),
            shortcuts=("Shift+F3",),
        ),
    )


def _pages(columns: Columns, presenters: Presenters) -> tuple[Command, ...]:
    stage, compare, menu = columns.stage, columns.gallery.bar.compare.switch, tr("&View")
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
            tr("Compare designs side by side"),
            compare.trigger,
            shortcuts=("K",),
            icon="compare",
            switch=compare,
        ),
        Command(
            "all_designs",
            menu,
            tr("All designs"),
            tr("Show all designs flat, half open and open in one window"),
            presenters.all_designs.toggle,
            shortcuts=("A",),
            icon="table",
        ),
        Command(
            "swap",
            menu,
            tr("S&wap compared designs"),
            tr("Make the compared design the chosen one"),
            presenters.comparison.swap,
            shortcuts=("Shift+K",),
            icon="swap",
            enabled_when=lambda now: now.comparing,
        ),
    )


def _zooms(board: TargetPanel, stage: StagePanel) -> tuple[Command, ...]:
    """What is in sight is zoomed: the drawing board while it is open, else the stage."""
    menu = tr("&View")

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


def _themes(appearance: Appearance, switch_motion: Callable[[], None]) -> tuple[Command, ...]:
    return (
        Command(
            "theme",
            tr("&View"),
            tr("Dark t&heme"),
            tr("Switch between light and dark"),
            appearance.switch,
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
            appearance.follow_system,
            checked_when=lambda now: now.follows_system,
        ),
        Command(
            "still",
            tr("&View"),
            tr("Reduce motion"),
            tr("Nothing moves by itself, such as the sample on the empty stage"),
            switch_motion,
            checked_when=lambda now: now.still,
        ),
    )


def _theme_wording(now: WindowState) -> Wording:
    tip = tr("Switch between light and dark")
    return Wording(tr("Light t&heme"), tip, "sun") if now.dark else Wording(tr("Dark t&heme"), tip, "moon")


def _play(stage: StagePanel) -> None:
    """Space plays, unless the keyboard's focus is on a button or a list of choices, which use the key themselves.

    The mouse gives none of them the focus, so after a click Space plays.
    """
    focused = stage.window().focusWidget()
    if isinstance(focused, QAbstractButton):
        focused.click()
    elif isinstance(focused, QComboBox):
        focused.showPopup()
    elif stage.player.play.isEnabled():
        stage.player.play.toggle()


def _go_to_target(stage: StagePanel, session: Session) -> None:
    entry = session.stage
    if entry is not None:
        stage.deployment.set_phi(entry.design.phi_target)
