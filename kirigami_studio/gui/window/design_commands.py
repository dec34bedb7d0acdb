"""The Design menu: generate, change the chosen design, choose and mark designs."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial

from kirigami_studio.foundation.words import tr
from kirigami_studio.gui.gallery.gallery_panel import GalleryPanel
from kirigami_studio.gui.gallery.gallery_view import GalleryView
from kirigami_studio.gui.run.generation import Generation
from kirigami_studio.gui.session.collection import DesignMarks
from kirigami_studio.gui.session.command import Command, WindowState, Wording
from kirigami_studio.gui.stage.hand_editor import HandEditor
from kirigami_studio.gui.window.open_dialogs import Dialogs
from kirigami_studio.gui.window.presenters import Presenters
from kirigami_studio.gui.window.services import Services
from kirigami_studio.gui.window.stage_panel import StagePanel
from kirigami_studio.project.document import Mark


def commands(
    services: Services, stage: StagePanel, gallery: GalleryPanel, presenters: Presenters, dialogs: Dialogs
) -> tuple[Command, ...]:
    """Return the commands of the Design menu."""
    generation, chosen = services.generation, services.chosen
    return (
        *_runs(generation.generate, chosen.cancel),
        *_changes(stage, services.hand, presenters, dialogs),
        *_choices(gallery, generation, services.marks, presenters),
    )


def _runs(generate: Callable[[], None], cancel: Callable[[], None]) -> tuple[Command, ...]:
    menu = tr("&Design")
    return (
        Command(
            "generate",
            menu,
            tr("&Generate"),
            tr("Design sheets for the target"),
            generate,
            shortcuts=("Ctrl+G", "Ctrl+Return"),
            icon="generate",
            enabled_when=lambda now: now.has_target and not now.running,
        ),
        Command(
            "cancel",
            menu,
            tr("&Cancel"),
            tr("Stop generating, trimming or fitting"),
            cancel,
            shortcuts=("Esc",),
            icon="stop",
            enabled_when=lambda now: now.running or now.busy,
        ),
    )


def _changes(stage: StagePanel, hand: HandEditor, presenters: Presenters, dialogs: Dialogs) -> tuple[Command, ...]:
    """What changes the chosen design, or how it is cut."""
    menu = tr("&Design")
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
            presenters.voids.toggle_lock,
            shortcuts=("L",),
            icon="lock",
            enabled_when=_can_change,
        ),
        Command(
            "lock_all",
            menu,
            tr("Lock all &voids"),
            tr("Lock every void against manual edits"),
            partial(hand.lock_all, True),
            enabled_when=_can_change,
        ),
        Command(
            "unlock_all",
            menu,
            tr("&Unlock all voids"),
            tr("Unlock every void for manual edits"),
            partial(hand.lock_all, False),
            enabled_when=_can_change,
        ),
        Command(
            "even_rim",
            menu,
            tr("&Even rim"),
            tr("Space the edge cuts evenly along the sheet's sides"),
            hand.even_rim,
            enabled_when=_can_change,
        ),
        Command(
            "refit",
            menu,
            tr("&Fit again"),
            tr("Improve the match from the current design"),
            partial(presenters.refit, True),
            shortcuts=("Ctrl+F",),
            icon="refit",
            enabled_when=_can_change,
        ),
        Command(
            "artwork",
            menu,
            tr("Art&work …"),
            tr("Lay a picture on the sheet, and print it in register with the cuts"),
            dialogs.show_artwork,
        ),
        Command(
            "materials",
            menu,
            tr("&Materials …"),
            tr("Copy, edit and calibrate materials"),
            dialogs.show_materials,
            shortcuts=("Ctrl+M",),
            icon="material",
        ),
    )


def _choices(
    gallery: GalleryPanel, generation: Generation, marks: DesignMarks, presenters: Presenters
) -> tuple[Command, ...]:
    """Which designs there are, and what becomes of them."""
    menu, designs = tr("&Design"), presenters.designs
    return (
        Command(
            "next",
            menu,
            tr("&Next design"),
            tr("Choose the next design"),
            partial(_walk, gallery.view, 1),
            shortcuts=("Ctrl+Down", "PgDown"),
            gap=True,
        ),
        Command(
            "previous",
            menu,
            tr("P&revious design"),
            tr("Choose the previous design"),
            partial(_walk, gallery.view, -1),
            shortcuts=("Ctrl+Up", "PgUp"),
        ),
        Command(
            "again",
            menu,
            tr("M&ore designs"),
            tr("Generate more designs from the next seed"),
            generation.again,
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
            lambda: generation.more_like(gallery.bar.nearness_value),
            shortcuts=("Ctrl+Shift+R",),
            icon="alike",
            enabled_when=_can_add,
        ),
        Command(
            "pin",
            menu,
            tr("&Pin design"),
            tr("Pin or unpin the chosen design"),
            lambda: marks.pin(designs.chosen),
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
            presenters.all_designs.rename_current,
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


def _walk(view: GalleryView, step: int) -> None:
    row = view.currentIndex().row() + step
    if 0 <= row < view.model_.rowCount():
        view.setCurrentIndex(view.model_.index(row, 0))
