"""The letters of the text tool: their family, bold and italic."""

from __future__ import annotations

from PySide6.QtCore import QSignalBlocker
from PySide6.QtGui import QFont
from PySide6.QtWidgets import QFontComboBox, QHBoxLayout, QWidget

from kirigami_studio.foundation.words import tr
from kirigami_studio.gui.look import icons
from kirigami_studio.gui.look.theme import Palette
from kirigami_studio.gui.panels.card import tool_button
from kirigami_studio.gui.sketching.sketch_context import SketchContext


class FontOptions(QWidget):
    """Families of this computer that can be scaled; the list is filled when it is shown for the first time."""

    def __init__(self, context: SketchContext) -> None:
        super().__init__()
        self._context = context
        self._row = QHBoxLayout(self)
        self._row.setContentsMargins(0, 0, 0, 0)
        self._row.setSpacing(2)
        self.family: QFontComboBox | None = None
        self.bold = tool_button("fontBold", tr("Bold letters. Sheets show thick strokes better than thin ones."), True)
        self.italic = tool_button("fontItalic", tr("Italic letters."), True)
        self.bold.setChecked(context.bold)
        self.bold.toggled.connect(lambda on: setattr(context, "bold", on))
        self.italic.toggled.connect(lambda on: setattr(context, "italic", on))
        self._row.addWidget(self.bold)
        self._row.addWidget(self.italic)

    def fill(self) -> None:
        """List the families: reading them takes a while, so only when the text tool is taken."""
        if self.family is not None:
            return
        self.family = QFontComboBox()
        self.family.setFontFilters(QFontComboBox.FontFilter.ScalableFonts)
        self.family.setAccessibleName(tr("Font of the text"))
        self.family.setToolTip(tr("Font of the text. Its letters are moved together until they hang in one piece."))
        self.family.setMaximumWidth(190)
        with QSignalBlocker(self.family):
            self.family.setCurrentFont(QFont(self._context.family) if self._context.family else self.font())
        self.family.currentFontChanged.connect(lambda font: setattr(self._context, "family", font.family()))
        self._row.insertWidget(0, self.family)

    def set_palette(self, palette: Palette) -> None:
        """Draw in other colours."""
        self.bold.setIcon(icons.icon("bold", palette))
        self.italic.setIcon(icons.icon("italic", palette))
