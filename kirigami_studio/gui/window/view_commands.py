"""The View menu: the deployment, what is drawn over the layout, the pages of the stage, the theme."""

from __future__ import annotations

import math
from collections.abc import Callable
from functools import partial
from operator import attrgetter

from PySide6.QtWidgets import QAbstractButton, QComboBox

from kirigami_studio.foundation.words import tr
from kirigami_studio.gui.session.command import Command, WindowState, Wording
from kirigami_studio.gui.session.overlays import Overlay
from kirigami_studio.gui.session.session import Session
from kirigami_studio.gui.widgets.canvas import ZOOM_STEP
from kirigami_studio.gui.window.appearance import Appearance
from kirigami_studio.gui.window.pages import WORDS, Pages, WindowPage
from kirigami_studio.gui.window.presenters import Presenters
from kirigami_studio.gui.window.stage_panel import StagePanel

#: Commands that switch what is drawn over the layout.
OVERLAY_COMMANDS = {f"show_{overlay.value}": overlay for overlay in Overlay}
#: Commands that turn the pages of the window.
PAGE_COMMANDS = {f"page_{page.value}": page for page in WindowPage}


def commands(
    pages: Pages,
    session: Session,
    presenters: Presenters,
    appearance: Appearance,
    switch_preview: Callable[[], None],
) -> tuple[Command, ...]:
    """Return the commands of the View menu."""
    stage = pages.stage
    return (
        *_turns(pages),
        _preview(switch_preview),
        *_views(pages, presenters),
        *_deployment(pages, session),
        *_overlays(stage),
        *_faults(stage),
        *_zooms(pages),
        *_themes(appearance, presenters.welcome.switch_motion),
    )


def _turns(pages: Pages) -> tuple[Command, ...]:
    """The pages of the window, on keys 1, 2 and 3."""

    def turn(number: int, name: str, page: WindowPage) -> Command:
        (text, tip), shown = WORDS[page], partial(_is_on, page)
        return Command(tr("&View"), name, tr(text), tr(tip), partial(pages.turn, page), f"{number}", checked_when=shown)

    return tuple(turn(number, name, page) for number, (name, page) in enumerate(PAGE_COMMANDS.items(), start=1))


def _preview(switch: Callable[[], None]) -> Command:
    text, tip = tr("Pre&view while drawing"), tr("Show on the page Shape at once what a sheet makes of the target")
    return Command(tr("&View"), "preview", text, tip, switch, gap=True, checked_when=attrgetter("previews"))


def _is_on(page: WindowPage, now: WindowState) -> bool:
    return now.page == page.value


def inside(title: str) -> str:
    """A menu in the View menu."""
    return f"{tr('&View')}|{title}"


def _deployment(pages: Pages, session: Session) -> tuple[Command, ...]:
    stage = pages.stage
    menu = inside(tr("Pla&y"))
    bar, command = stage.deployment, partial(Command, menu)
    slower = tr("Play the deployment slower, down to a quarter of normal speed")
    faster = tr("Play the deployment faster, up to four times normal speed")
    mode, speed = tr("Switch between back and forth, loop and once"), bar.options.change_speed
    as_cut = tr("Show the panels with their bows and connectors, as they are cut")
    ideal = tr("Let the slider go on where the sheet would jam as cut")
    flat, target = partial(bar.set_phi, math.pi), partial(_go_to_target, stage, session)
    jams, shown = attrgetter("ideal.enabled"), attrgetter("ideal.checked")
    return (
        command("play", tr("&Play / pause"), tr("Play the deployment"), partial(_play, pages), "Space", "play"),
        command("slower", tr("Slower"), slower, partial(speed, -1), "<"),
        command("faster", tr("Faster"), faster, partial(speed, 1), ">"),
        command("play_mode", tr("Next play m&ode"), mode, bar.options.next_mode, "Shift+P"),
        command("to_flat", tr("&Flat sheet (180°)"), tr("Show the sheet flat"), flat, "Ctrl+Left"),
        command("to_target", tr("&Target angle"), tr("Show the target angle"), target, "Ctrl+Right"),
        Command.switching(menu, "as_cut", tr("As cut"), as_cut, bar.as_cut, "Shift+C", "connector"),
        command(
            "ideal",
            tr("Ideal beyond the &jam"),
            ideal,
            bar.ideal.toggle,
            "Shift+J",
            enabled_when=jams,
            checked_when=shown,
        ),
    )


