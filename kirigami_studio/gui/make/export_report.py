"""The report on an exported cut file: what two independent readers found in it."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

from PySide6.QtCore import QEvent, QSize, Qt, Signal
from PySide6.QtGui import QGuiApplication
from PySide6.QtWidgets import (
    QComboBox,
    QDialog,
    QGridLayout,
    QHBoxLayout,
    QLabel,
    QListWidget,
    QListWidgetItem,
    QPushButton,
    QVBoxLayout,
    QWidget,
)

from kirigami_studio.fabricate.findings import Severity
from kirigami_studio.foundation.words import ShownUnit, mark, tr, tr_n
from kirigami_studio.gui.widgets import icons
from kirigami_studio.gui.widgets.card import ElidedLabel
from kirigami_studio.gui.widgets.readable import UNKNOWN, readable_box, readable_length, readable_range
from kirigami_studio.gui.widgets.theme import DARK, LIGHT, Palette

if TYPE_CHECKING:
    from kirigami_studio.export.verification import Finding, Verification
    from kirigami_studio.studio.verdict import Verdict

SIZE = QSize(640, 470)
ICON_EDGE = 30


class ExportReport(QDialog):
    """Shows the verdict by symbol, word and colour, then every finding."""

    folder_wanted = Signal(Path)  #: of what was written
    open_wanted = Signal(Path)  #: in the program that the desktop has for it

    def __init__(
        self,
        parent: QWidget,
        verifications: tuple[Verification, ...],
        palette: Palette,
        judged: Verdict | None = None,
    ) -> None:
        super().__init__(parent)
        self.verifications = verifications
        self.judged = judged
        self._palette: Palette = palette
        self.setObjectName("exportReport")
        self.setWindowTitle(tr("Export report"))
        self.setModal(False)
        self.resize(SIZE)
        self.file = QComboBox()
        self.file.setAccessibleName(tr("Report file"))
        self.file.addItems([label(one) for one in verifications])
        self.file.setVisible(len(verifications) > 1)
        self.symbol, self.verdict, self.path = QLabel(), QLabel(), ElidedLabel()
        self.answers = ElidedLabel()
        self.answers.setObjectName("muted")
        self.answers.setText("" if judged is None else judged.summary)
        self.answers.setVisible(judged is not None)
        self.verdict.setWordWrap(True)
        self.findings = QListWidget()
        self.findings.setObjectName("reportFindings")
        self.findings.setAccessibleName(tr("Export report findings"))
        self.findings.setWordWrap(True)
        self.findings.setResizeMode(QListWidget.ResizeMode.Adjust)  # lines wrap anew beside a scroll bar
        self.findings.setIconSize(QSize(18, 18))
        self.findings.setSelectionMode(QListWidget.SelectionMode.NoSelection)
        self.findings.setHorizontalScrollBarPolicy(Qt.ScrollBarPolicy.ScrollBarAlwaysOff)
        self.facts = {name: QLabel() for name in format_facts(verifications[0])}
        self.folder = QPushButton(tr("Show in &folder"))
        self.open_file = QPushButton(tr("O&pen file"))
        self.copy = QPushButton(tr("&Copy"))
        self.shut = QPushButton(tr("Cl&ose"))
        self.shut.setDefault(True)
        self._lay_out()
        self.folder.clicked.connect(lambda: self.folder_wanted.emit(self.shown.path))
        self.open_file.clicked.connect(lambda: self.open_wanted.emit(self.shown.path))
        self.copy.clicked.connect(lambda: QGuiApplication.clipboard().setText(self.text()))
        self.shut.clicked.connect(self.close)
        self.file.currentIndexChanged.connect(self._show)
        worst = next((row for row, one in enumerate(verifications) if not one.ok), 0)
        self.file.setCurrentIndex(worst)
        self._show()

    @property
    def shown(self) -> Verification:
        """The report of the file that is shown."""
        return self.verifications[max(self.file.currentIndex(), 0)]

    def _show(self) -> None:
        self.verdict.setText(headline(self.shown, self.judged))
        self.path.setText(str(self.shown.path))
        for name, text in format_facts(self.shown).items():
            self.facts[name].setText(text)
        self.findings.clear()
        for word, icon, text in [*format_problems(self.judged), *format_findings(self.shown)]:
            item = QListWidgetItem(f"{word}: {text}")
            item.setData(Qt.ItemDataRole.UserRole, icon)
            self.findings.addItem(item)
        self._draw_icons()

    def text(self) -> str:
        """The whole report as plain text: the verdict, then every file."""
        parts = [] if self.judged is None else ["\n".join(self.judged.lines)]
        return "\n\n".join([*parts, *map(as_text, self.verifications)])

    def _lay_out(self) -> None:
        head = QHBoxLayout()
        head.setSpacing(12)
        head.addWidget(self.symbol, 0, Qt.AlignmentFlag.AlignTop)
        words = QVBoxLayout()
        words.setSpacing(2)
        words.addWidget(self.verdict)
        words.addWidget(self.answers)
        words.addWidget(self.path)
        head.addLayout(words, 1)
        table = QGridLayout()
        table.setVerticalSpacing(1)
        for column, (name, label) in enumerate(self.facts.items()):
            caption = QLabel(tr(name))
            caption.setObjectName("muted")
            label.setObjectName("number")
            caption.setBuddy(label)
            table.addWidget(caption, 0, column)
            table.addWidget(label, 1, column)
            table.setColumnStretch(column, 3 if column == 0 else 2)
        buttons = QHBoxLayout()
        buttons.addWidget(self.open_file)
        buttons.addWidget(self.folder)
        buttons.addWidget(self.copy)
        buttons.addStretch(1)
        buttons.addWidget(self.shut)
        whole = QVBoxLayout(self)
        whole.setContentsMargins(18, 16, 18, 16)
        whole.setSpacing(12)
        whole.addWidget(self.file)
        whole.addLayout(head)
        whole.addLayout(table)
        whole.addWidget(self.findings, 1)
        whole.addLayout(buttons)

    def changeEvent(self, event: QEvent) -> None:  # noqa: N802 - Qt's name
        """The window's theme has changed."""
        super().changeEvent(event)
        if event.type() == QEvent.Type.PaletteChange:
            self.set_palette(DARK if self.palette().window().color().lightness() < 128 else LIGHT)

    def set_palette(self, palette: Palette) -> None:
        """Draw in other colours."""
        if palette is not self._palette:
            self._palette = palette
            self._draw_icons()

    def _draw_icons(self) -> None:
        palette = self._palette
        tints = {"check": palette.good, "warning": palette.warning, "fault": palette.bad}
        symbol = symbol_of(self.shown, self.judged)
        self.symbol.setAccessibleName(self.verdict.text())
        self.symbol.setPixmap(icons.pixmap(symbol, tints[symbol], ICON_EDGE, self.devicePixelRatioF()))
        self.verdict.setStyleSheet(f"color: {tints[symbol]}; font-weight: 600; font-size: 12pt;")
        for row in range(self.findings.count()):
            item = self.findings.item(row)
            name = str(item.data(Qt.ItemDataRole.UserRole))
            item.setIcon(icons.icon(name, palette, tints[name]))


