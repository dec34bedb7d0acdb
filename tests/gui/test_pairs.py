"""Examples of pairs on the first page: twelve finished designs, opened with their start and target."""

from __future__ import annotations

from collections.abc import Callable

from PySide6.QtCore import Qt
from PySide6.QtTest import QTest

from kirigami_studio.foundation.resources import resource
from kirigami_studio.gui.session.messages import Tone
from kirigami_studio.gui.widgets.theme import DARK
from kirigami_studio.gui.window.main_window import MainWindow

Until = Callable[[Callable[[], bool]], None]


def test_that_a_pair_opens_with_start_target_and_a_design_that_moves(window: MainWindow, until: Until) -> None:
    session = window.session
    window.target.start.entries["pairs"].trigger()
    gallery = window.welcome.pairs
    assert gallery.isVisible() and not gallery.complete
    until(lambda: gallery.complete)
    assert gallery.list.count() == 12 and all(not gallery.list.item(row).icon().isNull() for row in range(12))
    item = gallery.list.item(0)
    assert item.text().startswith("circle to heart  ·  match 9") and "Flat: circle, 100 " in item.toolTip()

    gallery.list.setCurrentRow(0)
    gallery.list.setFocus()
    QTest.keyClick(gallery.list, Qt.Key.Key_Return)
    until(lambda: session.stage is not None)
    assert not gallery.isVisible() and window.stage.isVisible(), "the design is on its page"
    document = session.document
    assert document.target is not None
    assert (document.settings.start.name, document.target.name) == ("circle", "heart")
    assert window.target.start.name == "circle" and window.stage.ends.start.accessibleName().startswith("flat: circle")
    assert session.path is None and not session.history.unsaved  # saved elsewhere, if at all
    assert window.run.generate.isEnabled() and window.stage.deployment.slider.isEnabled()
    until(lambda: window.fabrication.export.isEnabled())


def test_that_pairs_are_drawn_in_the_colours_of_the_theme_and_ask_before_work_is_lost(
    window: MainWindow, until: Until
) -> None:
    services = window.services
    window.commands["pairs"].trigger()
    gallery = window.welcome.pairs
    until(lambda: gallery.complete)
    light = gallery.list.item(5).icon().pixmap(258, 86).toImage()
    window.appearance.set_theme(DARK)
    until(lambda: gallery.complete)
    dark = gallery.list.item(5).icon().pixmap(258, 86).toImage()
    assert light.size() == dark.size() and light != dark

    services.settings.change(k=3)
    gallery.list.itemClicked.emit(gallery.list.item(2))
    message = window.messages.messages[-1]
    assert message.tone is Tone.WARNING and "before you open an example" in message.sentence
    assert services.session.document.settings.k == 3 and services.session.document.target is None
    message.actions[-1][1]()
    until(lambda: services.session.stage is not None)
    assert services.session.document.settings.start.name == "triangle"


def test_that_every_bundled_pair_is_listed(window: MainWindow, until: Until) -> None:
    window.commands["pairs"].trigger()
    gallery = window.welcome.pairs
    until(lambda: gallery.complete)
    assert [pair.path for pair in gallery.pairs] == sorted(resource("pairs").glob("*.kiri"))
