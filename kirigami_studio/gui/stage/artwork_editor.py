"""Design > Artwork: the picture that is printed on the sheet, and how it lies."""

from __future__ import annotations

import math
from functools import partial
from pathlib import Path

from PySide6.QtCore import QPoint, QSignalBlocker, Qt, Signal
from PySide6.QtGui import QKeyEvent
from PySide6.QtWidgets import QComboBox, QFormLayout, QPushButton, QWidget

from kirigami_studio.export.artwork import (
    FEWEST_STRIPES,
    LARGEST_SCALE,
    MOST_STRIPES,
    SMALLEST_SCALE,
    ArtPicture,
    Artwork,
    PictureFit,
    SheetState,
)
from kirigami_studio.foundation.words import mark, tr
from kirigami_studio.gui.widgets.card import muted_label
from kirigami_studio.gui.widgets.layouts import column, label, row
from kirigami_studio.gui.widgets.number_field import DecimalField, decimal_field

#: Pixels.
WIDTH = 330
#: Farthest a picture is shifted, in sides of the box.
FARTHEST = 5.0
STATES = (
    (SheetState.TARGET, mark("Opened sheet"), mark("Seen whole when the sheet is open, cut up while it is flat")),
    (SheetState.FLAT, mark("Flat sheet"), mark("Seen whole while the sheet is flat, cut up when it is open")),
)
FITTINGS = (
    (PictureFit.FILL, mark("Fill"), mark("Cover all of the sheet")),
    (PictureFit.FIT, mark("Fit"), mark("Show all of the picture")),
)
NO_PICTURE = mark("No picture yet. Choose a photo, a PNG or an SVG: it is printed in register with the cuts.")


