"""The Design menu: generate, change the chosen design, choose and mark designs."""

from __future__ import annotations

from functools import partial
from typing import TYPE_CHECKING

from kirigami_studio.foundation.words import tr
from kirigami_studio.gui.session.command import Command, WindowState, Wording
from kirigami_studio.project.document import Mark

if TYPE_CHECKING:
    from kirigami_studio.gui.window.main_window import MainWindow


def commands(window: MainWindow) -> tuple[Command, ...]:
    """Return the commands of the Design menu."""
    return (*_runs(window), *_changes(window), *_choices(window))


def _runs(window: MainWindow) -> tuple[Command, ...]:
    controller, menu = window.controller, tr("&Design")
    return (
        Command(
            "generate",
            menu,
            tr("&Generate"),
            tr("Design sheets for the target"),
            controller.generation.generate,
            shortcuts=("Ctrl+G", "Ctrl+Return"),
            icon="generate",
            enabled_when=lambda now: now.has_target and not now.running,
        ),
        Command(
            "cancel",
            menu,
            tr("&Cancel"),
            tr("Stop generating, trimming or fitting"),
            controller.cancel,
            shortcuts=("Esc",),
            icon="stop",
            enabled_when=lambda now: now.running or now.busy,
        ),
    )


def _changes(window: MainWindow) -> tuple[Command, ...]:
    """What changes the chosen design, or how it is cut."""
    stage, voids, menu = window.stage, window.connections.voids, tr("&Design")
    return (
        Command(
            "trim",
            menu,
            tr("&Trim to target"),
            tr("Cut the edge panels along the target"),
            stage.trim.switch.trigger,
            shortcuts=("Ctrl+T",),
            icon="trim",
            gap=True,
            switch=stage.trim.switch,
        ),
        Command(
            "hand",
            menu,
            tr("Edit by &hand"),
            tr("Edit voids and outline by hand"),
            stage.hand.switch.trigger,
            shortcuts=("H",),
            icon="hand",
            switch=stage.hand.switch,
        ),
        Command(
            "lock",
            menu,
            tr("&Lock voids"),
            tr("Lock or unlock the selected voids"),
            voids.toggle_lock,
            shortcuts=("L",),
            icon="lock",
            enabled_when=_can_change,
        ),
        Command(
            "lock_all",
            menu,
            tr("Lock all &voids"),
            tr("Lock every void against manual edits"),
            partial(window.controller.hand.lock_all, True),
            enabled_when=_can_change,
        ),
        Command(
            "unlock_all",
            menu,
            tr("&Unlock all voids"),
            tr("Unlock every void for manual edits"),
            partial(window.controller.hand.lock_all, False),
            enabled_when=_can_change,
        ),
        Command(
            "even_rim",
            menu,
            tr("&Even rim"),
            tr("Space the edge cuts evenly along the sheet's sides"),
            window.controller.hand.even_rim,
            enabled_when=_can_change,
        ),
        Command(
            "refit",
            menu,
            tr("&Fit again"),
            tr("Improve the match from the current design"),
            partial(window.connections.refit, True),
            shortcuts=("Ctrl+F",),
            icon="refit",
            enabled_when=_can_change,
        ),
        Command(
            "artwork",
            menu,
            tr("Art&work …"),
            tr("Lay a picture on the sheet, and print it in register with the cuts"),
            window.dialogs.show_artwork,
        ),
        Command(
            "materials",
            menu,
            tr("&Materials …"),
            tr("Copy, edit and calibrate materials"),
            window.dialogs.show_materials,
            shortcuts=("Ctrl+M",),
            icon="material",
        ),
    )


def _choices(window: MainWindow) -> tuple[Command, ...]:
    """Which designs there are, and what becomes of them."""
    controller, gallery, menu = window.controller, window.gallery, tr("&Design")
    designs = window.connections.designs
    return (
        Command(
            "next",
            menu,
            tr("&Next design"),
            tr("Choose the next design"),
            partial(_walk, window, 1),
            shortcuts=("Ctrl+Down", "PgDown"),
            gap=True,
        ),
        Command(
            "previous",
            menu,
            tr("P&revious design"),
            tr("Choose the previous design"),
            partial(_walk, window, -1),
            shortcuts=("Ctrl+Up", "PgUp"),
        ),
        Command(
            "again",
            menu,
            tr("M&ore designs"),
            tr("Generate more designs from the next seed"),
            controller.generation.again,
            shortcuts=("Ctrl+R",),
            icon="again",
            gap=True,
            enabled_when=_can_add,
        ),
        Command(
            "more_like",
            menu,
            tr("More li&ke this"),
            tr("Generate more designs like the chosen one"),
            lambda: controller.generation.more_like(gallery.bar.nearness_value),
            shortcuts=("Ctrl+Shift+R",),
            icon="alike",
            enabled_when=_can_add,
        ),
        Command(
            "pin",
            menu,
            tr("&Pin design"),
            tr("Pin or unpin the chosen design"),
            lambda: controller.marks.pin(designs.chosen),
            shortcuts=("I",),
            icon="pin",
            gap=True,
            enabled_when=_can_change,
            worded=_pin_wording,
        ),
        Command(
            "rename",
            menu,
            tr("N&ame and note …"),
            tr("Rename the chosen design, and note what you want to remember of it"),
            window.connections.all_designs.rename_current,
            shortcuts=("F2",),
            icon="note",
            enabled_when=_can_change,
        ),
        Command(
            "reject",
            menu,
            tr("Re&ject design"),
            tr("Reject the chosen design (Del in the gallery)"),
            lambda: designs.reject(designs.chosen),
            icon="reject",
            enabled_when=_can_change,
            worded=_reject_wording,
        ),
    )


def _can_change(now: WindowState) -> bool:
    return now.can_change_design


def _can_add(now: WindowState) -> bool:
    return now.has_designs and not now.running


def _pin_wording(now: WindowState) -> Wording:
    pinned = now.can_change_design and now.chosen is Mark.PINNED
    text = tr("Un&pin design") if pinned else tr("&Pin design")
    return Wording(text, tr("Pin or unpin the chosen design"), "pin")


def _reject_wording(now: WindowState) -> Wording:
    rejected = now.can_change_design and now.chosen is Mark.REJECTED
    text = tr("Re&store design") if rejected else tr("Re&ject design")
    return Wording(text, tr("Reject the chosen design (Del in the gallery)"), "reject")


def _walk(window: MainWindow, step: int) -> None:
    view = window.gallery.view
    row = view.currentIndex().row() + step
    if 0 <= row < view.model_.rowCount():
        view.setCurrentIndex(view.model_.index(row, 0))