def _overlays(stage: StagePanel) -> tuple[Command, ...]:
    def overlay(name: str, text: str, key: str, icon: str, tip: str, gap: bool = False) -> Command:
        return Command.switching(
            inside(tr("&Overlays")), name, text, tip, stage.overlays[OVERLAY_COMMANDS[name]], key, icon, gap=gap
        )

    small = tr("Mark the shortest edges and narrowest necks, between cut centre lines")
    stretch = tr("Colour connectors by their stretch at this angle, as cut")
    grips = tr("Mark the panels to hold and to pull so that the sheet opens as designed")
    opening = tr("Colour voids by their area at this angle")
    return (
        overlay("show_target", tr("Tar&get outline"), "T", "target", tr("Show the target's outline")),
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
    command, step = partial(Command, inside(tr("&Overlays"))), stage.tour.step
    return (
        command("next_fault", tr("Ne&xt fault"), tr("Zoom to the next fault"), partial(step, 1), "F3", gap=True),
        command(
            "previous_fault", tr("Previo&us fault"), tr("Zoom to the previous fault"), partial(step, -1), "Shift+F3"
        ),
    )


def _views(pages: Pages, presenters: Presenters) -> tuple[Command, ...]:
    stage, compare = pages.stage, pages.gallery.bar.compare
    command, switching = partial(Command, tr("&View")), partial(Command.switching, tr("&View"))
    before, cuts = tr("Show the design before polishing"), tr("Show the cut plan at kerf width")
    plots = tr("Show match, size and gaps at every angle")
    every = tr("Show all designs flat, half open and open in one window")
    return (
        switching("before", tr("&Before polish"), before, stage.before.switch, "B", "before", gap=True),
        command("cuts", tr("&Cuts"), cuts, pages.show_cuts, "C", "cuts"),
        switching("plots", tr("P&lots"), plots, stage.plots_switch.switch, "J", "plots"),
        switching("compare", tr("Si&de by side"), tr("Compare designs side by side"), compare.switch, "K", "compare"),
        command("all_designs", tr("All designs"), every, presenters.all_designs.toggle, "A", "table"),
        command(
            "swap",
            tr("S&wap compared designs"),
            tr("Make the compared design the chosen one"),
            presenters.comparison.swap,
            "Shift+K",
            "swap",
            enabled_when=attrgetter("comparing"),
        ),
    )


def _zooms(pages: Pages) -> tuple[Command, ...]:
    """Commands that zoom the drawing board, the stage or the sheet."""
    board, command = pages.target, partial(Command, inside(tr("&Zoom")))
    real = tr("Show the sheet as large as it is cut")
    drawn = partial(command, enabled_when=attrgetter("editing_target"))
    selected = tr("Show what is selected as large as possible")

    def fit() -> None:
        pages.in_sight.fit()

    def zoom(factor: float) -> None:
        pages.in_sight.zoom(factor)

    return (
        command("fit", tr("Show &everything"), tr("Zoom to show everything"), fit, "0; Ctrl+0", "fit"),
        command("zoom_in", tr("Zoom in"), tr("Show it larger"), partial(zoom, ZOOM_STEP), "Ctrl++; Ctrl+="),
        command("zoom_out", tr("Zoom out"), tr("Show it smaller"), partial(zoom, 1.0 / ZOOM_STEP), "Ctrl+-"),
        drawn("zoom_real", tr("Actual size"), real, board.view.zoom_to_real_size, "Ctrl+1"),
        drawn("zoom_selection", tr("Zoom to selection"), selected, board.view.zoom_to_selection, "Ctrl+2"),
    )


def _themes(appearance: Appearance, switch_motion: Callable[[], None]) -> tuple[Command, ...]:
    command, motion = (
        partial(Command, inside(tr("Loo&k"))),
        tr("Nothing moves by itself, such as the sample on the first page"),
    )
    dark, tip = tr("Dark t&heme"), tr("Switch between light and dark")
    inches = tr("Fields show lengths in inches; mm can still be typed, as 25 mm")
    followed, still = attrgetter("follows_system"), attrgetter("still")
    system, match = tr("Follow the s&ystem"), tr("Match the system theme")
    return (
        command("theme", dark, tip, appearance.switch, "Ctrl+Alt+D", "moon", worded=_theme_wording),
        command("theme_system", system, match, appearance.follow_system, checked_when=followed),
        command("still", tr("Reduce motion"), motion, switch_motion, checked_when=still),
        command("inches", tr("Lengths in &inches"), inches, appearance.switch_unit, checked_when=attrgetter("inches")),
    )


def _theme_wording(now: WindowState) -> Wording:
    tip = tr("Switch between light and dark")
    return Wording(tr("Light t&heme"), tip, "sun") if now.dark else Wording(tr("Dark t&heme"), tip, "moon")


def _play(pages: Pages) -> None:
    """Space plays, unless the keyboard's focus is on a button or a list of choices, which use the key themselves.

    The mouse gives none of them the focus, so after a click Space plays.
    """
    focused = pages.window().focusWidget()
    if isinstance(focused, QAbstractButton):
        focused.click()
    elif isinstance(focused, QComboBox):
        focused.showPopup()
    elif pages.player.play.isEnabled():
        pages.player.play.toggle()


def _go_to_target(stage: StagePanel, session: Session) -> None:
    entry = session.stage
    if entry is not None:
        stage.deployment.set_phi(entry.design.phi_target)
