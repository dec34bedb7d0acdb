"""The Design menu: generate, change the chosen design, choose and mark designs."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from operator import attrgetter

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
    command = partial(Command, tr("&Design"))
    ready = partial(command, enabled_when=lambda now: now.has_target and not now.running)
    at_work = partial(command, enabled_when=lambda now: now.running or now.busy)
    stop = tr("Stop generating, trimming or fitting")
    return (
        ready(
            "generate", tr("&Generate"), tr("Design sheets for the target"), generate, "Ctrl+G; Ctrl+Return", "generate"
        ),
        at_work("cancel", tr("&Cancel"), stop, cancel, "Esc", "stop"),
    )


def _changes(stage: StagePanel, hand: HandEditor, presenters: Presenters, dialogs: Dialogs) -> tuple[Command, ...]:
    """What changes the chosen design, or how it is cut."""
    command, switch = partial(Command, tr("&Design")), partial(Command.switching, tr("&Design"))
    changing = partial(command, enabled_when=CAN_CHANGE)
    trim, by_hand = tr("Cut the edge panels along the target"), tr("Edit voids and outline by hand")
    lock, unlock = tr("Lock every void against manual edits"), tr("Unlock every void for manual edits")
    even = tr("Space the edge cuts evenly along the sheet's sides")
    refit = tr("Improve the match from the current design")
    artwork = tr("Lay a picture on the sheet, and print it in register with the cuts")
    toggle, fit = presenters.voids.toggle_lock, partial(presenters.refit, True)
    return (
        switch("trim", tr("&Trim to target"), trim, stage.trim.switch, "Ctrl+T", "trim", gap=True),
        switch("hand", tr("Edit by &hand"), by_hand, stage.hand.switch, "H", "hand"),
        changing("lock", tr("&Lock voids"), tr("Lock or unlock the selected voids"), toggle, "L", "lock"),
        changing("lock_all", tr("Lock all &voids"), lock, partial(hand.lock_all, True)),
        changing("unlock_all", tr("&Unlock all voids"), unlock, partial(hand.lock_all, False)),
        changing("even_rim", tr("&Even rim"), even, hand.even_rim),
        changing("refit", tr("&Fit again"), refit, fit, "Ctrl+F", "refit"),
        command("artwork", tr("Art&work …"), artwork, dialogs.show_artwork),
        command(
            "materials",
            tr("&Materials …"),
            tr("Copy, edit and calibrate materials"),
            dialogs.show_materials,
            "Ctrl+M",
            "material",
        ),
    )


def _choices(
    gallery: GalleryPanel, generation: Generation, marks: DesignMarks, presenters: Presenters
) -> tuple[Command, ...]:
    """Which designs there are, and what becomes of them."""
    command, designs, walk = partial(Command, tr("&Design")), presenters.designs, partial(_walk, gallery.view)
    adding, changing = partial(command, enabled_when=_can_add), partial(command, enabled_when=CAN_CHANGE)
    more, alike = tr("Generate more designs from the next seed"), tr("Generate more designs like the chosen one")
    note = tr("Rename the chosen design, and note what you want to remember of it")
    pin_tip, reject_tip = tr("Pin or unpin the chosen design"), tr("Reject the chosen design (Del in the gallery)")
    rename = presenters.all_designs.rename_current

    def more_like() -> None:
        generation.more_like(gallery.bar.nearness_value)

    def pin() -> None:
        marks.pin(designs.chosen)

    def reject() -> None:
        designs.reject(designs.chosen)

    return (
        command(
            "next", tr("&Next design"), tr("Choose the next design"), partial(walk, 1), "Ctrl+Down; PgDown", gap=True
        ),
        command(
            "previous", tr("P&revious design"), tr("Choose the previous design"), partial(walk, -1), "Ctrl+Up; PgUp"
        ),
        adding("again", tr("M&ore designs"), more, generation.again, "Ctrl+R", "again", gap=True),
        adding("more_like", tr("More li&ke this"), alike, more_like, "Ctrl+Shift+R", "alike"),
        changing("pin", tr("&Pin design"), pin_tip, pin, "I", "pin", gap=True, worded=_pin_wording),
        changing("rename", tr("N&ame and note …"), note, rename, "F2", "note"),
        changing("reject", tr("Re&ject design"), reject_tip, reject, icon="reject", worded=_reject_wording),
    )


#: Enables what changes the chosen design.
CAN_CHANGE = attrgetter("can_change_design")


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
