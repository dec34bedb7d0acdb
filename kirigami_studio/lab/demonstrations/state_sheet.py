"""A screenshot of every state of the window, in every size and both themes, for review.

``python -m kirigami_studio.lab.demonstrations.state_sheet --out out/states`` writes them, and a page of small ones
for every size and theme; ``--language de`` in German, ``--scale 2`` on a screen of 3840 x 2160 at twice the scale,
``--chapters pages`` only the three pages: empty, at first, done, with long names, refused, busy.
"""

from __future__ import annotations

import math
import re
import sys
import traceback
from collections import defaultdict
from collections.abc import Callable, Sequence
from dataclasses import replace
from pathlib import Path

from PIL import Image, ImageDraw, ImageFont
from PySide6.QtCore import QEvent, QPoint, Qt
from PySide6.QtWidgets import QApplication

from kirigami_studio.foundation.errors import KirigamiError
from kirigami_studio.foundation.words import tr
from kirigami_studio.gui.gallery.cards import CardButton
from kirigami_studio.gui.gallery.gallery_selection import SortOrder
from kirigami_studio.gui.make.cut_view import CutOverlay
from kirigami_studio.gui.session.messages import Message, Tone
from kirigami_studio.gui.session.overlays import Overlay
from kirigami_studio.gui.target.target_view import Tool
from kirigami_studio.gui.widgets.theme import DARK, LIGHT
from kirigami_studio.gui.window.pages import WindowPage
from kirigami_studio.lab.demonstrations.board_states import LONG_NAME, BoardStates
from kirigami_studio.lab.demonstrations.offscreen_session import DESIGNS, SessionError, click, hover, main, press_key
from kirigami_studio.project import recovery
from kirigami_studio.project.document import Mark
from kirigami_studio.project.labels import LONGEST_NAME
from kirigami_studio.project.recovery import RecoveryNote
from kirigami_studio.studio.targets import outline_of

#: ``STATE-WIDTHxHEIGHT-THEME.png``, as the state sheet names its pictures.
NAME = re.compile(r"(?P<state>.+)-(?P<group>\d+x\d+-(?:light|dark))")
#: Pixels: width of one small picture, and the band for its caption.
WIDTH, CAPTION = 480, 22
GAP = 10
COLUMNS = 4
PAPER, INK = "#8a94a0", "#0b0f14"
#: Width (mm) of a cut that leaves no panel.
TOO_WIDE = 4.0


def contact_sheets(pictures: Sequence[Path], out: Path) -> list[Path]:
    """Write one page for every size and theme among the pictures.

    Parameters
    ----------
    pictures : sequence of Path
        Those that are named otherwise share a page of their own, ``others``.
    out : Path
        Folder of the pages.

    Returns
    -------
    pages : list of Path
        ``contact-GROUP.png``, in the order in which the groups first appear.
    """
    groups: dict[str, list[tuple[str, Path]]] = defaultdict(list)
    for picture in pictures:
        found = NAME.fullmatch(picture.stem)
        group, state = (found["group"], found["state"]) if found else ("others", picture.stem)
        groups[group].append((state, picture))
    pages = []
    for group, entries in groups.items():
        page = out / f"contact-{group}.png"
        contact_sheet(entries).save(page)
        pages.append(page)
    return pages


