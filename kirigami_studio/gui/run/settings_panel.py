"""The form of the next run: grid, symmetry, balance, angle, number, search; second target.

The row of the second target is made here; the window puts it below the drawing board.
"""

from __future__ import annotations

import math
import secrets
from dataclasses import replace
from typing import Any

from PySide6.QtCore import QRectF, QSettings, QSignalBlocker, QSize, Qt, QTimer, Signal
from PySide6.QtGui import QColor, QIcon, QPainter, QPaintEvent, QPen
from PySide6.QtWidgets import QLabel, QSpinBox, QToolButton, QWidget

from kirigami_studio.evaluate.second_target import USUAL_PHI, SecondTarget
from kirigami_studio.evaluate.second_target import USUAL_WEIGHT as USUAL_SECOND_WEIGHT
from kirigami_studio.foundation.settings import Choice
from kirigami_studio.foundation.words import mark, tr, tr_n
from kirigami_studio.gui.run.start_tile import OTHER_STARTS, STARTS, listed_start
from kirigami_studio.gui.stage.layout_items import target_pixmap
from kirigami_studio.gui.widgets.card import Card, ScrolledWhenShort, ToolButton, captioned, compact
from kirigami_studio.gui.widgets.choice_box import ChoiceBox
from kirigami_studio.gui.widgets.file_drops import FileDrops
from kirigami_studio.gui.widgets.form import Form
from kirigami_studio.gui.widgets.layouts import TOUCH, column, label, plain_pane, row, slider
from kirigami_studio.gui.widgets.theme import LIGHT, Palette
from kirigami_studio.lattice.ratio_field import LARGEST_GRID, SMALLEST_GRID
from kirigami_studio.outlines.starts import RECTANGLE, USUAL_WEIGHT, StartShape
from kirigami_studio.settings.design import DesignSettings

#: Values of the entries for no second target, and for the present one.
NONE, PRESENT = "none", "present"
#: The angle (degrees) is above that of the first target by this at least.
ANGLE_STEP = 0.1
PICTURE = QSize(20, 20)
ABOUT_SECOND = mark("Second target: a shape that the sheet also shows on its way. Choose it, or drop a file here.")


