"""What was measured on a calibration coupon, turned into a kerf."""

from __future__ import annotations

import re

from PySide6.QtCore import Signal
from PySide6.QtWidgets import QHBoxLayout, QLineEdit, QPushButton, QWidget

from kirigami_studio.fabricate.coupon import kerf_from_gaps
from kirigami_studio.foundation.errors import FabricationError
from kirigami_studio.foundation.words import tr


class GapRow(QWidget):
    """One line for the gaps beside the coupon's comb, and a button that makes a kerf of them."""

    measured = Signal(float, str)  #: kerf in mm; what to say about it
    refused = Signal(str)

    def __init__(self, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self.gaps = QLineEdit()
        self.gaps.setObjectName("material_gaps")
        self.gaps.setPlaceholderText(tr("Gaps, mm: 0.29 0.31"))
        self.gaps.setAccessibleName(tr("Gap beside the coupon's comb in millimetres"))
        self.gaps.setToolTip(
            tr(
                "The gap beside the comb of the coupon, in mm, with all its fingers pushed aside; once, or several "
                "times with spaces between."
            )
        )
        self.button = QPushButton(tr("Set &kerf"))
        self.button.setObjectName("material_kerf_from_gaps")
        self.button.setAutoDefault(False)
        self.button.setToolTip(tr("Turn the measured gaps into this material's kerf."))
        row = QHBoxLayout(self)
        row.setContentsMargins(0, 0, 0, 0)
        row.addWidget(self.gaps, 1)
        row.addWidget(self.button)
        self.gaps.textChanged.connect(lambda _: self.allow(self.gaps.isEnabled()))
        self.gaps.returnPressed.connect(self.take)
        self.button.clicked.connect(self.take)

    def allow(self, editable: bool) -> None:
        """Whether the chosen material may be changed."""
        self.gaps.setEnabled(editable)
        self.button.setEnabled(editable and bool(self.gaps.text().strip()))

    def take(self) -> None:
        """Tell the kerf that the gaps amount to, or why they amount to none."""
        words = re.split(r"[\s;]+", self.gaps.text().strip())
        try:
            found = kerf_from_gaps([float(word.replace(",", ".")) for word in words])
        except ValueError:
            self.refused.emit(tr("Gaps are numbers of mm with spaces between, such as 0.29 0.31."))
        except FabricationError as error:
            self.refused.emit(str(error))
        else:
            doubt = tr(" ± {doubt:.3f}", doubt=found.doubt_mm) if found.doubt_mm else ""
            self.measured.emit(
                found.kerf_mm, tr("Kerf {kerf:.3f}{doubt} mm; save it.", kerf=found.kerf_mm, doubt=doubt)
            )
