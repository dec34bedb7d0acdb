"""The picker of a drawing's parts: it asks where there is a choice and shows the result; Cancel changes nothing."""

from __future__ import annotations

import re
from collections.abc import Callable
from pathlib import Path

import ezdxf
import numpy as np
import pytest
from PIL import Image, ImageDraw
from PySide6.QtCore import QMimeData, QPointF, Qt, QUrl
from PySide6.QtTest import QTest
from PySide6.QtWidgets import QApplication

from kirigami_studio.gui.target.part_picker import PartPicker
from kirigami_studio.gui.window.main_window import MainWindow
from kirigami_studio.outlines.merging import Join

Until = Callable[[Callable[[], bool]], None]
LAYER = 'xmlns:inkscape="http://www.inkscape.org/namespaces/inkscape" inkscape:groupmode="layer"'
LOGO = f"""
<g {LAYER} inkscape:label="Badge"><circle id="disc" cx="30" cy="40" r="20" fill="#c03030"/>
<rect id="plate" x="60" y="25" width="30" height="30" fill="#2050c0"/></g>
<g {LAYER} inkscape:label="Line"><path id="swoosh" d="M10 80H110" fill="none" stroke="#108040" stroke-width="5"/></g>"""


def written(folder: Path, body: str, name: str = "logo.svg") -> Path:
    path = folder / name
    size = 'width="120mm" height="100mm" viewBox="0 0 120 100"'
    path.write_text(f'<svg xmlns="http://www.w3.org/2000/svg" {size}>{body}</svg>', encoding="utf-8")
    return path


@pytest.fixture
def logo(tmp_path: Path) -> Path:
    return written(tmp_path, LOGO)


@pytest.fixture
def picker(window: MainWindow, logo: Path, until: Until) -> PartPicker:
    """The picker as it opens by itself."""
    window.files.open(str(logo))
    return opened(window, until)


def opened(window: MainWindow, until: Until) -> PartPicker:
    until(lambda: window.dialogs.parts is not None and window.dialogs.parts.isVisible())
    made = window.dialogs.parts
    assert made is not None
    until(lambda: not made._job.busy)
    return made


def settled(picker: PartPicker, until: Until) -> None:
    until(lambda: not picker._job.busy)


def told(picker: PartPicker) -> tuple[float, float]:
    """Width and height, mm, that the picker tells."""
    found = re.fullmatch(r"The target will be ([\d.]+) \N{MULTIPLICATION SIGN} ([\d.]+) mm\.", picker.size_.text())
    assert found is not None
    return float(found[1]), float(found[2])


def names(picker: PartPicker) -> set[str]:
    assert picker._read is not None
    return {part.name for part in picker._read.source.of(picker.chosen)}


def click_part(picker: PartPicker, x: float, y: float) -> None:
    """Click at a place of the drawing, mm, y up."""
    px, py = picker.view.transform.to_pixels(np.array([x, y])).tolist()
    QTest.mouseClick(picker.view, Qt.MouseButton.LeftButton, pos=QPointF(px, py).toPoint())


@pytest.mark.parametrize(
    ("purpose", "asks", "button"),
    [("start", "what the sheet is to start as", "&Use as start"), ("second", "second target", "&Use as second target")],
)
def test_that_start_and_second_target_are_chosen_among_the_parts_of_a_drawing_too(
    purpose: str, asks: str, button: str, window: MainWindow, logo: Path, until: Until
) -> None:
    reader = {"start": window.target.start, "second": window.settings.second}[purpose]
    reader.drops.file_dropped.emit(str(logo))
    picker = opened(window, until)
    assert names(picker) == {"disc"} and asks in picker.about.text() and picker.take.text() == button
    assert picker.size_.text() == "The outline is 40.0 \N{MULTIPLICATION SIGN} 40.0 mm; only its shape counts."
    before = window.session.document
    picker.reject()
    assert window.session.document is before and window.status_text.text() == "No part was taken; nothing changed."
    reader.drops.file_dropped.emit(str(logo))
    opened(window, until)
    click_part(picker, 30, -40)
    click_part(picker, 75, -40)
    settled(picker, until)
    picker.take.click()
    settings = lambda: window.session.document.settings  # noqa: E731
    if purpose == "start":
        until(lambda: settings().start.name == "plate")
    else:
        until(lambda: settings().second is not None and settings().second.outline.name == "plate")
    assert window.session.document.target is None and len(window.session.history.steps) == 1


