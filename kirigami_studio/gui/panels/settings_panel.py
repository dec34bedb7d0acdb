"""How the next run searches: grid, angle, number of candidates, seed, generator, polish, search."""

from __future__ import annotations

import math
import secrets

from PySide6.QtCore import QSignalBlocker, Qt, Signal
from PySide6.QtWidgets import (
    QCheckBox,
    QComboBox,
    QHBoxLayout,
    QLabel,
    QSizePolicy,
    QSpinBox,
    QWidget,
)

from kirigami_studio.foundation.words import tr, tr_n
from kirigami_studio.gui.panels.card import Card, ToolButton, captioned, compact
from kirigami_studio.gui.panels.number_field import DecimalField
from kirigami_studio.lattice.ratio_field import LARGEST_GRID, SMALLEST_GRID
from kirigami_studio.pipeline.request import LARGEST_K
from kirigami_studio.project.settings import DesignSettings

LARGEST_SEED = 2**31 - 1
TOOLTIP = Qt.ItemDataRole.ToolTipRole

#: What is known about a generator by its name; others are listed by name alone.
VARIANTS = {
    "prior": (tr("Prior"), tr("Trained on random sheets only: most variety, rougher layouts.")),
    "accuracy": (tr("Accuracy"), tr("Tuned for the closest match.")),
    "regularity": (tr("Regularity"), tr("Tuned for even panels that are easy to cut; slightly lower match.")),
    "balanced": (tr("Balanced"), tr("Tuned for both match and even panels. Recommended.")),
}


#: How thoroughly designs are fitted on the exact geometry: name, steps, what it means.
POLISH = (
    (tr("Off"), 0, tr("Keep designs as generated.")),
    (tr("Light"), 5, tr("A quick fit: most of the improvement, close to the generated design.")),
    (tr("Full"), 15, tr("Nearly converged. Recommended.")),
    (tr("Deep"), 60, tr("Continues until nothing improves; for sharp corners and thin arms.")),
)

#: What a fit prefers among nearly equal matches: name of the preference, label, what it means.
PREFER = (
    ("accuracy", tr("Accuracy"), tr("The closest match, regardless of panel shape.")),
    ("balanced", tr("Balanced"), tr("Recommended: nearly as close, and about 20 % more even.")),
    ("regularity", tr("Regularity"), tr("A third less TV than Balanced, at 0.1 to 0.2 % less match.")),
    ("calm", tr("Calm"), tr("About half the TV of Balanced, at 0.2 to 0.9 % less match.")),
)
SEARCH = tr(
    "Search for one more design by way of easier shapes. Takes a few seconds; helps with thin arms and notches."
)
KEEP_SEED = tr("Keep this seed. On: Generate repeats the same designs. Off: each run uses the next seed.")


