"""The Qt binding itself: what the pinned versions must not do."""

from __future__ import annotations

import sys

import pytest
from PySide6.QtCore import QObject, Signal
from PySide6.QtWidgets import QApplication


class _Bell(QObject):
    rung = Signal(int)


@pytest.mark.skipif(sys.version_info >= (3, 12), reason="None and True are immortal from Python 3.12 on")
def test_that_signals_and_events_do_not_use_up_none_and_true(qapp: QApplication) -> None:
    """PySide6 6.12.0 returned borrowed references: some thousand signals aborted the process."""
    bell = _Bell()
    bell.rung.connect(lambda _: None)
    before = sys.getrefcount(None), sys.getrefcount(True)
    for _ in range(200):
        bell.rung.emit(1)
        qapp.processEvents()
    after = sys.getrefcount(None), sys.getrefcount(True)
    assert min(now - then for now, then in zip(after, before, strict=True)) > -100