def test_that_the_picker_for_a_start_is_that_for_a_target_the_next_time(
    window: MainWindow, logo: Path, until: Until
) -> None:
    window.target.start.drops.file_dropped.emit(str(logo))
    opened(window, until).reject()
    window.files.open(str(logo))
    picker = opened(window, until)
    assert picker.take.text() == "&Use as target" and told(picker) == (40.0, 40.0)
    picker.take.click()
    until(lambda: window.session.document.target is not None)
    assert window.session.document.settings.start.is_plain


def test_that_parts_too_hollow_for_a_start_are_refused(window: MainWindow, until: Until, tmp_path: Path) -> None:
    ring = '<path id="sickle" d="M10 10h80v10h-70v60h70v10h-80z"/><circle id="dot" cx="70" cy="50" r="5"/>'
    window.target.start.drops.file_dropped.emit(str(written(tmp_path, ring)))
    opened(window, until).take.click()
    until(lambda: any("hollow" in message.sentence for message in window.messages.messages))
    assert window.session.document.settings.start.is_plain


def test_that_a_drawing_of_several_parts_asks_with_the_largest_checked(window, picker) -> None:
    assert names(picker) == {"disc"}
    layers = [picker.list.topLevelItem(row).text(0) for row in range(picker.list.topLevelItemCount())]
    assert layers == ["Badge", "Line"]
    assert told(picker) == (40.0, 40.0)
    assert "2 parts were left out: plate, swoosh." in picker.notes.text()
    assert window.target.view.outline is None


def test_that_every_part_has_a_picture(picker, until) -> None:
    until(lambda: not picker._undrawn)
    assert all(not item.icon(0).isNull() for item in picker._items.values())


def test_that_return_takes_what_is_checked_as_one_step(window, picker, until) -> None:
    QTest.keyClick(picker.list, Qt.Key.Key_Return)
    until(lambda: window.target.view.outline is not None)
    target = window.session.document.target
    assert target is not None and target.name == "disc" and target.size == pytest.approx((40, 40), rel=1e-3)
    assert not picker.isVisible()
    window.services.project.undo()
    assert window.session.document.target is None


def test_that_a_drawing_whose_parts_have_no_names_gives_target_and_files_its_own(
    window: MainWindow, files: object, until: Until, tmp_path: Path
) -> None:
    body = '<circle cx="30" cy="40" r="20"/><rect x="60" y="25" width="30" height="30"/>'
    for parts in (1, 2):
        window.files.open(str(written(tmp_path, body, "badge.svg")))
        asked = opened(window, until)
        if parts == 2:
            asked.all.click()
            settled(asked, until)
        before = window.session.document.target
        asked.take.click()
        until(lambda: window.session.document.target is not before)  # noqa: B023 - called at once
        target = window.session.document.target
        assert target is not None and target.name == "badge", parts
        window.commands["save_as"].trigger()
        assert files.proposals[-1].startswith("badge")  # type: ignore[attr-defined]


def test_that_a_click_in_the_picture_takes_a_part_in_and_bridges_it(window, picker, until) -> None:
    click_part(picker, 75, -40)
    settled(picker, until)
    assert names(picker) == {"disc", "plate"}
    assert picker.result_ is not None and len(picker.result_.bridges) == 1
    assert told(picker) == (80.0, 40.0)
    click_part(picker, 30, -40)
    settled(picker, until)
    assert names(picker) == {"plate"}