class SettingsPanel(Card):
    """Reports each changed field by name; shows whatever the document holds."""

    changed = Signal(dict)  #: field of DesignSettings -> value
    edited = Signal()  #: a field was left
    keep_changed = Signal(bool)  #: whether Generate draws from the seed that is shown

    def __init__(self, parent: QWidget | None = None) -> None:
        super().__init__(tr("Design"), parent)
        self.rows = _whole(
            "rows",
            tr("Rows"),
            SMALLEST_GRID,
            LARGEST_GRID,
            tr(
                "Rows of voids, from top to bottom. More voids match the target more closely but are smaller "
                "({low} to {high}).",
                low=SMALLEST_GRID,
                high=LARGEST_GRID,
            ),
        )
        self.columns = _whole(
            "columns",
            tr("Columns"),
            SMALLEST_GRID,
            LARGEST_GRID,
            tr(
                "Columns of voids, from left to right. More voids match the target more closely but are smaller "
                "({low} to {high}).",
                low=SMALLEST_GRID,
                high=LARGEST_GRID,
            ),
        )
        self.candidates = _whole(
            "candidates",
            tr("Designs"),
            1,
            LARGEST_K,
            tr("Number of designs to generate and compare (1 to {most}).", most=LARGEST_K),
        )
        self.seed = _whole(
            "seed",
            tr("Seed"),
            0,
            LARGEST_SEED,
            tr("Random seed. The same seed gives the same designs."),
        )
        self.angle = DecimalField()
        self.angle.setObjectName("targetAngle")
        self.angle.setRange(0.0, 179.0)
        self.angle.setDecimals(1)
        self.angle.setSuffix("°")
        self.angle.setAccessibleName(tr("Target angle in degrees"))
        self.angle.setToolTip(
            tr("Deployment angle at which the sheet matches the target, in degrees; 0° is fully turned.")
        )
        self.dice = ToolButton("newSeed", "dice", tr("New random seed."))
        self.dice.setFixedSize(29, 29)
        self.keep = ToolButton("keepSeed", "keep", KEEP_SEED, checkable=True)
        self.keep.setChecked(True)
        self.keep.setFixedSize(29, 29)
        self.keep.toggled.connect(self.keep_changed)
        self.variant = _choice("variant", tr("Generator variant"))
        self.polish = _choice("polish", tr("Polish"))
        for title, steps, about in POLISH:
            self.polish.addItem(title, steps)
            self.polish.setItemData(self.polish.count() - 1, about, TOOLTIP)
        self.prefer = _choice("prefer", tr("What polishing prefers"))
        for name, title, about in PREFER:
            self.prefer.addItem(title, name)
            self.prefer.setItemData(self.prefer.count() - 1, about, TOOLTIP)
        self.search = QCheckBox(tr("Se&arch"))
        self.search.setObjectName("search")
        self.search.setFocusPolicy(Qt.FocusPolicy.TabFocus)
        self.search.setAccessibleName(tr("Search beyond the samples"))
        self.search.setToolTip(SEARCH)
        self.search.setMinimumHeight(29)
        self._lay_out()
        self.set_variants(("balanced",))
        self._connect()

    def _lay_out(self) -> None:
        grid = _side_by_side(self.rows, QLabel("\N{MULTIPLICATION SIGN}"), self.columns)
        seed = _side_by_side(self.seed, self.dice, self.keep)
        first, second, third = QHBoxLayout(), QHBoxLayout(), QHBoxLayout()
        for row in (first, second, third):
            row.setSpacing(10)
            self.body.addLayout(row)
        first.addLayout(captioned(tr("&Grid (voids)"), self.rows, grid), 5)
        first.addLayout(captioned(tr("Ang&le"), self.angle, self.angle), 3)
        first.addLayout(captioned(tr("Desig&ns"), self.candidates, self.candidates), 3)
        second.addLayout(captioned(tr("&Seed"), self.seed, seed), 4)
        second.addLayout(captioned(tr("&Model"), self.variant, self.variant), 3)
        third.addLayout(captioned(tr("Pol&ish"), self.polish, self.polish), 7)
        third.addLayout(captioned(tr("&Prefer"), self.prefer, self.prefer), 10)
        third.addLayout(captioned("", self.search, self.search))
        third.setSpacing(8)

    def _connect(self) -> None:
        self.rows.valueChanged.connect(lambda: self.changed.emit({"grid": (self.rows.value(), self.columns.value())}))
        self.columns.valueChanged.connect(
            lambda: self.changed.emit({"grid": (self.rows.value(), self.columns.value())})
        )
        self.angle.valueChanged.connect(lambda value: self.changed.emit({"phi": math.radians(value)}))
        self.candidates.valueChanged.connect(lambda value: self.changed.emit({"k": value}))
        self.seed.valueChanged.connect(lambda value: self.changed.emit({"seed": value}))
        self.variant.activated.connect(lambda _: self.changed.emit({"variant": self.variant.currentData()}))
        self.polish.activated.connect(lambda _: self.changed.emit({"polish": self.polish.currentData()}))
        self.prefer.activated.connect(lambda _: self.changed.emit({"prefer": self.prefer.currentData()}))
        self.search.toggled.connect(lambda on: self.changed.emit({"search": int(on)}))
        self.dice.clicked.connect(lambda: self.seed.setValue(secrets.randbelow(1_000_000)))
        for box in (self.rows, self.columns, self.angle, self.candidates, self.seed):
            box.setKeyboardTracking(False)
            compact(box, 54)
            box.editingFinished.connect(self.edited)

    def set_variants(self, names: tuple[str, ...]) -> None:
        """Offer these generators; the chosen one stays."""
        chosen = self.variant.currentData()
        with QSignalBlocker(self.variant):
            self.variant.clear()
            for name in names:
                title, about = VARIANTS.get(name, (name, ""))
                self.variant.addItem(title, name)
                self.variant.setItemData(self.variant.count() - 1, about, TOOLTIP)
            if chosen is not None:
                self._choose_variant(chosen)

    def show_settings(self, settings: DesignSettings) -> None:
        """Show the document's settings without reporting them as gestures."""
        values = (
            (self.rows, settings.grid[0]),
            (self.columns, settings.grid[1]),
            (self.candidates, settings.k),
            (self.seed, settings.seed),
        )
        for box, value in values:
            with QSignalBlocker(box):
                box.setValue(value)
        with QSignalBlocker(self.angle):
            self.angle.setValue(math.degrees(settings.phi))
        with QSignalBlocker(self.variant):
            self._choose_variant(settings.variant)
        with QSignalBlocker(self.polish):
            self._choose_polish(settings.polish)
        with QSignalBlocker(self.prefer):
            self._choose_preference(settings.prefer, settings.polish > 0 or settings.search > 0)
        with QSignalBlocker(self.search):
            self.search.setChecked(settings.search > 0)

    def _choose_polish(self, steps: int) -> None:
        index = self.polish.findData(steps)
        if index < 0:
            self.polish.addItem(tr_n("{count} step", "{count} steps", steps), steps)
            index = self.polish.count() - 1
        self.polish.setCurrentIndex(index)
        self.polish.setToolTip(tr("How thoroughly designs are fitted to the target: up to {steps} steps.", steps=steps))

    def _choose_preference(self, name: str, fitted: bool) -> None:
        index = self.prefer.findData(name)
        if index < 0:
            self.prefer.addItem(name, name)
            index = self.prefer.count() - 1
        self.prefer.setCurrentIndex(index)
        self.prefer.setEnabled(fitted)
        about = self.prefer.itemData(index, TOOLTIP) or ""
        tip = tr("What polishing prefers among nearly equal matches. {about}", about=about).strip()
        self.prefer.setToolTip(tip if fitted else tr("What polishing prefers. Turn on Polish to use it."))

    def _choose_variant(self, name: str) -> None:
        index = self.variant.findData(name)
        if index < 0:
            self.variant.addItem(VARIANTS.get(name, (name, ""))[0], name)
            index = self.variant.count() - 1
        self.variant.setCurrentIndex(index)
        self.variant.setToolTip(
            tr("Model that generates the designs. {about}", about=VARIANTS.get(name, ("", ""))[1]).strip()
        )


def _choice(name: str, accessible: str) -> QComboBox:
    box = QComboBox()
    box.setObjectName(name)
    box.setFocusPolicy(Qt.FocusPolicy.TabFocus)
    box.setSizePolicy(QSizePolicy.Policy.Ignored, QSizePolicy.Policy.Fixed)
    box.setAccessibleName(accessible)
    return box


def _whole(name: str, accessible: str, low: int, high: int, tip: str) -> QSpinBox:
    box = QSpinBox()
    box.setObjectName(name)
    box.setRange(low, high)
    box.setToolTip(tip)
    box.setAccessibleName(accessible)
    return box


def _side_by_side(*widgets: QWidget) -> QHBoxLayout:
    row = QHBoxLayout()
    row.setSpacing(4)
    for widget in widgets:
        row.addWidget(widget, 1 if isinstance(widget, QSpinBox) else 0)
    return row