def contact_sheet(entries: Sequence[tuple[str, Path]]) -> Image.Image:
    """One page of captioned pictures, row by row."""
    small = [(caption, _small(path)) for caption, path in entries]
    height = max(picture.height for _, picture in small) + CAPTION
    columns = min(COLUMNS, len(small))
    rows = -(-len(small) // columns)
    page = Image.new("RGB", (columns * (WIDTH + GAP) + GAP, rows * (height + GAP) + GAP), PAPER)
    draw, font = ImageDraw.Draw(page), ImageFont.load_default(size=13)
    for number, (caption, picture) in enumerate(small):
        row, column = divmod(number, columns)
        left, top = GAP + column * (WIDTH + GAP), GAP + row * (height + GAP)
        draw.text((left, top + 2), caption, fill=INK, font=font)
        page.paste(picture, (left, top + CAPTION))
    return page


def _small(path: Path) -> Image.Image:
    """A picture no wider than its column, and no higher than three quarters of that."""
    with Image.open(path) as picture:
        shown = picture.convert("RGB")
    shown.thumbnail((WIDTH, WIDTH * 3 // 4), Image.Resampling.LANCZOS)
    return shown


class StateSheet(BoardStates):
    """Takes one window from state to state, with a screenshot of each in all sizes and themes."""

    #: Chapters to picture; each begins where the one before it ended.
    chapters: Sequence[str] = ("pages", "board", "collection", "stage", "making", "project", "dialogs", "pairs")

    def play(self) -> list[Path]:
        """Make all pictures and return their files."""
        window = self.window
        window.show()
        for chapter in self.chapters:
            CHAPTERS[chapter](self)
        window.session.history.mark_saved()
        window.close()
        self.files.extend(contact_sheets([file for file in self.files if file.suffix == ".png"], self.out))
        return self.files

    def all_pages(self, state: str) -> None:
        """Picture each page in every size and theme, and go back to the page before."""
        before = self.window.pages.page
        for page in WindowPage:
            self.window.pages.turn(page)
            self.all_sizes(f"{page.value}-{state}")
        self.window.pages.turn(before)

    def pages(self) -> None:
        """The three pages in all their states, and a run whose designs improve at the end."""
        self.all_pages("empty")
        self.first()
        self.done()
        self.long()
        self.refused()
        self.busy()

    def first(self) -> None:
        """With the first question, over a finished pair."""
        presenter, page = self.window.presenters.welcome, self.window.welcome
        presenter.begin()
        page.question.offer()
        page.ask(True)
        self.until(lambda: page.ready and page.pairs.complete, "the sample was not read")
        page.stop()
        page.view.set_phi(math.radians(100.0))
        self.all_sizes("first-question")
        presenter.decline()
        self.all_sizes("sample")

    def done(self) -> None:
        """With designs, one of them planned, judged and exported."""
        self.window.files.open_sample()
        self._judged()
        self.all_pages("done")

    def long(self) -> None:
        """With long names of project, target, design and file."""
        window, session = self.window, self.window.session
        document = session.document
        if document.target is None or session.stage is None:
            raise SessionError("There is no design to name.")
        label = document.label_of(session.stage.candidate)
        if label is not None:
            window.services.labels.set(
                label, LONG_NAME[:LONGEST_NAME], "The lobes are even; cut this one for the fair."
            )
        renamed = replace(document.target, name=LONG_NAME)
        session.restart(replace(session.document, target=renamed), Path(f"{LONG_NAME}.kiri"))
        window.services.fabrication.change(machine="cricut-maker", material="polypropylene-co2")
        state = window.services.verdict
        self.until(lambda: state.state.verdict is not None and not state.state.pending, "the verdict did not come")
        window.messages.add(Message(f"{LONG_NAME}.svg could not be read: {LONG_NAME}.", Tone.WARNING))
        self.all_pages("long")
        self._no_messages()
        window.commands["undo"].trigger()
        self._judged()

    def refused(self) -> None:
        """With cuts that leave no panel, an error with its details, and then a question."""
        window, bar = self.window, self.window.messages
        window.services.fabrication.change(kerf_mm=TOO_WIDE)
        self.until(lambda: not window.fabrication.export.isEnabled(), "the wide kerf was not refused")
        damaged = self.out / f"{LONG_NAME}.svg"
        damaged.write_text("<svg><path", encoding="utf-8")
        try:
            outline_of(str(damaged))
        except KirigamiError as error:
            bar.add(Message(str(error), Tone.ERROR, traceback.format_exc()))
        bar.details.setChecked(True)
        self.all_pages("refused")
        window.commands["new"].trigger()
        self.all_sizes("question")
        self._no_messages()
        window.commands["undo"].trigger()
        self._judged()

    def busy(self) -> None:
        """A short run, while its designs improve."""
        window = self.window
        settings = window.services.settings
        settings.change(grid=(8, 8))
        settings.change(k=DESIGNS)
        settings.change(polish=20)
        click(window.run.generate)
        model = window.gallery.view.model_
        self.until(lambda: any(one.candidate.polished for one in model.entries), "no design was polished")
        self.all_pages("busy")
        self.until(lambda: not window.services.run.running, "the run did not end")
        self._judged()

    def _no_messages(self) -> None:
        while self.window.messages.messages:
            self.window.messages.close_message()

    def board(self) -> None:
        """The board with its tools, the picker of parts, a photo, and designs for a heart."""
        window = self.window
        window.services.targeting.clear()
        window.target.set_tool(Tool.POLYGON)
        self.all_sizes("drawing")
        self.editor()
        self.objects()
        self.points_and_mirror()
        window.target.set_editing(False)
        self.parts()
        self.picture_target()
        self.all_sizes("photo")
        window.target.set_editing(True)
        self.all_sizes("photo-editor")
        window.target.set_editing(False)
        self.choose_heart()
        self.busy()
        self.lost_designs()

    def stage(self) -> None:
        """A design with overlays and curves, as drawn, trimmed, changed by hand, half open and flat."""
        self.overlays()
        self.plots()
        self.before_and_after()
        self.trimmed()
        self.by_hand()
        for name, degrees in (("half-open", 100.0), ("flat", 180.0)):
            self.window.stage.deployment.set_phi(math.radians(degrees))
            self.all_sizes(name)

    def making(self) -> None:
        """The cut plan, its files, and the windows that make them."""
        self.cuts()
        self.exported()
        self.printing()

    def pairs(self) -> None:
        """The starts, the pairs, and a second target."""
        self.starts()
        self.second_target()

    def printing(self) -> None:
        """The dialog of the printed pattern."""
        self.window.commands["print"].trigger()
        dialog = self.window.dialogs.printing
        if dialog is None:
            raise SessionError("The print dialog did not open.")
        self.both_themes("print", dialog)
        dialog.close()

    def dialogs(self) -> None:
        """The library, the guide, the sheet of keys, and the licences."""
        dialogs = self.window.dialogs
        click(self.window.target.buttons["library"])
        if dialogs.picker is not None:
            self.both_themes("library", dialogs.picker)
            dialogs.picker.close()
        dialogs.show_guide()
        dialogs.show_shortcuts()
        dialogs.show_about()
        for name, dialog in (("guide", dialogs.guide), ("shortcuts", dialogs.shortcuts), ("about", dialogs.about)):
            if dialog is not None:
                self.both_themes(name, dialog)

    def collection(self) -> None:
        """Marks, filters, more designs like one, two side by side; then everything as it was."""
        window, services = self.window, self.window.services
        view, bar, before = window.gallery.view, window.gallery.bar, len(services.session.document.candidates)
        for row in (1, 2):
            services.marks.pin(services.session.document.candidates[row])
        services.marks.reject(services.session.document.candidates[3], None)
        click(bar.filter)
        for box in (bar.filters.works, bar.filters.rejected):
            box.setChecked(True)
        bar.order.setCurrentIndex(bar.order.findData(SortOrder.PANEL))
        bar.order.activated.emit(bar.order.currentIndex())
        hover(
            view.viewport(), view.cards.button_boxes(view.visualRect(view.model_.index(0, 0)))[CardButton.PIN].center()
        )
        self.all_sizes("gallery-sorted")
        bar.filters.least.setValue(100.0)
        self.all_sizes("gallery-nothing")
        view.clear_wanted.emit()
        bar.filters.rejected.setChecked(False)
        bar.order.setCurrentIndex(0)
        bar.order.activated.emit(0)
        click(bar.alike)
        self.all_sizes("gallery-alike")
        click(bar.draw)
        self.until(lambda: not services.run.running, "the run near a design did not end")
        self.until(window.fabrication.export.isEnabled, "no cut plan was made")
        self.all_sizes("gallery-more")
        click(bar.alike)
        self.all_designs()
        self.side_by_side()
        while len(services.session.document.candidates) > before or set(services.session.document.marks) != {Mark.NONE}:
            window.commands["undo"].trigger()
        self.until(lambda: view.model_.rowCount() == before, "undo did not bring the first designs back")
        self.until(window.fabrication.export.isEnabled, "no cut plan was made")

    def all_designs(self) -> None:
        """The table of all designs with a renamed one and three that are marked, these compared, and nothing left."""
        window, services = self.window, self.window.services
        label = services.session.document.label_of(window.gallery.view.model_.entries[0].candidate)
        if label is not None:
            services.labels.set(label, LONG_NAME[:30], "The lobes are even; cut this one for the fair.")
        window.commands["all_designs"].trigger()
        page = window.presenters.all_designs.page
        if page is None:
            raise SessionError("The table of all designs did not open.")
        for key in (Qt.Key.Key_1, Qt.Key.Key_Right, Qt.Key.Key_2, Qt.Key.Key_Right, Qt.Key.Key_3):
            press_key(page.table, key)

        def drawn() -> None:
            page.table.viewport().repaint()
            self.until(lambda: not page.table.cards.pending, "the cards got no pictures")

        self.all_sizes("all-designs", drawn)
        page.filters.least.setValue(100.0)
        self.all_sizes("all-designs-nothing")
        click(page.show_all)
        press_key(page.table, Qt.Key.Key_C)
        window.stage.compare.set_phi(math.radians(60.0))
        self.all_sizes("all-designs-compared")
        click(window.stage.compare.leave)
        page.table.clear_compared()
        window.commands["rename"].trigger()
        if window.dialogs.label is not None:
            self.picture("name-and-note", window.dialogs.label)
            window.dialogs.label.close()
        window.commands["all_designs"].trigger()
        window.commands["undo"].trigger()

    def side_by_side(self) -> None:
        """Two designs at the target and half open, zoomed; the menu of a card."""
        window = self.window
        click(window.gallery.bar.compare)
        self.all_sizes("compare")
        window.stage.deployment.set_phi(math.radians(100.0))
        window.stage.compare.zoom(2.0)
        self.all_sizes("compare-half-open")
        window.stage.deployment.set_phi(0.0)
        click(window.stage.compare.leave)
        window.presenters.designs.show_menu(window.session.document.candidates[0], QPoint(100, 100))
        menu = window.presenters.designs.menu
        if menu is not None:
            self.picture("card-menu", menu)
            menu.close()

    def overlays(self) -> None:
        """The heat map with the smallest parts at the target angle, openings and numbers half open."""
        stage = self.window.stage
        for angle, shown in (
            (0.0, (Overlay.RATIOS, Overlay.SMALL_PARTS)),
            (100.0, (Overlay.OPENINGS, Overlay.PANEL_NUMBERS, Overlay.VOID_NUMBERS)),
        ):
            stage.deployment.set_phi(math.radians(angle))
            for overlay in shown:
                stage.overlays[overlay].setChecked(True)
            self.all_sizes(f"overlay-{shown[0].value}")
            for overlay in shown:
                stage.overlays[overlay].setChecked(False)
        stage.deployment.set_phi(0.0)

    def plots(self) -> None:
        """The curves of the design, with the line at 60 degrees."""
        stage = self.window.stage
        click(stage.plots_switch)
        self.until(lambda: stage.plots.complete, "the curves were not read")
        stage.deployment.set_phi(math.radians(60.0))
        self.all_sizes("plots")
        click(stage.plots_switch)
        stage.deployment.set_phi(0.0)

    def before_and_after(self) -> None:
        """The first design that polishing has changed, as it was drawn."""
        services, stage = self.window.services, self.window.stage
        drawn = [candidate for candidate in services.session.document.candidates if candidate.sampled_sheet is not None]
        if not drawn:
            raise SessionError("Polishing changed no design.")
        services.chosen.choose(drawn[0])
        click(stage.before)
        self.until(lambda: stage.showing_before, "the drawn design was not shown")
        self.all_sizes("before")
        click(stage.before)

    def trimmed(self) -> None:
        """The same design trimmed, opened and flat, and whole again."""
        services, stage = self.window.services, self.window.stage
        click(stage.trim)
        self.picture("trimming")
        self.until(lambda: not services.chosen.trimming.busy, "trimming did not end")
        if services.session.stage is None or services.session.stage.candidate.trim is None:
            raise SessionError("The design was not trimmed.")
        self.until(self._planned, "no trimmed cut plan was made")
        self.all_sizes("trimmed")
        self.window.commands["cuts"].trigger()
        self.all_sizes("trimmed-cuts")
        self.window.commands["cuts"].trigger()
        stage.deployment.set_phi(math.radians(60.0))
        self.all_sizes("trimmed-half-open")
        stage.deployment.set_phi(math.pi)
        self.all_sizes("trimmed-flat")
        stage.deployment.set_phi(0.0)
        click(stage.trim)
        self.until(lambda: not self._planned() and self.window.fabrication.export.isEnabled(), "no whole cut plan")

    def by_hand(self) -> None:
        """Hand editing, with locked voids and a label at the pointer."""
        window, view, services = self.window, self.window.stage.view, self.window.services
        before = window.session.history.position
        click(window.stage.hand)
        services.hand.lock(frozenset((row, column) for row in (2, 3) for column in (3, 4, 5)), True)
        for name, degrees in (("half-open", 70.0), ("flat", 180.0), ("target", 0.0)):
            window.stage.deployment.set_phi(math.radians(degrees))
            view.voids.select(frozenset({(5, 5)}))
            self.all_sizes(f"by-hand-{name}", lambda: view.voids.point_at((6, 6)))
        QApplication.sendEvent(view, QEvent(QEvent.Type.Leave))
        services.hand.nudge(frozenset({(5, 5)}), 0.3)
        self.until(lambda: not services.hand.busy, "the changed ratio was not scored")
        self.all_sizes("by-hand-changed")
        while window.session.history.position > before:
            window.commands["undo"].trigger()
        click(window.stage.hand)

    def cuts(self) -> None:
        """The cut plan: whole, half cut with its travel, with connectors of their own and a problem, with options and
        the name engraved.
        """
        fabrication = self.window.fabrication
        page, history = self.window.cuts, self.window.session.history
        before = history.position
        self.window.commands["cuts"].trigger()
        self.all_sizes("cuts")
        click(page.toggles[CutOverlay.TRAVEL])
        page.bar.slider.setValue(page.bar.slider.maximum() // 2)
        self.all_sizes("cuts-half")
        click(page.toggles[CutOverlay.TRAVEL])
        for hinges, width in ((range(30), 0.45), (range(30, 50), 0.05)):
            page.view.gestures.select(frozenset(hinges))
            page.hinges.width_mm.setValue(width)
        self.until(lambda: page.problems.isVisible(), "the narrow connectors were not found")
        self.all_sizes("cuts-connectors")
        page.problems.setCurrentRow(0)
        self.all_sizes("cuts-problem")
        page.view.fit()
        while history.position > before:
            self.window.commands["undo"].trigger()
        self.until(lambda: not page.problems.isVisible(), "undo did not bring the connectors back")
        page.view.gestures.select(frozenset())
        self.window.commands["cuts"].trigger()
        self.window.pages.turn(WindowPage.MAKE)
        self.all_sizes("options")
        click(fabrication.options.engrave)
        self.until(lambda: page.view.shows_name, "the name was not engraved")
        self.all_sizes("cuts-name")
        self.window.commands["undo"].trigger()
        self.until(lambda: not page.view.shows_name, "undo did not take the name off")
        self.window.pages.turn(WindowPage.DESIGN)

    def exported(self) -> None:
        """The report of a cut file and the material editor, in both themes."""
        dialogs = self.window.dialogs
        self.window.services.exporter.export(self.out / "cut.dxf")
        self.until(lambda: dialogs.report is not None, "no report was shown")
        dialogs.show_materials()
        for name, dialog in (("report", dialogs.report), ("materials", dialogs.materials)):
            if dialog is not None:
                self.both_themes(name, dialog)
        if dialogs.materials is not None:
            dialogs.materials.close()
        dialogs.close_report()
        self._no_messages()

    def _planned(self) -> bool:
        return bool(self.window.fabrication.summary.text())

    def project(self) -> None:
        """Recovered work, the submenus of files and pictures, the history with undone steps."""
        window, dialogs = self.window, self.window.dialogs
        filing, folder = window.services.project, self.out / "recovery"
        left = folder / "left.kiri"
        note = RecoveryNote("teapot.kiri", str(self.out / "teapot.kiri"), "2026-11-21T12:03:00+00:00")
        recovery.keep(window.session.document, note, left)
        filing.recovery.use(folder)
        bar, discard = window.messages, tr("Discard")
        self.until(lambda: any(discard in dict(one.actions) for one in bar.messages), "the lost work was not offered")
        self.all_sizes("recovery")
        dict(bar.messages[-1].actions)[discard]()
        self._no_messages()
        for name in ("teapot.kiri", "session.kiri"):
            filing.recent.take_project(self.out / name)
        filing.recent.take_target(str(self.out / f"{LONG_NAME}.png"))
        window.recent_menu.show_missing(frozenset({str((self.out / "teapot.kiri").absolute())}))
        window.commands["history"].trigger()
        window.services.project.go_to(max(0, window.session.history.position - 2))
        for palette in (DARK, LIGHT):
            window.appearance.set_theme(palette)
            for menu, name in ((window.recent_menu, "recent"), (window.picture_menu, "pictures")):
                menu.popup(window.mapToGlobal(window.rect().topLeft()))
                self.picture(f"menu-{name}-{palette.name}", menu)
                menu.close()
            if dialogs.history is not None:
                dialogs.history.show_history(window.session.history, palette)
                self.picture(f"history-{palette.name}", dialogs.history)
        window.services.project.go_to(len(window.session.history.steps))
        if dialogs.history is not None:
            dialogs.history.close()

    def second_target(self) -> None:
        """A run for a second target: its settings, and the best design at its angle; the board it is drawn on."""
        window, services = self.window, self.window.services
        services.settings.change(grid=(8, 8))
        services.settings.change(k=2)
        services.settings.change(polish=5)
        window.settings.more.setChecked(True)
        services.second.open("hexagon")
        self.until(lambda: services.session.document.settings.second is not None, "the second target was not read")
        window.settings.second.angle.setValue(60.0)
        click(window.run.generate)
        self.until(lambda: not services.run.running, "the run did not end")
        self.until(window.fabrication.export.isEnabled, "no cut plan was made")
        window.stage.deployment.set_phi(math.radians(60.0))
        self.all_sizes("second-target-settings")
        window.settings.more.setChecked(False)
        self.all_sizes("second-target")
        window.dialogs.show_second_board()
        if window.dialogs.second_board is not None:
            self.picture("second-board", window.dialogs.second_board)
            window.dialogs.second_board.close()


#: What each chapter pictures.
CHAPTERS: dict[str, Callable[[StateSheet], None]] = {
    "pages": StateSheet.pages,
    "board": StateSheet.board,
    "collection": StateSheet.collection,
    "stage": StateSheet.stage,
    "making": StateSheet.making,
    "project": StateSheet.project,
    "dialogs": StateSheet.dialogs,
    "pairs": StateSheet.pairs,
}

if __name__ == "__main__":
    sys.exit(main(kind=StateSheet))
