"""The picker of a drawing's parts: which of them, and how they become one outline."""

from __future__ import annotations

from dataclasses import replace
from functools import partial

from PySide6.QtCore import QItemSelectionModel, QSignalBlocker, QSize, Qt, QTimer, Signal
from PySide6.QtGui import QIcon
from PySide6.QtWidgets import (
    QAbstractItemView,
    QCheckBox,
    QDialog,
    QLabel,
    QPushButton,
    QSizePolicy,
    QTreeWidget,
    QTreeWidgetItem,
    QWidget,
)

from kirigami_studio.foundation import words
from kirigami_studio.foundation.words import mark, tr, tr_n
from kirigami_studio.gui.session.queue import JobCallbacks, JobQueue, LatestJob
from kirigami_studio.gui.target.part_view import PartView, part_pixmap
from kirigami_studio.gui.widgets.choice_box import ChoiceBox
from kirigami_studio.gui.widgets.layouts import column, label, row
from kirigami_studio.gui.widgets.number_field import DecimalField, decimal_field
from kirigami_studio.gui.widgets.theme import LIGHT, Palette
from kirigami_studio.outlines.merging import USUAL_BRIDGE, USUAL_STROKE, Join, Merged, Merging
from kirigami_studio.outlines.outline import Outline
from kirigami_studio.outlines.parts import DrawnPartKind, Part, SourceParts, Strokes
from kirigami_studio.studio.parts import PartsRead, Purpose, merging_parts, picking_object, places_in
from kirigami_studio.studio.targets import pieces_of

SIZE, LIST_WIDTH, PICTURE = QSize(980, 620), 310, QSize(40, 40)
NUMBER = Qt.ItemDataRole.UserRole
#: Pictures that are drawn in one turn of the window.
AT_ONCE = 12
#: Sentences on what was left out that are shown; the others are in the tooltip.
SHOWN_NOTES = 3
JOINS = (
    (
        Join.BRIDGE,
        mark("Bridges"),
        mark("Pieces that do not touch are joined by bridges between their nearest places."),
    ),
    (Join.UNION, mark("No bridges"), mark("What touches becomes one shape; of several pieces the largest is taken.")),
    (Join.HULL, mark("Hull"), mark("The outline of a rubber band around all chosen parts.")),
    (Join.TIGHT, mark("Tight hull"), mark("An outline around all chosen parts that follows them into hollows.")),
)
#: The way to take several parts that targets alone have.
SEPARATE = (
    Join.EACH,
    mark("Separate sheets"),
    mark("Every piece becomes a sheet of its own; all open to one scale and lie in one cut file."),
)
#: The button that takes the parts, and what is said of their outline.
TAKE = {
    Purpose.TARGET: (mark("&Use as target"), mark("The target will be {size}.")),
    Purpose.START: (mark("&Use as start"), mark("The outline is {size}; only its shape counts.")),
    Purpose.SECOND: (mark("&Use as second target"), mark("The outline is {size}; only its shape counts.")),
}
ON_PHOTO = mark(
    "Click on the object, or draw over it, to take it; what does not belong to it is left out by a right click."
)
HULLS = (Join.HULL, Join.TIGHT)
KINDS = {
    DrawnPartKind.FILLED: mark("filled"),
    DrawnPartKind.CLOSED: mark("closed line"),
    DrawnPartKind.STROKED: mark("line"),
}


def about_parts(purpose: Purpose, count: int) -> str:
    """How many parts there are, and what they are chosen for."""
    if purpose is Purpose.START:
        return tr_n(
            "The drawing has {count} part. Check what the sheet is to start as, in the list or by a click in the "
            "picture.",
            "The drawing has {count} parts. Check what the sheet is to start as, in the list or by a click in the "
            "picture.",
            count,
        )
    if purpose is Purpose.SECOND:
        return tr_n(
            "The drawing has {count} part. Check what belongs to the second target, in the list or by a click in the "
            "picture.",
            "The drawing has {count} parts. Check what belongs to the second target, in the list or by a click in the "
            "picture.",
            count,
        )
    return tr_n(
        "The drawing has {count} part. Check what belongs to the target, in the list or by a click in the picture.",
        "The drawing has {count} parts. Check what belongs to the target, in the list or by a click in the picture.",
        count,
    )


