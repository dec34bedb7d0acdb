"""The library of silhouettes as a popup of thumbnails."""

from __future__ import annotations

from PySide6.QtCore import QPoint, QSize, Qt, QTimer, Signal
from PySide6.QtGui import QGuiApplication, QIcon, QKeyEvent
from PySide6.QtWidgets import QFrame, QListWidgetItem, QWidget

from kirigami_studio.foundation.words import tr
from kirigami_studio.gui.stage.layout_items import target_pixmap
from kirigami_studio.gui.widgets.layouts import column, label
from kirigami_studio.gui.widgets.search_window import PictureList, search_field
from kirigami_studio.gui.widgets.theme import Palette
from kirigami_studio.outlines import silhouettes

PICTURE = QSize(64, 64)
NAME_ROLE = Qt.ItemDataRole.UserRole


class SilhouettePicker(QFrame):
    """Closes by itself once a silhouette is chosen or the user clicks elsewhere."""

    chosen = Signal(str)

    def __init__(self, parent: QWidget, palette: Palette) -> None:
        super().__init__(parent, Qt.WindowType.Popup)
        self.setObjectName("popup")
        self._listens = False
        self.search = search_field(tr("Search the library"))
        self.list = PictureList("libraryList", tr("Library silhouettes"), PICTURE, QSize(104, 104))
        self.about = label(tr("Choose a silhouette"), wraps=True)
        column(self.search, (self.list, 1), self.about, on=self, margins=(12, 12, 12, 10))
        self._fill(palette)
        self.list.itemClicked.connect(self._on_activated)
        self.list.itemActivated.connect(self._on_activated)
        self.list.currentItemChanged.connect(self._describe)
        self.search.textChanged.connect(self._filter)
        self.search.textChanged.connect(self._listen)
        self.resize(560, 470)

    def _fill(self, palette: Palette) -> None:
        ratio = self.devicePixelRatioF()
        for name in silhouettes.names():
            entry = silhouettes.entry(name)
            picture = target_pixmap(silhouettes.load(name), PICTURE, ratio, palette)
            item = QListWidgetItem(QIcon(picture), tr(entry.title))
            item.setData(NAME_ROLE, name)
            item.setToolTip(tr(entry.about))
            item.setData(Qt.ItemDataRole.AccessibleDescriptionRole, tr(entry.about))
            self.list.addItem(item)

    def show_below(self, button: QWidget) -> None:
        """Open below a button, inside the screen."""
        place = button.mapToGlobal(QPoint(0, button.height() + 4))
        screen = QGuiApplication.screenAt(place) or QGuiApplication.primaryScreen()
        area = screen.availableGeometry()
        x = min(place.x(), area.right() - self.width())
        y = min(place.y(), area.bottom() - self.height())
        self.move(max(x, area.left()), max(y, area.top()))
        self.show()
        self.search.setFocus()
        QTimer.singleShot(0, self, self._listen)

    def _listen(self) -> None:
        """Take keys from now on: until then the key that chose "Library" in a list is still on its way."""
        self._listens = True

    def keyPressEvent(self, event: QKeyEvent) -> None:  # noqa: N802 - Qt's name
        if not self._listens:
            event.accept()
        elif event.key() in (Qt.Key.Key_Down, Qt.Key.Key_Up) and self.search.hasFocus():
            self.list.setFocus()
            self.list.setCurrentRow(next((row for row in range(self.list.count()) if self._shown(row)), 0))
        elif event.key() in (Qt.Key.Key_Return, Qt.Key.Key_Enter):
            best = self._best()
            if best is not None:
                self._on_activated(best)
        else:
            super().keyPressEvent(event)

    def _best(self) -> QListWidgetItem | None:
        """The selected silhouette, or else the one whose name or title matches the search best."""
        shown = [self.list.item(row) for row in range(self.list.count()) if self._shown(row)]
        if self.list.currentItem() in shown:
            return self.list.currentItem()
        wanted = self.search.text().strip().lower()
        return min(shown, key=lambda item: (item.data(NAME_ROLE) != wanted, len(item.text())), default=None)

    def _shown(self, row: int) -> bool:
        return not self.list.item(row).isHidden()

    def _filter(self, text: str) -> None:
        self.list.setCurrentRow(-1)
        for row in range(self.list.count()):
            item = self.list.item(row)
            wanted, titles = text.strip().lower(), (item.text().lower(), item.data(NAME_ROLE))  # shown, command line
            item.setHidden(not any(wanted in title for title in titles))

    def _describe(self, item: QListWidgetItem | None) -> None:
        self.about.setText(item.toolTip() if item is not None else tr("Choose a silhouette"))

    def _on_activated(self, item: QListWidgetItem) -> None:
        self.chosen.emit(item.data(NAME_ROLE))
        self.close()