def test_that_keys_alone_choose_parts(picker, until) -> None:
    for key in (Qt.Key.Key_Space, Qt.Key.Key_Down, Qt.Key.Key_Space):
        QTest.keyClick(picker.list, key)
    settled(picker, until)
    assert names(picker) == {"plate"}


def test_that_a_layer_is_checked_and_cleared_at_once(picker, until) -> None:
    picker.list.topLevelItem(0).setCheckState(0, Qt.CheckState.Checked)
    settled(picker, until)
    assert names(picker) == {"disc", "plate"}
    picker.list.topLevelItem(0).setCheckState(0, Qt.CheckState.Unchecked)
    settled(picker, until)
    assert not picker.chosen and not picker.take.isEnabled()
    assert picker.notes.text() == "Check at least one part."


def test_that_cancel_changes_nothing(window, heart_and_logo, until) -> None:
    picker, before = heart_and_logo
    click_part(picker, 75, -40)
    QTest.keyClick(picker, Qt.Key.Key_Escape)
    assert not picker.isVisible()
    assert window.session.document is before
    assert window.status_text.text() == "No part was taken; nothing changed."


@pytest.fixture
def heart_and_logo(heart: MainWindow, logo: Path, until: Until):
    before = heart.session.document
    heart.files.open(str(logo))
    return opened(heart, until), before


def test_that_strokes_are_taken_as_painted_and_joined(window, tmp_path, until) -> None:
    body = '<g fill="none" stroke="#000" stroke-width="6"><path d="M10 10h80"/><path d="M10 40h80"/></g>'
    window.files.open(str(written(tmp_path, body)))
    picker = opened(window, until)
    assert picker.painted.isChecked() and len(picker.chosen) == 2
    assert told(picker) == (80.0, 36.0)
    picker.painted.setChecked(False)
    settled(picker, until)
    assert picker.result_ is None and "enclose no area" in picker.notes.text()
    assert not picker.take.isEnabled()
    picker.join.choose(Join.HULL)
    settled(picker, until)
    assert told(picker) == (80.0, 30.0)


def test_that_lines_without_a_width_have_a_field_for_it(window, tmp_path, until) -> None:
    path = tmp_path / "line.dxf"
    drawing = ezdxf.new(units=4)
    drawing.modelspace().add_line((0, 0), (100, 0))
    drawing.saveas(path)
    window.files.open(str(path))
    picker = opened(window, until)
    assert picker.stroke.isVisible()
    picker.stroke.setValue(10.0)
    settled(picker, until)
    assert told(picker) == (110.0, 10.0)


def test_that_the_width_of_bridges_is_taken(picker, until) -> None:
    picker.all.click()
    picker.bridge.setValue(2.0)
    settled(picker, until)
    assert picker.result_ is not None
    (bridge,) = picker.result_.bridges
    assert min(bridge.bounds[2] - bridge.bounds[0], bridge.bounds[3] - bridge.bounds[1]) == pytest.approx(2.0)


def test_that_dropping_and_pasting_ask_too(window, logo, until) -> None:
    content = QMimeData()
    content.setUrls([QUrl.fromLocalFile(str(logo))])
    window.pasting.take(content)
    picker = opened(window, until)
    picker.reject()
    content = QMimeData()
    content.setText(logo.read_text(encoding="utf-8"))
    window.pasting.take(content)
    assert names(opened(window, until)) == {"disc"}


def test_that_a_drawing_of_one_part_is_taken_at_once(window, tmp_path, until) -> None:
    window.files.open(str(written(tmp_path, '<circle cx="50" cy="50" r="30"/>')))
    until(lambda: window.target.view.outline is not None)
    assert window.dialogs.parts is None


def test_that_parts_can_be_chosen_again(window, picker, until) -> None:
    QTest.keyClick(picker.list, Qt.Key.Key_Return)
    until(lambda: window.target.view.outline is not None)
    assert window.commands["choose_parts"].isEnabled()
    window.commands["choose_parts"].trigger()
    opened(window, until)
    click_part(picker, 75, -40)
    settled(picker, until)
    picker.take.click()
    QApplication.processEvents()
    target = window.session.document.target
    assert target is not None and target.size == pytest.approx((80, 40), rel=1e-3)


