"""Help > About: name, version and licence of the program, and the licences of everything that comes with it."""

from __future__ import annotations

from PySide6.QtCore import QEvent, Qt
from PySide6.QtGui import QFontDatabase
from PySide6.QtWidgets import QLabel, QPlainTextEdit, QSplitter, QTreeWidgetItem, QWidget

from kirigami_studio import __version__
from kirigami_studio.foundation.licences import Component, components
from kirigami_studio.foundation.words import mark, tr, tr_n
from kirigami_studio.gui.widgets.card import own_markup
from kirigami_studio.gui.widgets.icons import coloured
from kirigami_studio.gui.widgets.layouts import column, label, row
from kirigami_studio.gui.widgets.search_window import SearchedList, SearchWindow

#: Edge of the program's icon, pixels.
ICON = 56
#: Width of the licences' names, pixels; characters in a line of their texts.
LICENCE, COLUMNS = 176, 84
#: The paper that the program implements.
PAPER = "https://arxiv.org/abs/2605.08098"
PURPOSE = mark("Designs kirigami sheets that open into a silhouette.")
QT = mark(
    "Qt and PySide6 are used under the LGPL 3, as libraries of their own that you may replace; their licence says how."
)


class AboutWindow(SearchWindow):
    """Shows what the program is, and the licences by name; typing looks in names, licences and their texts."""

    def __init__(self, parent: QWidget) -> None:
        super().__init__(
            parent,
            title=tr("About Kirigami Studio"),
            prompt=tr("Search the licences"),
            tip=tr("Show only what has these words in its name, its licence or the text of it"),
        )
        self.components: tuple[Component, ...] = components()
        self.list = SearchedList([tr("Part"), tr("Version"), tr("Licence")], name=tr("What comes with the program"))
        self.list.setObjectName("licenceList")
        self.list.setColumnWidth(2, LICENCE)
        self.shown, self.paper = QLabel(), QLabel()
        for linked in (self.shown, self.paper):
            own_markup(linked)
            linked.setOpenExternalLinks(True)
        self.text = QPlainTextEdit()
        self.text.setAccessibleName(tr("Text of the licence"))
        self.text.setReadOnly(True)
        self.text.setFont(QFontDatabase.systemFont(QFontDatabase.SystemFont.FixedFont))
        self.text.setMinimumWidth(COLUMNS * self.text.fontMetrics().horizontalAdvance("m"))
        self._lay_out()
        self.search.textChanged.connect(self._filter)
        self.list.currentItemChanged.connect(self._show)
        self._fill()
        self.resize(1120, 680)

    def _lay_out(self) -> None:
        picture, name = QLabel(), QLabel("Kirigami Studio")
        picture.setAccessibleName(tr("Sign of the program"))
        picture.setPixmap(coloured("kirigami-studio", ICON, self.devicePixelRatioF()))
        font = name.font()
        font.setPointSizeF(1.6 * font.pointSizeF())
        font.setBold(True)
        name.setFont(font)
        self.paper.setText(
            tr('After <a href="{link}">Yazdani, Shalileh and Shahriari, arXiv:2605.08098</a>', link=PAPER)
        )
        version = label(tr("Version {version}  ·  MIT licence", version=__version__))
        self.paper.setObjectName("muted")
        words = column(name, version, QLabel(tr(PURPOSE)), self.paper, spacing=2)
        columns = QSplitter(Qt.Orientation.Horizontal)
        columns.setChildrenCollapsible(False)
        for parts in ((self.search, (self.list, 1), self.found), (self.shown, (self.text, 1))):
            side = QWidget()
            column(*parts, on=side, spacing=6)
            columns.addWidget(side)
        columns.setSizes([480, 620])
        columns.setStretchFactor(1, 1)
        head = row(column(picture, ...), (words, 1), spacing=16)
        column(head, (columns, 1), label(tr(QT), wraps=True), on=self, spacing=12, margins=(16, 16, 16, 12))

    def _fill(self) -> None:
        for component in self.components:
            name = "Kirigami Studio" if component is self.components[0] else component.name
            tip = f"{name} {component.version}\n{component.licence}"
            words = f"{name}\n{component.licence}\n{component.text}"
            self.list.add([name, component.version, component.licence], words, tips=[tip] * 3)
        self._filter("")

    def showing(self) -> list[str]:
        """Names of the visible lines."""
        return [line.text(0) for line in self.list.shown_lines]

    def _filter(self, text: str) -> None:
        self.found.setText(tr_n("{count} part", "{count} parts", self.list.narrow(text)))
        showing = self.list.shown_lines
        if showing and self.list.currentItem() not in showing:
            self.list.setCurrentItem(showing[0])

    def _show(self, line: QTreeWidgetItem | None) -> None:
        if line is None:
            return
        component = self.components[self.list.indexOfTopLevelItem(line)]
        link = f'  ·  <a href="{component.homepage}">{component.homepage}</a>' if component.homepage else ""
        self.shown.setText(f"<b>{line.text(0)} {component.version}</b>{link}")
        self.text.setPlainText(component.text)

    def changeEvent(self, event: QEvent) -> None:  # noqa: N802 - Qt's name
        """Links take the colours of another theme only when they are laid out again."""
        if event.type() == QEvent.Type.PaletteChange:
            for linked in (self.shown, self.paper):
                text = linked.text()
                linked.clear()
                linked.setText(text)
        super().changeEvent(event)