class SecondTargetRow(QWidget):
    """A box with the shape, a button that does without it, and two numbers."""

    changed = Signal(object)  #: SecondTarget, or None
    edited = Signal()  #: a change is complete
    other_wanted = Signal(str)  #: one of OTHER_STARTS

    def __init__(self, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self.setObjectName("plain")
        self._second: SecondTarget | None = None
        self._palette: Palette = LIGHT
        self.shape = ChoiceBox(
            "secondTarget", tr("Second target"), ((NONE, tr("None"), tr("The sheet shows the target alone.")),)
        )
        self.shape.insertSeparator(1)
        self.shape.add_choices(OTHER_STARTS)
        self.shape.setIconSize(PICTURE)
        self.remove = ToolButton("removeSecond", "close", tr("Do without the second target."))
        self.form = Form(SecondTarget, 50, parent=self)
        self.angle, self.weight = self.form.decimal("phi"), self.form.decimal("weight")
        self.drops = FileDrops(self)
        self._lay_out()
        self._connect()
        self.show_second(None, 0.0)

    def _lay_out(self) -> None:
        caption = label(tr("Sec&ond target"), self.shape)
        self.remove.setFixedSize(TOUCH, TOUCH)
        shape = column(caption, row((self.shape, 1), self.remove, spacing=2), spacing=3)
        row((shape, 14), (self.form.captioned("phi"), 9), (self.form.captioned("weight"), 7), on=self, spacing=8)

    def _connect(self) -> None:
        self.shape.activated.connect(self._choose)
        self.remove.clicked.connect(self._remove)
        self.form.changed.connect(self._take)
        self.form.edited.connect(self.edited)
        self.weight.lineEdit().setTextMargins(2, 0, 0, 0)  # its column is narrow

    def show_second(self, second: SecondTarget | None, phi: float) -> None:
        """Show a second target; ``phi`` (radians) is the angle of the first."""
        outline_before = None if self._second is None else self._second.outline
        self._second = second
        low = math.degrees(phi) + ANGLE_STEP
        with QSignalBlocker(self.angle):
            self.angle.setRange(low, 180.0 - ANGLE_STEP)
        usual = {"phi": USUAL_PHI, "weight": USUAL_SECOND_WEIGHT}
        self.form.show(usual if second is None else {name: getattr(second, name) for name in usual})
        self.angle.setToolTip(
            tr("Angle at which the sheet should show it, in degrees; 180° is flat ({low:.1f} to 179.9).", low=low)
        )
        for part in (self.angle, self.weight):
            part.setEnabled(second is not None)
        self.remove.setVisible(second is not None)
        if second is None or second.outline is not outline_before:
            self._show_shape()

    def set_palette(self, palette: Palette) -> None:
        self._palette = palette
        self._show_shape()

    def _show_shape(self) -> None:
        """Choose the present shape; it has an entry with its own name and picture."""
        second = self._second
        with QSignalBlocker(self.shape):
            row = self.shape.row_of(PRESENT)
            if row >= 0:
                self.shape.removeItem(row)
            if second is not None:
                picture = target_pixmap(second.outline, PICTURE, self.devicePixelRatioF(), self._palette, 1.5, 1.4)
                self.shape.insert_choice(1, PRESENT, second.outline.name, "")
                self.shape.setItemIcon(1, QIcon(picture))
            self.shape.choose(NONE if second is None else PRESENT)
        self.shape.setToolTip(tr(ABOUT_SECOND) if second is None else f"{second.outline.name}\n{tr(ABOUT_SECOND)}")

    def _choose(self) -> None:
        """Report what was chosen; the box keeps the present shape until another one was read."""
        chosen = self.shape.currentData()
        self._show_shape()
        if chosen == NONE:
            self._remove()
        elif chosen != PRESENT:
            self.other_wanted.emit(chosen)

    def _remove(self) -> None:
        if self._second is not None:
            self.changed.emit(None)
            self.edited.emit()

    def _take(self, change: dict[str, Any]) -> None:
        if self._second is not None:
            self.changed.emit(replace(self._second, **change))

    def paintEvent(self, event: QPaintEvent) -> None:  # noqa: N802 - Qt's name
        super().paintEvent(event)
        if self.drops.here:
            painter = QPainter(self)
            painter.setPen(QPen(QColor(self._palette.accent), 2.0, Qt.PenStyle.DashLine))
            painter.drawRoundedRect(QRectF(self.rect()).adjusted(1.0, 1.0, -1.0, -1.0), 6.0, 6.0)
            painter.end()


ROWS = mark(
    "Rows of voids, from top to bottom. More voids match the target more closely but are smaller ({low} to {high})."
)
COLUMNS = mark(
    "Columns of voids, from left to right. More voids match the target more closely but are smaller ({low} to {high})."
)
#: Value of the entry for a shape that was loaded.
LOADED_START = "loaded"
START = mark("What the sheet looks like while it is flat.")
RECTANGLES_ARE_EXACT = mark("A rectangle is matched exactly at any weight.")
#: Pixels that the rows get at least, where a small window scrolls them.
LEAST_HEIGHT = 148
#: Positions of the slider.
POSITIONS = 100
#: Milliseconds after the last key or notch that mean the slider has been let go.
LET_GO_MS = 600
KEEP_SEED = mark("Keep this seed. On: Generate repeats the same designs. Off: each run uses the next seed.")


class SettingsPanel(Card):
    """Reports each changed field by name; shows whatever the document holds."""

    changed = Signal(dict)  #: field of DesignSettings -> value
    edited = Signal()  #: a field was left, or its change is complete
    keep_changed = Signal(bool)  #: whether Generate draws from the seed that is shown
    regular_moved = Signal(float)  #: 0 match .. 1 regular, while the slider is dragged
    regular_chosen = Signal(float)  #: the slider was let go
    other_start_wanted = Signal(str)  #: one of OTHER_STARTS

    def __init__(self, parent: QWidget | None = None) -> None:
        super().__init__(tr("Design"), parent)
        self._symmetry_found = ""
        self._chosen_grid: tuple[int, int] | None = None
        self._start = RECTANGLE
        self.form = Form(DesignSettings, 48, parent=self)
        #: What is known about generators by their names; others are listed by name alone.
        self._variants = {str(one.value): one for one in self.form.settings["variant"].setting.choices}
        auto, regular = self.form.settings["auto_grid"].setting, self.form.settings["regular"].setting
        self.auto = QToolButton()
        self.auto.setObjectName(auto.widget)
        self.auto.setText(tr("Auto"))
        self.auto.setCheckable(True)
        self.auto.setFocusPolicy(Qt.FocusPolicy.TabFocus)
        self.auto.setFixedHeight(TOUCH)
        self.auto.setAccessibleName(tr(auto.spoken))
        self.auto.setToolTip(tr(auto.about))
        self.rows = _voids("rows", tr("Rows"), tr(ROWS, low=SMALLEST_GRID, high=LARGEST_GRID))
        self.columns = _voids("columns", tr("Columns"), tr(COLUMNS, low=SMALLEST_GRID, high=LARGEST_GRID))
        self.candidates, self.seed = self.form.whole("k"), self.form.whole("seed")
        self.angle = self.form.decimal("phi")
        self.dice = ToolButton("newSeed", "dice", tr("New random seed."))
        self.dice.setFixedSize(TOUCH, TOUCH)
        self.keep = ToolButton("keepSeed", "keep", tr(KEEP_SEED), checkable=True)
        self.keep.setChecked(True)
        self.keep.setFixedSize(TOUCH, TOUCH)
        self.keep.toggled.connect(self.keep_changed)
        self.symmetry, self.rim = self.form.choice("symmetry"), self.form.choice("rim")
        self.start = ChoiceBox("start", tr("Start as: outline of the flat sheet"), STARTS)
        self.start.insertSeparator(self.start.count())
        self.start.add_choices(OTHER_STARTS)
        self.regular = slider("regular", tr(regular.spoken), tr(regular.about), POSITIONS, POSITIONS // 4)
        self.regular.setSingleStep(POSITIONS // 20)
        self.regular.setFocusPolicy(Qt.FocusPolicy.TabFocus)
        self._let_go = QTimer(self, singleShot=True, interval=LET_GO_MS)
        self.more = ToolButton(
            "moreSettings",
            "down",
            tr("More settings: seed, model, polish, preference, rim, start weight, search."),
            checkable=True,
        )
        self.more.setText(tr("More"))
        self.more.setToolButtonStyle(Qt.ToolButtonStyle.ToolButtonTextBesideIcon)
        self.variant = self.form.choice("variant", (), self._choose_variant)
        self.polish = self.form.choice("polish", show=self._choose_polish)
        self.prefer = self.form.choice("prefer")
        self.start_form = Form(StartShape, 48, parent=self)
        self.start_weight = self.start_form.decimal("weight")
        self.search = self.form.switch("search")
        self.search.setMinimumHeight(29)
        self.second = SecondTargetRow()
        self._lay_out()
        self.set_variants(("balanced",))
        self._connect()

    def _lay_out(self) -> None:
        grid = row(self.auto, (self.rows, 1), QLabel("\N{MULTIPLICATION SIGN}"), (self.columns, 1), spacing=4)
        seed = row((self.seed, 1), self.dice, self.keep, spacing=4)
        caption, content = self.form.captioned, plain_pane()
        self.hidden = plain_pane()
        self.hidden.hide()
        symmetry, phi, count = caption("symmetry"), caption("phi"), caption("k")
        start, weight = captioned(tr("S&tart as"), self.start, self.start), self.start_form.captioned("weight")
        column(
            row((captioned(tr("&Grid (voids)"), self.rows, grid), 12), (symmetry, 5), spacing=8),
            row(label(tr("Mat&ch"), self.regular), (self.regular, 1), label(tr("Regular")), spacing=8),
            row((start, 14), (phi, 9), (count, 7), spacing=8),
            self.hidden,
            on=content,
            spacing=8,
        )
        column(
            row((caption("seed", seed), 4), (caption("variant"), 3), spacing=8),
            row((caption("polish"), 1), (caption("prefer"), 1), spacing=8),
            row((caption("rim"), 2), (weight, 2), (caption("search"), 3), spacing=8),
            *self.form.remaining(),
            on=self.hidden,
            spacing=8,
        )
        self.body.addWidget(ScrolledWhenShort(content, LEAST_HEIGHT))
        self.header.addWidget(self.more)

    def _connect(self) -> None:
        self.auto.clicked.connect(self._switch_auto)
        self.form.changed.connect(self.changed)
        self.form.edited.connect(self.edited)
        self.start.activated.connect(self._choose_start)
        self.regular.valueChanged.connect(self._move_regular)
        self.regular.sliderReleased.connect(self._choose_regular)
        self._let_go.timeout.connect(self._choose_regular)
        self.more.toggled.connect(self._fold)
        self.second.changed.connect(lambda second: self.changed.emit({"second": second}))
        self.second.edited.connect(self.edited)
        self.dice.clicked.connect(lambda: self.seed.setValue(secrets.randbelow(1_000_000)))
        self.start_form.changed.connect(lambda change: self.changed.emit({"start": replace(self._start, **change)}))
        self.start_form.edited.connect(self.edited)
        for box in (self.rows, self.columns):
            box.setKeyboardTracking(False)
            compact(box, 42)  # two digits
            box.valueChanged.connect(lambda: self.changed.emit({"grid": self._grid}))
            box.editingFinished.connect(self.edited)

    def _switch_auto(self, on: bool) -> None:
        """Leave the grid to the run, or keep the one that is shown."""
        self.changed.emit({"auto_grid": True} if on else {"auto_grid": False, "grid": self._grid})

    @property
    def _grid(self) -> tuple[int, int]:
        return self.rows.value(), self.columns.value()

    def _choose_start(self) -> None:
        """Report the start that was chosen; the box keeps the present one until a shape is loaded."""
        chosen = self.start.currentData()
        if chosen in (value for value, _, _ in OTHER_STARTS):
            self._show_start(self._start)
            self.other_start_wanted.emit(chosen)
        elif chosen != LOADED_START:
            self.changed.emit({"start": replace(listed_start(chosen), weight=self._start.weight)})
            self.edited.emit()

    def _move_regular(self) -> None:
        self.regular_moved.emit(self.regular.value() / POSITIONS)
        if self.regular.isSliderDown():
            self._let_go.stop()
        else:
            self._let_go.start()

    def _choose_regular(self) -> None:
        self._let_go.stop()
        self.regular_chosen.emit(self.regular.value() / POSITIONS)

    def _fold(self, shown: bool) -> None:
        self.hidden.setVisible(shown)
        self.more.show_icon("up" if shown else "down")

    def restore(self, settings: QSettings) -> None:
        """Show more settings, or not, as the last time."""
        self.more.setChecked(settings.value("moreSettings") == "yes")

    def remember(self, settings: QSettings) -> None:
        """Keep for the next time whether more settings are shown."""
        settings.setValue("moreSettings", "yes" if self.more.isChecked() else "no")

    def show_symmetry(self, sentence: str) -> None:
        """Show in the tooltip how symmetric the target is; an empty sentence while that is unknown."""
        self._symmetry_found = sentence
        self._show_symmetry_tip()

    def show_grid_choice(self, grid: tuple[int, int] | None, reason: str) -> None:
        """Show the grid that the next run will choose, its reason in the tooltip; None if unknown."""
        self._chosen_grid = grid
        auto = self.form.settings["auto_grid"].setting
        about = tr(auto.about)
        self.auto.setToolTip(f"{about}\n{reason}" if reason else about)
        self.auto.setAccessibleDescription(reason)
        if grid is not None and self.auto.isChecked():
            self._show_grid(grid)

    def _show_grid(self, grid: tuple[int, int]) -> None:
        for box, count in zip((self.rows, self.columns), grid, strict=True):
            with QSignalBlocker(box):
                box.setValue(count)

    def _show_symmetry_tip(self) -> None:
        self.symmetry.setToolTip("\n".join(part for part in (self.symmetry.about, self._symmetry_found) if part))
        self.symmetry.setAccessibleDescription(self._symmetry_found)

    def set_variants(self, names: tuple[str, ...]) -> None:
        """Offer these generators; the chosen one stays."""
        chosen = self.variant.currentData()
        with QSignalBlocker(self.variant):
            self.variant.clear()
            self.variant.add_choices([self._variants.get(name, Choice(name, name)) for name in names])
            if chosen is not None:
                self._choose_variant(chosen)

    def show_settings(self, settings: DesignSettings) -> None:
        """Show the document's settings without reporting them as gestures."""
        self.form.show_settings(settings)
        self.auto.setChecked(settings.auto_grid)
        self._show_grid(self._chosen_grid if settings.auto_grid and self._chosen_grid else settings.grid)
        if not self.regular.isSliderDown() and not self._let_go.isActive():
            with QSignalBlocker(self.regular):
                self.regular.setValue(round(POSITIONS * settings.regular))
        self._show_start(settings.start)
        self.second.show_second(settings.second, settings.phi)
        self._show_symmetry_tip()
        self.rim.setToolTip(self.rim.about)
        self._show_preference(fitted=settings.polish > 0 or settings.search > 0)

    def _show_start(self, start: StartShape) -> None:
        """Choose a start; one that was loaded has an entry of its own as long as it is present."""
        self._start = start
        listed = self.start.findData(start.name)
        plain = replace(start, weight=USUAL_WEIGHT)
        is_listed = 0 <= listed < len(STARTS) and plain == listed_start(start.name)
        with QSignalBlocker(self.start):
            loaded = self.start.findData(LOADED_START)
            if loaded >= 0:
                self.start.removeItem(loaded)
            if not is_listed:
                listed = len(STARTS)
                self.start.insert_choice(listed, LOADED_START, start.name, "")
            self.start.setCurrentIndex(listed)
        self.start.setToolTip(f"{tr(START)}\n{self.start.about}")
        self.start_form.show_settings(start)
        held, weight = start.outline is not None, self.start_form.settings["weight"]
        self.start_weight.setEnabled(held)
        self.start_weight.setToolTip(tr(weight.setting.about, **weight.numbers) if held else tr(RECTANGLES_ARE_EXACT))

    def _choose_polish(self, steps: int) -> None:
        self.polish.choose(steps, tr_n("{count} step", "{count} steps", steps))
        self.polish.setToolTip(tr("How thoroughly designs are fitted to the target: up to {steps} steps.", steps=steps))

    def _show_preference(self, fitted: bool) -> None:
        self.prefer.setEnabled(fitted)
        tip = tr("What polishing prefers among nearly equal matches. {about}", about=self.prefer.about)
        self.prefer.setToolTip(tip if fitted else tr("What polishing prefers. Turn on Polish to use it."))

    def _choose_variant(self, name: str) -> None:
        known = self._variants.get(name)
        self.variant.choose(name, name if known is None else known.label)
        about = "" if known is None else tr(known.about)
        self.variant.setToolTip(tr("Model that generates the designs. {about}", about=about).strip())


def _voids(name: str, accessible: str, tip: str) -> QSpinBox:
    box = QSpinBox()
    box.setObjectName(name)
    box.setRange(SMALLEST_GRID, LARGEST_GRID)
    box.setToolTip(tip)
    box.setAccessibleName(accessible)
    return box