def label(verification: Verification) -> str:
    """A line of the list of files: the verdict, then the file's name."""
    name = verification.path.name
    if verification.sheet:
        name = tr("{name}, {part}", name=name, part=verification.sheet)
    if verification.ok:
        return tr("Verified  ·  {name}", name=name)
    return tr("Do not cut  ·  {name}", name=name)


def verdict(verification: Verification) -> str:
    """The report in one sentence."""
    bad = sum(not finding.ok for finding in verification.findings)
    notes = sum(finding.ok and finding.warning for finding in verification.findings) + len(verification.warnings)
    if not verification.ok:
        return tr_n("Do not cut this file: {count} check failed.", "Do not cut this file: {count} checks failed.", bad)
    if notes:
        return tr_n(
            "Verified, with {count} note to read before cutting.",
            "Verified, with {count} notes to read before cutting.",
            notes,
        )
    return tr("Verified: the file matches the plan.")


def headline(verification: Verification, judged: Verdict | None) -> str:
    """What is to be expected of the sheet where it is not ready to cut, else of the file."""
    if judged is None or judged.ok or not verification.ok:
        return verdict(verification)
    return tr("{level}: {text}", level=judged.level_words, text=judged.problems[0].text)


def symbol_of(verification: Verification, judged: Verdict | None) -> str:
    """The icon of the whole report: never a check mark where the sheet is not ready to cut."""
    if not verification.ok:
        return "fault"
    if judged is None or judged.ok:
        return "check"
    return "fault" if judged.problems[0].severity is Severity.ERROR else "warning"


def format_problems(judged: Verdict | None) -> list[tuple[str, str, str]]:
    """Word, icon and sentence of each problem of the sheet, in the order of the verdict."""
    problems = () if judged is None else judged.problems
    errors = [problem.severity is Severity.ERROR for problem in problems]
    return [
        (tr("Bad"), "fault", problem.text) if error else (tr("Care"), "warning", problem.text)
        for problem, error in zip(problems, errors, strict=True)
        if problem.code != "verify.in_file"
    ]


def format_facts(verification: Verification) -> dict[str, str]:
    """Size, pieces, cut length and time by their captions, which are not translated yet."""
    width, height = verification.size_mm
    pieces = UNKNOWN if verification.pieces is None else str(verification.pieces)
    size = readable_box(width, height, ".3f" if ShownUnit.inches else ".2f")
    return {
        mark("Size with overcuts"): size,
        mark("Pieces"): pieces,
        mark("Cut length"): readable_length(verification.cut_length_mm),
        mark("Time"): readable_range(verification.seconds_low, verification.seconds_high),
    }


def format_findings(verification: Verification) -> list[tuple[str, str, str]]:
    """Word, icon and sentence of each line, the bad ones first."""
    lines = [_finding_line(finding) for finding in verification.findings]
    lines += [(tr("Note"), "warning", note.text) for note in verification.warnings]
    return sorted(lines, key=lambda line: ("fault", "warning", "check").index(line[1]))


def _finding_line(finding: Finding) -> tuple[str, str, str]:
    if not finding.ok:
        return tr("Bad"), "fault", finding.text
    return (tr("Note"), "warning", finding.text) if finding.warning else (tr("Good"), "check", finding.text)


def as_text(verification: Verification) -> str:
    """The whole report as plain text."""
    facts = [f"{tr(name)}: {text}" for name, text in format_facts(verification).items()]
    lines = [f"{word}: {text}" for word, _, text in format_findings(verification)]
    return "\n".join([str(verification.path), verdict(verification), *facts, *lines])
