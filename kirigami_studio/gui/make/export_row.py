"""The button that writes the cut file, and the menu of other kinds."""

from __future__ import annotations

from PySide6.QtCore import QSize, Qt, Signal
from PySide6.QtGui import QAction
from PySide6.QtWidgets import QHBoxLayout, QMenu, QPushButton, QSizePolicy, QToolButton, QWidget

from kirigami_studio.foundation.words import mark, tr
from kirigami_studio.gui.widgets import icons
from kirigami_studio.gui.widgets.card import ToolButton
from kirigami_studio.gui.widgets.theme import Palette
from kirigami_studio.studio.file_kinds import FILE_KINDS

#: What the button says, by the extension of the cut file that suits machine and material.
EXPORT = {
    ".dxf": mark("Export DXF"),
    ".pdf": mark("Export PDF"),
    ".svg": mark("Export SVG"),
    ".lbrn2": mark("Export for LightBurn"),
    ".3mf": mark("Export 3MF"),
}


class ExportRow(QWidget):
    """Reports which kind of file is wanted."""

    export_wanted = Signal(str)  #: extension
    ideal_wanted = Signal()  #: an animation of the ideal motion
    all_wanted = Signal()
    artwork_wanted = Signal()
    print_wanted = Signal()

    def __init__(self, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self.extension = ".dxf"  #: of the file that the button writes
        self.export = QPushButton(tr(EXPORT[self.extension]))
        self.export.setObjectName("primary")
        self.export.setFocusPolicy(Qt.FocusPolicy.TabFocus)
        self.export.setIconSize(QSize(18, 18))
        self.export.clicked.connect(lambda: self.export_wanted.emit(self.extension))
        self.more = QToolButton()
        self.more.setObjectName("moreExports")
        self.more.setFocusPolicy(Qt.FocusPolicy.TabFocus)
        self.more.setToolTip(tr("Export another file type: SVG, PDF, PNG, GIF"))
        self.more.setAccessibleName(tr("Export another file type"))
        self.more.setPopupMode(QToolButton.ToolButtonPopupMode.InstantPopup)
        self.print_ = ToolButton("printCuts", "print", tr("Print the cut sheet at true size (Ctrl+P)."))
        self.print_.setProperty("offer", True)
        self.print_.clicked.connect(self.print_wanted)
        self.menu = QMenu(self.more)
        self.menu.setToolTipsVisible(True)
        self.kinds: dict[str, QAction] = {}
        for kind in FILE_KINDS:
            action = self.menu.addAction(tr("{kind} …", kind=tr(kind.title)))
            action.setToolTip(tr(kind.tip))
            action.triggered.connect(lambda _=False, kind=kind: self.export_wanted.emit(kind.extension))
            self.kinds[kind.extension] = action
            if kind.extension == ".gif":
                self.ideal = self.menu.addAction(tr("GIF animation, ideal …"))
                self.ideal.setToolTip(tr("The ideal motion to the target angle, with connectors of no width"))
                self.ideal.triggered.connect(lambda: self.ideal_wanted.emit())
        self.artwork = self.menu.addAction(tr("Artwork to a folder …"))
        self.artwork.setToolTip(tr("The picture on the sheet as SVG, PDF and PNG, in register with the cuts"))
        self.artwork.triggered.connect(lambda: self.artwork_wanted.emit())
        self.menu.addSeparator()
        self.everything = self.menu.addAction(tr("Everything to a folder …"))
        self.everything.setToolTip(tr("Every cut file, pictures and a record of the job (Ctrl+Shift+E)"))
        self.everything.triggered.connect(lambda: self.all_wanted.emit())
        self.more.setMenu(self.menu)
        row = QHBoxLayout(self)
        row.setContentsMargins(0, 0, 0, 0)
        row.setSpacing(6)
        row.addWidget(self.export, 1)
        for button in (self.print_, self.more):
            row.addWidget(button)
            button.setFixedWidth(38)
            button.setSizePolicy(QSizePolicy.Policy.Fixed, QSizePolicy.Policy.Ignored)

    def show_goal(self, profile: str, version: str, extension: str) -> None:
        """Offer the cut file with this extension first, and say in the tooltip what it is written for."""
        self.extension = extension
        self.export.setText(tr(EXPORT[extension]))
        if extension == ".pdf":
            self.export.setToolTip(tr("Export the cut sheet at 1:1, to print and to cut by hand (Ctrl+E)."))
            return
        if extension == ".3mf":
            self.export.setToolTip(tr("Export and check the plates to print in mm, as 3MF (Ctrl+E)."))
            return
        if extension != ".dxf":
            self.export.setToolTip(
                tr("Export and check the cut file in mm (Ctrl+E).\nMachine: {profile}.", profile=profile)
            )
            return
        self.export.setToolTip(
            tr(
                "Export and check the cut file in mm, DXF {version} (Ctrl+E).\nMachine: {profile}.",
                version=version,
                profile=profile,
            )
        )

    def allow(self, cuts: bool, pictures: bool) -> None:
        """Offer only what can be written: a picture needs a design, a cut file a plan."""
        self.export.setEnabled(cuts)
        self.more.setEnabled(cuts or pictures)
        self.print_.setEnabled(cuts)
        self.everything.setEnabled(cuts)
        self.artwork.setEnabled(cuts)
        self.ideal.setEnabled(pictures)
        for kind in FILE_KINDS:
            self.kinds[kind.extension].setEnabled(cuts if kind.cuts else pictures)

    def set_palette(self, palette: Palette) -> None:
        """Draw in other colours."""
        self.more.setIcon(icons.icon("down", palette))
        self.export.setIcon(icons.icon("export", palette, palette.on_accent))