class PartPicker(QDialog):
    """Lists parts by layer with check marks; the outline that they become is made in the worker and drawn at once.

    Nothing is changed before :attr:`taken`.
    """

    taken = Signal(Outline, bool)  #: whether it is what is taken without asking
    pieces_taken = Signal(object)  #: several of :class:`PieceRead`, each a sheet of its own

    def __init__(self, parent: QWidget, queue: JobQueue) -> None:
        super().__init__(parent)
        self.setObjectName("partPicker")
        self.setModal(True)
        self.resize(SIZE)
        self.result_: Merged | None = None
        self._read: PartsRead | None = None
        self._purpose = Purpose.TARGET
        self._strokes = Strokes()
        self._palette: Palette = LIGHT
        self._job = LatestJob[Merged](queue)
        self._items: dict[int, QTreeWidgetItem] = {}
        self._undrawn: list[int] = []
        self._drawing = QTimer(self, singleShot=True, interval=0)
        self._pick = LatestJob[PartsRead](queue)
        self._accepts = False  # Enter was pressed before the outline was there
        self.about = label(name="", wraps=True)
        self.list = QTreeWidget()
        self.list.setObjectName("partList")
        self.list.setAccessibleName(tr("Parts of the drawing"))
        self.list.setHeaderHidden(True)
        self.list.setIconSize(PICTURE)
        self.list.setUniformRowHeights(False)
        self.list.setVerticalScrollMode(QAbstractItemView.ScrollMode.ScrollPerPixel)
        self.list.setMinimumWidth(LIST_WIDTH)
        self.list.setSizePolicy(QSizePolicy.Policy.Fixed, QSizePolicy.Policy.Expanding)
        self.all = self._button("allParts", tr("&All"), tr("Choose every part."))
        self.largest = self._button("largestPart", tr("&Largest"), tr("Choose the largest part alone."))
        self.view = PartView()
        self.restart = self._button("", tr("Clear &clicks"), tr("Forget the clicks on the picture."))
        self.join = ChoiceBox("joinParts", tr("How parts are joined"), JOINS)
        self.join.setMinimumWidth(150)
        self.join.setSizePolicy(QSizePolicy.Policy.Fixed, QSizePolicy.Policy.Fixed)
        self.bridge = self._width_field("bridgeWidth", tr("Width of bridges"))
        self.painted = QCheckBox(tr("&Strokes as painted"))
        self.painted.setToolTip(tr("Lines count with their width; otherwise only what they enclose counts."))
        self.stroke = self._width_field("strokeWidth", tr("Width of lines that have none"))
        self.fill = QCheckBox(tr("Fill &holes"))
        self.fill.setToolTip(tr("A sheet shows the shape without its holes; they can be opened again."))
        self._fill_holes: bool | None = None
        self.size_ = QLabel()
        self.notes = label(wraps=True)
        self.notes.setSizePolicy(QSizePolicy.Policy.Ignored, QSizePolicy.Policy.Minimum)
        self.take = self._button("primary", tr(TAKE[Purpose.TARGET][0]), "")
        self.take.setAutoDefault(True)
        self.take.setDefault(True)
        self.cancel = self._button("", tr("Cancel"), tr("Leave everything as it is (Esc)."))
        self._lay_out()
        self._connect()

    @staticmethod
    def _button(name: str, text: str, tip: str) -> QPushButton:
        button = QPushButton(text)
        button.setObjectName(name)
        button.setToolTip(tip)
        button.setAutoDefault(False)
        return button

    @staticmethod
    def _width_field(name: str, accessible: str) -> DecimalField:
        field = decimal_field(DecimalField, name, 0.0, 1.0, accessible=accessible, tip=f"{accessible}.")
        field.setMinimumWidth(96)
        return field

    def _lay_out(self) -> None:
        left = column((self.list, 1), row(self.all, self.largest, ...))
        join = label(tr("&Join by"), self.join, name="")
        marks = (self.painted, self.stroke, self.fill)
        controls = row(join, self.join, self.bridge, 12, *marks, ..., self.restart, spacing=8)
        right = column((self.view, 1), controls, self.size_, self.notes)
        middle = row(left, (right, 1), spacing=12)
        below = row(..., self.cancel, self.take)
        column(self.about, (middle, 1), below, on=self, spacing=10, margins=(14, 14, 14, 14))

    def _connect(self) -> None:
        self._drawing.timeout.connect(self._draw_next)
        self.list.itemChanged.connect(self._remake)
        self.list.currentItemChanged.connect(lambda item, _: self.view.mark(self._number(item)))
        self.view.clicked.connect(self._toggle)
        self.view.pointed.connect(self._point)
        self.view.stroked.connect(self._take_object)
        self.restart.clicked.connect(lambda: self._pick_object(Strokes()))
        self.all.clicked.connect(lambda: self._choose(frozenset(self._items)))
        self.largest.clicked.connect(self._choose_largest)
        self.join.currentIndexChanged.connect(self._remake)
        self.painted.toggled.connect(self._remake)
        self.fill.clicked.connect(self._choose_fill)
        for field in (self.bridge, self.stroke):
            field.valueChanged.connect(self._remake)
        self.take.clicked.connect(self._on_accept)
        self.cancel.clicked.connect(self.reject)
        self.finished.connect(lambda _: self._stop())

    def begin(self, read: PartsRead, purpose: Purpose = Purpose.TARGET) -> None:
        """Show a drawing and its usual silhouette, lines as painted where nothing is closed."""
        self._stop()
        self._read, self._purpose, source = read, purpose, read.source
        closed = any(part.is_closed for part in source.parts)
        self.setWindowTitle(tr("Parts of {name}", name=source.name))
        about = about_parts(purpose, len(source.parts))
        self.about.setText(about if read.photo is None else f"{about} {tr(ON_PHOTO)}")
        self.restart.setVisible(False)
        self.take.setText(tr(TAKE[purpose][0]))
        for field, share in ((self.bridge, USUAL_BRIDGE), (self.stroke, USUAL_STROKE)):
            self._set_range(field, share)
        with QSignalBlocker(self.join), QSignalBlocker(self.painted):
            offered = self.join.row_of(Join.EACH)
            if purpose is Purpose.TARGET and offered < 0:
                self.join.add_choices((SEPARATE,))
            elif purpose is not Purpose.TARGET and offered >= 0:
                self.join.removeItem(offered)
            strokes = read.strokes
            self.join.choose(Join.BRIDGE if strokes is None else strokes.join)
            self.painted.setChecked(_as_painted(source) if strokes is None else strokes.as_painted)
        self._fill_holes = None
        self.painted.setVisible(any(part.lines for part in source.parts))
        usual = closed and strokes is None
        every = frozenset(part.number for part in source.parts if not (closed and part.is_letter))
        self._fill(frozenset(source.usual) if usual else every)
        self.view.show_drawing(read)
        self._remake()
        self.list.setFocus()

    def _set_range(self, field: DecimalField, share: float) -> None:
        assert self._read is not None
        size, unit = self._read.source.size, self._read.source.unit
        digits = 2 if size >= 10.0 else 4
        with QSignalBlocker(field):
            field.setDecimals(digits)
            field.setRange(10.0**-digits, max(0.5 * size, 10.0**-digits))
            field.setSuffix(f" {unit}" if unit else "")
            field.setSingleStep(max(round(0.01 * size, digits), 10.0**-digits))
            field.setValue(share * size)

    def _fill(self, chosen: frozenset[int]) -> None:
        """List all parts below their layers."""
        assert self._read is not None
        source = self._read.source
        self.list.blockSignals(True)
        self.list.clear()
        self._items = {}
        grouped = len(source.layers) > 1 or source.layers[0] != ""
        self.list.setRootIsDecorated(grouped)
        parents = {name: self._layer_item(name) for name in source.layers} if grouped else {}
        for part in source.parts:
            item = QTreeWidgetItem([self._row(part)])
            item.setData(0, NUMBER, part.number)
            item.setToolTip(0, self._row(part))
            item.setFlags(item.flags() | Qt.ItemFlag.ItemIsUserCheckable)
            item.setCheckState(0, _state(part.number in chosen))
            if grouped:
                parents[part.layer].addChild(item)
            else:
                self.list.addTopLevelItem(item)
            self._items[part.number] = item
        self.list.expandAll()
        self.list.blockSignals(False)
        first = self._items[min(chosen)]
        self.list.setCurrentItem(first, 0, QItemSelectionModel.SelectionFlag.ClearAndSelect)
        self.list.scrollToItem(first)
        self._draw_all()

    def _layer_item(self, name: str) -> QTreeWidgetItem:
        item = QTreeWidgetItem([name or tr("no layer")])
        item.setFlags(item.flags() | Qt.ItemFlag.ItemIsUserCheckable | Qt.ItemFlag.ItemIsAutoTristate)
        font = item.font(0)
        font.setBold(True)
        item.setFont(0, font)
        self.list.addTopLevelItem(item)
        return item

    def _row(self, part: Part) -> str:
        """Two lines: name, and size with kind."""
        assert self._read is not None
        return f"{part.name}\n{_size(part.size, self._read.source.unit)}  \N{MIDDLE DOT}  {tr(KINDS[part.kind])}"

    # choosing --------------------------------------------------------------------------------------------------------

    @property
    def chosen(self) -> frozenset[int]:
        """Numbers of the parts that are checked."""
        checked = Qt.CheckState.Checked
        return frozenset(number for number, item in self._items.items() if item.checkState(0) == checked)

    @property
    def merging(self) -> Merging:
        """How they are joined."""
        join = Join(self.join.currentData())
        widths = {"bridge": self.bridge.value(), "stroke": self.stroke.value()}
        return Merging(join, as_painted=self._as_painted, fill_holes=self._fill_holes, **widths)

    @property
    def _as_painted(self) -> bool:
        return self.painted.isChecked() and not self.painted.isHidden()

    @staticmethod
    def _number(item: QTreeWidgetItem | None) -> int:
        return 0 if item is None else int(item.data(0, NUMBER) or 0)

    def _choose(self, numbers: frozenset[int]) -> None:
        with QSignalBlocker(self.list):
            for number, item in self._items.items():
                item.setCheckState(0, _state(number in numbers))
        self._remake()

    def _choose_largest(self) -> None:
        if self._read is not None:
            with QSignalBlocker(self.painted):
                self.painted.setChecked(_as_painted(self._read.source))
            self._choose(frozenset(self._read.source.usual))

    def _toggle(self, number: int) -> None:
        """A part was clicked in the picture."""
        item = self._items[number]
        self.list.setCurrentItem(item)
        item.setCheckState(0, _state(item.checkState(0) != Qt.CheckState.Checked))

    def _take_object(self, places: tuple[tuple[float, float], ...], takes: bool) -> None:
        """The picture was clicked on, or stroked, where the object is or beside it."""
        if self._read is None or self._read.photo is None:
            return
        strokes = self._strokes
        if takes:
            strokes = replace(strokes, taken=(*strokes.taken, *places))
        else:  # without a click on the object, it is what was chosen
            taken = strokes.taken or places_in(self._read, self.chosen)
            strokes = Strokes(taken, (*strokes.left, *places))
        self._pick_object(strokes)

    def _pick_object(self, strokes: Strokes) -> None:
        assert self._read is not None
        self._strokes = strokes
        callbacks = JobCallbacks(self._on_object, on_failed=self._on_no_object)
        self._pick.start(tr("taking the object"), partial(picking_object, self._read, strokes), callbacks)

    def _on_object(self, found: PartsRead) -> None:
        """Show the object as a part and choose it alone, or the usual one without it."""
        self._read = found
        is_there = found.photo is not None and bool(found.photo.strokes.taken)
        self.restart.setVisible(is_there)
        self._fill(frozenset({found.source.parts[-1].number} if is_there else found.source.usual))
        self.view.show_drawing(found)
        self._remake()

    def _on_no_object(self, sentence: str, trace: str) -> None:
        """There is nothing at the last place: the clicks before it count."""
        if self._read is not None and self._read.photo is not None:
            self._strokes = self._read.photo.strokes
        self._say((sentence,), wrong=True)

    def _point(self, number: int) -> None:
        """The pointer is over a part in the picture, or over none."""
        self.view.mark(number or self._number(self.list.currentItem()))
        self.view.setToolTip(self._items[number].text(0) if number else "")

    @property
    def complete(self) -> bool:
        """Whether the outline is made and all pictures are drawn."""
        return not self._job.busy and not self._pick.busy and not self._undrawn

    def _choose_fill(self, on: bool) -> None:
        self._fill_holes = on
        self._remake()

    # the outline -----------------------------------------------------------------------------------------------------

    def _remake(self) -> None:
        """Make the outline of what is chosen now."""
        if self._read is None:
            return
        source, chosen, merging = self._read.source, self.chosen, self.merging
        parts = [part for part in source.parts if part.number in chosen]
        self.bridge.setVisible(merging.join is Join.BRIDGE)
        self.stroke.setVisible(merging.as_painted and any(part.lines and not part.pen.width for part in source.parts))
        self.view.show_choice(chosen, merging.stroke or 0.0 if merging.as_painted else 0.0)
        self.take.setEnabled(False)
        self._accepts = False
        if not parts:
            self._job.stop()
            self._say_nothing(tr("Check at least one part."))
            return
        callbacks = JobCallbacks(self._show, on_failed=lambda sentence, _: self._say_nothing(sentence))
        self._job.start(tr("joining parts"), partial(merging_parts, source, chosen, merging), callbacks)
        self.take.setEnabled(True)

    def _say_nothing(self, sentence: str) -> None:
        """There is no outline, and why."""
        self.result_ = None
        self.view.show_result(None)
        self.fill.hide()
        self.take.setEnabled(False)
        self.size_.setText(tr("No outline"))
        self._say((sentence,), wrong=True)

    def _show(self, found: Merged) -> None:
        assert self._read is not None
        self.result_ = found
        self.view.show_result(found)
        outlines = [one.outline for one in found.all]
        self.fill.setVisible(any(outline.holes or outline.filled_holes for outline in outlines))
        self.fill.setChecked(not any(outline.holes for outline in outlines))
        unit = self._read.source.unit
        if found.others:
            names = ", ".join(one.outline.name for one in found.all)
            self.size_.setText(
                tr_n("The target will be {count} sheet: {names}.", "The target will be {count} sheets: {names}.",
                     len(found.all), names=names)
            )  # fmt: skip
        elif found.outline.size is not None:
            self.size_.setText(tr(TAKE[self._purpose][1], size=_size(found.outline.size, unit)))
        self._say(found.outline.notes, wrong=False)
        if self._accepts:
            self._on_accept()

    def _say(self, notes: tuple[str, ...], wrong: bool) -> None:
        more = len(notes) - SHOWN_NOTES
        text = " ".join(notes[:SHOWN_NOTES])
        self.notes.setText(text + (" …" if more > 0 else ""))
        self.notes.setToolTip("\n".join(notes))
        self.notes.setObjectName("warning" if wrong else "muted")
        self.notes.style().polish(self.notes)

    def _on_accept(self) -> None:
        if self._job.busy:
            self._accepts = True  # as soon as the outline is there
        elif self.result_ is not None:
            source = self._read.source if self._read is not None else None
            usual = source is not None and self.chosen == frozenset(source.usual) and not self._strokes.taken
            usual = (
                usual
                and self._fill_holes is None
                and self._as_painted == (source is not None and source.choice.as_painted)
            )
            self.accept()
            if self.result_.others:
                self.pieces_taken.emit(pieces_of(self.result_))
                return
            self.taken.emit(self.result_.outline, usual and self.merging.join not in HULLS)

    def _stop(self) -> None:
        self._job.stop()
        self._pick.stop()
        self._strokes = Strokes()
        self._drawing.stop()
        self._accepts = False

    # pictures --------------------------------------------------------------------------------------------------------

    def set_palette(self, palette: Palette) -> None:
        if palette is not self._palette:
            self._palette = palette
            self._draw_all()

    def _draw_all(self) -> None:
        self._undrawn = sorted(self._items, reverse=True)
        self._drawing.start()

    def _draw_next(self) -> None:
        if self._read is None:
            return
        ratio = self.devicePixelRatioF()
        self.list.blockSignals(True)
        for _ in range(min(AT_ONCE, len(self._undrawn))):
            number = self._undrawn.pop()
            part, sketch = self._read.source.parts[number - 1], self._read.sketches[number - 1]
            picture = part_pixmap(sketch, part.is_closed, PICTURE, ratio, self._palette)
            self._items[number].setIcon(0, QIcon(picture))
        self.list.blockSignals(False)
        if self._undrawn:
            self._drawing.start()


def _as_painted(source: SourceParts) -> bool:
    """Whether lines count as they are painted, unless somebody wants it otherwise."""
    return source.choice.as_painted or not any(part.is_closed for part in source.parts)


def _state(checked: bool) -> Qt.CheckState:
    return Qt.CheckState.Checked if checked else Qt.CheckState.Unchecked


def _size(size: tuple[float, float], unit: str) -> str:
    width, height = (words.number(side, ".1f" if side >= 1.0 else ".3g") for side in size)
    return f"{width} \N{MULTIPLICATION SIGN} {height} {unit}".rstrip()