def test_that_parts_of_a_library_silhouette_cannot_be_chosen(heart) -> None:
    assert not heart.commands["choose_parts"].isEnabled()


def test_that_a_damaged_drawing_says_so_and_asks_nothing(heart, tmp_path, until) -> None:
    path = tmp_path / "broken.svg"
    path.write_text("<svg><g></svg>")
    before = heart.session.document
    heart.files.open(str(path))
    until(lambda: bool(heart.messages.messages))
    assert heart.session.document is before and heart.dialogs.parts is None


def test_that_a_picture_of_two_shapes_asks_and_the_usual_one_keeps_its_threshold(window, tmp_path, until) -> None:
    page = Image.new("L", (300, 200), 250)
    draw = ImageDraw.Draw(page)
    draw.ellipse((20, 20, 120, 120), fill=20)
    draw.rectangle((160, 60, 219, 119), fill=20)
    path = tmp_path / "shapes.png"
    page.save(path)
    window.files.open(str(path))
    picker = opened(window, until)
    assert len(picker._items) == 2 and len(picker.chosen) == 1
    picker.take.click()
    until(lambda: window.target.view.outline is not None)
    assert window.target.threshold.isVisible()
    window.commands["choose_parts"].trigger()
    opened(window, until)
    picker.all.click()
    settled(picker, until)
    picker.take.click()
    QApplication.processEvents()
    target = window.session.document.target
    assert target is not None and target.size is not None and target.size[0] == pytest.approx(200, abs=2)


def test_that_a_cut_file_is_the_second_target_of_its_design_or_a_start_like_its_sheet_unasked(
    designed: MainWindow, until: Until, tmp_path: Path
) -> None:
    services, path = designed.services, tmp_path / "cut.dxf"
    services.exporter.export(path)
    until(lambda: path.exists() and not services.session.queue.busy)
    target, stage = services.session.document.target, services.session.stage
    assert target is not None and stage is not None
    designed.settings.second.drops.file_dropped.emit(str(path))
    until(lambda: services.session.document.settings.second is not None)
    second = services.session.document.settings.second
    assert second is not None and second.outline == target
    designed.target.start.drops.file_dropped.emit(str(path))
    until(lambda: not services.session.document.settings.start.is_plain)
    start = services.session.document.settings.start.outline
    assert start is not None and designed.dialogs.parts is None
    sheet, outline = np.ptp(stage.design.deployment.compact, axis=0), np.ptp(start.points, axis=0)
    assert outline[1] / outline[0] == pytest.approx(sheet[1] / sheet[0], rel=0.01)


# the click on a photo -----------------------------------------------------------------------------------------------


@pytest.fixture
def still_life(window: MainWindow, tmp_path: Path, until: Until) -> PartPicker:
    """A picture of two large shapes, which asks by itself."""
    page = Image.new("RGB", (400, 300), (150, 110, 75))
    draw = ImageDraw.Draw(page)
    draw.rectangle((40, 80, 159, 219), fill=(235, 235, 230))
    draw.rectangle((220, 90, 299, 209), fill=(40, 70, 160))
    draw.rectangle((300, 90, 359, 209), fill=(230, 200, 60))
    path = tmp_path / "still life.png"
    page.save(path)
    window.files.open(str(path))
    return opened(window, until)


def click_photo(picker: PartPicker, until: Until, x: float, y: float, button: Qt.MouseButton) -> None:
    """Click at a pixel of the photo, y down, where nothing is known as a part."""
    assert picker._read is not None and picker._read.photo is not None
    place = picker.view.transform.to_pixels(np.array([x, 300.0 - y])).tolist()
    QTest.mouseClick(picker.view, button, pos=QPointF(*place).toPoint())
    until(lambda: not picker._pick.busy and not picker._job.busy)