class ArtworkEditor(QWidget):
    """A small window beside the stage, which shows every change at once."""

    stripes_wanted = Signal(int)
    changed = Signal(dict)  #: fields of Laid with their new values
    edited = Signal()  #: the next change is an undo step of its own

    def __init__(self, parent: QWidget) -> None:
        super().__init__(parent, Qt.WindowType.Tool)
        self.setWindowTitle(tr("Artwork"))
        self.setObjectName("artworkEditor")
        self.about = label(tr(NO_PICTURE), name="", wraps=True)
        self.choose = QPushButton(tr("&Choose picture …"))
        self.choose.setToolTip(tr("Lay a picture on the sheet: PNG, JPG, BMP, TIFF, WebP or SVG"))
        self.remove = QPushButton(tr("&Remove"))
        self.remove.setToolTip(tr("Print nothing on the sheet"))
        self.second = QPushButton(tr("&Second picture …"))
        self.second.setToolTip(tr("Seen in the other state, in stripes between those of the first picture"))
        self.remove_second = QPushButton(tr("Re&move"))
        self.remove_second.setToolTip(tr("Print the first picture alone"))
        self.about_second = muted_label()
        self.export = QPushButton(tr("&Export artwork …"))
        self.export.setObjectName("primary")
        self.export.setToolTip(
            tr(
                "SVG and PDF in true mm and PNG at 300 dpi, in register with the cut file. The PDF has the pages that "
                "are chosen for cuts."
            )
        )
        self.state = self._choices(STATES)
        self.fitting = self._choices(FITTINGS)
        number = partial(decimal_field, DecimalField, "")
        self.scale = number(100.0 * SMALLEST_SCALE, 100.0 * LARGEST_SCALE, step=5.0, suffix=tr(" %"))
        self.turn = number(-360.0, 360.0, step=5.0, suffix="°")
        self.right, self.up = (number(-100.0 * FARTHEST, 100.0 * FARTHEST, suffix=tr(" %")) for _ in range(2))
        self.stripes = number(FEWEST_STRIPES, MOST_STRIPES, decimals=0, step=10.0)
        self._numbers = (self.scale, self.turn, self.right, self.up, self.stripes)
        for field in self._numbers:
            field.setKeyboardTracking(True)  # each digit is seen on the sheet
        self._fields = (self.state, self.fitting, self.scale, self.turn, self.right, self.up)
        self._lay_out()
        self._connect()
        self.show_artwork(None, exportable=False)
        # Over the stage's upper right corner: beside the candidates, off the target and the menus.
        self.move(parent.mapToGlobal(QPoint(round(0.74 * parent.width()) - WIDTH, 120)))

    @staticmethod
    def _choices(table: tuple[tuple[SheetState | PictureFit, str, str], ...]) -> QComboBox:
        box = QComboBox()
        for place, (value, text, tip) in enumerate(table):
            box.addItem(tr(text), value)
            box.setItemData(place, tr(tip), Qt.ItemDataRole.ToolTipRole)
        return box

    def _lay_out(self) -> None:
        form, stripes = QFormLayout(), QFormLayout()
        for place, caption, tip, field in (
            (form, tr("&Whole on"), tr("The state in which the picture is seen as it is"), self.state),
            (form, tr("&Size"), tr("How the picture lies in the box around that state"), self.fitting),
            (form, tr("Sca&le"), tr("Times that size"), self.scale),
            (form, tr("&Turn"), tr("Counter-clockwise, about the picture's middle"), self.turn),
            (form, tr("To the r&ight"), tr("In widths of the box"), self.right),
            (form, tr("&Up"), tr("In heights of the box"), self.up),
            (stripes, tr("Stri&pes"), tr("Stripes of both pictures across the flat sheet"), self.stripes),
        ):
            field.setToolTip(tip)
            place.addRow(label(caption, field, name=""), field)
        above, sharing = row((self.choose, 1), self.remove), row((self.second, 1), self.remove_second)
        parts = (self.about, above, form, sharing, self.about_second, stripes, row(..., self.export))
        column(*parts, on=self, spacing=10, margins=(14, 14, 14, 14))
        self.setFixedWidth(WIDTH)

    def _connect(self) -> None:
        self.stripes.valueChanged.connect(lambda value: self.stripes_wanted.emit(round(value)))
        for name, box in (("state", self.state), ("fitting", self.fitting)):
            box.activated.connect(partial(self._choose, name, box))
        self.scale.valueChanged.connect(lambda value: self.changed.emit({"scale": value / 100.0}))
        self.turn.valueChanged.connect(lambda value: self.changed.emit({"turn": math.radians(value)}))
        for field in (self.right, self.up):
            field.valueChanged.connect(self._shift)
        for field in self._numbers:
            field.editingFinished.connect(self.edited)

    def keyPressEvent(self, event: QKeyEvent) -> None:  # noqa: N802 - Qt's name
        """Esc closes the window."""
        if event.key() == Qt.Key.Key_Escape:
            self.close()
        else:
            super().keyPressEvent(event)

    def _shift(self) -> None:
        self.changed.emit({"shift": (self.right.value() / 100.0, self.up.value() / 100.0)})

    def _choose(self, name: str, box: QComboBox, _: int) -> None:
        self.changed.emit({name: box.currentData()})
        self.edited.emit()

    def show_artwork(self, artwork: Artwork | None, exportable: bool) -> None:
        """Show what is printed now, and whether there is a design to print it on."""
        for part in (*self._fields, self.remove):
            part.setEnabled(artwork is not None)
        self.export.setEnabled(artwork is not None and exportable)
        self.second.setEnabled(artwork is not None)
        second = None if artwork is None else artwork.second
        for part in (self.remove_second, self.stripes):
            part.setEnabled(second is not None)
        self.about_second.setText("" if second is None else _described(second))
        if artwork is None:
            self.about.setText(tr(NO_PICTURE))
            return
        laid = artwork.first
        self.about.setText(_described(laid.picture))
        blockers = [QSignalBlocker(field) for field in (*self._fields, self.stripes)]
        self.state.setCurrentIndex(self.state.findData(laid.state))
        self.fitting.setCurrentIndex(self.fitting.findData(laid.fitting))
        for field, value in (
            (self.scale, 100.0 * laid.scale),
            (self.turn, math.degrees(laid.turn)),
            (self.right, 100.0 * laid.shift[0]),
            (self.up, 100.0 * laid.shift[1]),
            (self.stripes, float(artwork.stripes)),
        ):
            if abs(field.value() - value) > 0.05:
                field.setValue(value)
        for blocker in blockers:
            blocker.unblock()


def _described(picture: ArtPicture) -> str:
    """The picture's name, not too long for a line, and its size."""
    name, (width, height) = Path(picture.name), picture.size
    short = name.name if len(name.name) <= 32 else f"{name.stem[:24]}…{name.suffix}"
    return tr("{name}, {width} x {height} pixels", name=short, width=width, height=height)