def drag_photo(picker: PartPicker, until: Until, start: tuple[float, float], end: tuple[float, float]) -> None:
    places = [picker.view.transform.to_pixels(np.array([x, 300.0 - y])).tolist() for x, y in (start, end)]
    one, other = (QPointF(*place).toPoint() for place in places)
    QTest.mousePress(picker.view, Qt.MouseButton.LeftButton, pos=one)
    QTest.mouseMove(picker.view, other)
    QTest.mouseRelease(picker.view, Qt.MouseButton.LeftButton, pos=other)
    until(lambda: not picker._pick.busy and not picker._job.busy)


def made_size(picker: PartPicker) -> tuple[float, float]:
    assert picker.result_ is not None and picker.result_.outline.size is not None
    return picker.result_.outline.size


def test_that_a_stroke_on_the_photo_takes_the_object_and_a_right_click_removes(
    window: MainWindow, still_life: PartPicker, until: Until
) -> None:
    picker = still_life
    assert "Click on the object" in picker.about.text()
    before = picker.chosen
    drag_photo(picker, until, (240, 150), (280, 160))
    assert made_size(picker) == pytest.approx((80, 120), abs=2) and len(picker.chosen) == 1
    drag_photo(picker, until, (310, 150), (350, 160))
    assert made_size(picker) == pytest.approx((140, 120), abs=2)
    click_photo(picker, until, 330, 120, Qt.MouseButton.RightButton)
    assert made_size(picker) == pytest.approx((80, 120), abs=2)
    picker.restart.click()
    until(lambda: not picker._pick.busy and not picker._job.busy)
    assert picker.chosen == before and picker.restart.isHidden()
    drag_photo(picker, until, (240, 150), (280, 160))
    picker.take.click()
    until(lambda: window.session.document.target is not None)
    target = window.session.document.target
    assert target is not None and target.size == pytest.approx((80, 120), abs=2)


def test_that_a_click_on_nothing_keeps_what_was_taken_and_says_so(still_life: PartPicker, until: Until) -> None:
    picker = still_life
    drag_photo(picker, until, (240, 150), (280, 160))
    taken = picker.chosen
    for x, y in ((10, 10), (10, 12)):
        click_photo(picker, until, x, y, Qt.MouseButton.RightButton)
    assert picker.chosen == taken and made_size(picker) == pytest.approx((80, 120), abs=2)


def test_that_a_click_on_what_is_chosen_takes_the_object_there_and_leaves_nothing_out(
    still_life: PartPicker, until: Until
) -> None:
    picker = still_life
    assert picker._read is not None
    (number,) = picker.chosen
    middle = picker._read.source.parts[number - 1].region.representative_point()
    click_photo(picker, until, middle.x, 300.0 - middle.y, Qt.MouseButton.LeftButton)
    assert len(picker.chosen) == 1 and picker._read.photo is not None and picker._read.photo.strokes.taken
    assert min(made_size(picker)) > 50 and picker.take.isEnabled()


@pytest.mark.parametrize("gap", [0.0, 6.0])
def test_that_a_house_of_open_strokes_is_offered_and_not_its_window(
    window: MainWindow, tmp_path: Path, until: Until, gap: float
) -> None:
    """Before, the one closed contour was checked: the window."""
    walls = f'<path d="M18 {45 + gap} V88"/><path d="M82 {45 + gap} V88"/><path d="M18 88 H82"/>'
    house = f'<path d="M10 50 L50 15 L90 50"/>{walls}<rect x="40" y="62" width="16" height="14"/>'
    window.files.open(str(written(tmp_path, f'<g fill="none" stroke="#000" stroke-width="2">{house}</g>')))
    picker = opened(window, until)
    width, height = told(picker)
    assert width > 75.0 and height > 70.0, "the whole house"
    assert picker.painted.isChecked() and len(picker.chosen) == len(picker._read.source.parts)
    assert picker.result_ is not None and picker.result_.shape.area > 3000.0, "its inside too, not its lines alone"
