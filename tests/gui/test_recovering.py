"""Unsaved work survives the death of the program, and nobody else's work is touched."""

from __future__ import annotations

import signal
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import pytest
from PySide6.QtCore import QTimer
from pytestqt.qtbot import QtBot

from kirigami_studio.foundation.errors import ProjectError
from kirigami_studio.gui.session.messages import Message, Tone
from kirigami_studio.gui.window.main_window import MainWindow
from kirigami_studio.gui.window.services import Services
from kirigami_studio.project import edits, recovery, store
from kirigami_studio.project.document import Document
from kirigami_studio.project.recovery import RecoveryNote
from tests.refusals import refused

Until = Callable[[Callable[[], bool]], None]

#: A studio that opens a project, changes it, and says so once the change is kept; it never ends by itself.
VICTIM = """
import sys
from pathlib import Path
from kirigami_studio.gui.window.application import create_application, create_window

application = create_application(["studio"])
window = create_window()
recovering = window.services.project.recovery
recovering.quiet_ms = 20
recovering.use(Path(sys.argv[1]))
def change(path):
    window.services.fabrication.change(width_mm=123.0)
def tell(document):
    print(document.fabrication.width_mm, flush=True)
window.services.project.opened.connect(change)
recovering.kept.connect(tell)
window.services.project.open(Path(sys.argv[2]))
application.exec()
"""


def kill_a_studio(folder: Path, project: Path) -> None:
    """Let a real studio change a project, then kill it without a warning."""
    victim = subprocess.Popen(
        [sys.executable, "-c", VICTIM, str(folder), str(project)], stdout=subprocess.PIPE, text=True
    )
    try:
        assert victim.stdout is not None
        assert victim.stdout.readline().strip() == "123.0"
    finally:
        victim.send_signal(signal.SIGKILL)
        victim.communicate(timeout=30)
    assert victim.returncode == -signal.SIGKILL


def asked(window: MainWindow) -> list[Message]:
    return [one for one in window.messages.messages if "quit unexpectedly" in one.sentence]


def kept_files(folder: Path) -> list[Path]:
    return sorted(folder.glob("*.kiri"))


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    return tmp_path / "state" / "recovery"


def test_that_a_killed_studio_loses_nothing(
    window: MainWindow, project_file: Path, folder: Path, designs: Document, until: Until
) -> None:
    kill_a_studio(folder, project_file)
    (left,) = kept_files(folder)
    assert recovery.read_note(left).path == str(project_file)

    window.services.project.recovery.use(folder)
    until(lambda: bool(asked(window)))
    (message,) = asked(window)
    assert "heart.kiri" in message.sentence and [label for label, _ in message.actions] == [
        "Recover",
        "Discard",
        "Keep for later",
    ]
    dict(message.actions)["Recover"]()
    until(lambda: window.session.stage is not None)
    services = window.services
    assert (
        services.session.document.fabrication.width_mm == 123.0
        and services.session.document.candidates == designs.candidates
    )
    assert services.session.path == project_file and services.session.history.unsaved and window.isWindowModified()
    assert store.load(project_file).fabrication.width_mm == 100.0, "the project itself is only written by Save"
    # The old file goes once this session keeps the work itself, so that a second crash loses nothing either.
    until(lambda: not left.exists())
    own = services.project.recovery.file
    assert own is not None and kept_files(folder) == [own] and store.load(own) == services.session.document
    window.commands["save"].trigger()
    until(lambda: not services.session.history.unsaved)
    assert kept_files(folder) == [] and store.load(project_file).fabrication.width_mm == 123.0


def test_that_work_left_for_later_is_offered_again_from_the_file_menu(
    window: MainWindow, project_file: Path, folder: Path, until: Until
) -> None:
    kill_a_studio(folder, project_file)
    window.services.project.recovery.use(folder)
    until(lambda: bool(asked(window)))
    dict(asked(window)[0].actions)["Keep for later"]()
    window.messages.drop(asked(window)[0])
    window.commands["recover"].trigger()
    until(lambda: bool(asked(window)))
    window.commands["recover"].trigger()  # asked twice, shown once
    until(lambda: not window.session.queue.busy)
    assert len(asked(window)) == 1
    dict(asked(window)[0].actions)["Recover"]()
    until(lambda: window.session.stage is not None)
    assert window.session.document.fabrication.width_mm == 123.0


def test_that_nothing_to_recover_is_said(window: MainWindow, folder: Path) -> None:
    window.services.project.recovery.use(folder)
    window.commands["recover"].trigger()
    assert window.messages.messages[-1].sentence == "There is no unsaved work to recover."


def test_that_two_studios_do_not_recover_each_others_work(designed: MainWindow, folder: Path, until: Until) -> None:
    designed.services.project.recovery.quiet_ms = 0
    designed.services.project.recovery.use(folder)
    designed.services.fabrication.change(width_mm=88.0)
    until(lambda: len(kept_files(folder)) == 1)
    other = Services()
    told: list[Message] = []
    other.session.message_posted.connect(told.append)
    other.project.recovery.use(folder)
    assert not other.session.queue.busy, "there is nothing to look at: the only file belongs to a living session"
    other.close()
    assert told == [] and len(kept_files(folder)) == 1
    designed.services.project.undo()
    assert kept_files(folder) == [], "what is as it was saved needs no recovery"


def test_that_closing_as_usual_leaves_nothing_to_recover(qtbot: QtBot, folder: Path) -> None:
    services = Services()
    services.project.recovery.quiet_ms = 0
    services.project.recovery.use(folder)
    with qtbot.waitSignal(services.project.recovery.kept):
        services.fabrication.change(width_mm=88.0)
    assert len(kept_files(folder)) == 1
    services.fabrication.change(width_mm=89.0)
    services.close()
    assert list(folder.iterdir()) == []
    assert [timer for timer in services.findChildren(QTimer) if timer.isActive()] == []


def test_that_steady_changes_do_not_put_the_keeping_off_for_ever(qtbot: QtBot, folder: Path) -> None:
    services = Services()
    recovering = services.project.recovery
    recovering.quiet_ms, recovering.longest_ms = 60_000, 200
    recovering.use(folder)
    steady = QTimer()
    widths = iter(range(50, 5000))
    steady.timeout.connect(lambda: services.fabrication.change(width_mm=float(next(widths))))
    with qtbot.waitSignal(recovering.kept, timeout=10_000):
        steady.start(10)
    steady.stop()
    services.close()


def test_that_discarded_work_is_gone_and_work_kept_for_later_is_asked_about_again(
    window: MainWindow, designs: Document, folder: Path, until: Until
) -> None:
    for name in ("one", "two"):
        recovery.keep(designs, RecoveryNote(name, "", recovery.now()), folder / f"{name}.kiri")
    recovering = window.services.project.recovery
    recovering.use(folder)
    until(lambda: len(asked(window)) == 2)
    first, second = (next(one for one in asked(window) if f"Recover {name}" in one.sentence) for name in ("one", "two"))
    dict(first.actions)["Discard"]()
    dict(second.actions)["Keep for later"]()
    assert [file.name for file in kept_files(folder)] == ["two.kiri"]
    while window.messages.messages:
        window.messages.close_message()
    recovering.look_back()
    until(lambda: len(asked(window)) == 1)
    assert "Recover two" in asked(window)[0].sentence


def test_that_recovering_asks_before_it_takes_the_place_of_unsaved_work(
    designed: MainWindow, designs: Document, folder: Path, until: Until
) -> None:
    recovery.keep(edits.choose(designs, 2).document, RecoveryNote("other", "", recovery.now()), folder / "other.kiri")
    designed.services.fabrication.change(width_mm=88.0)
    before = designed.session.document
    designed.services.project.recovery.use(folder)
    until(lambda: len(asked(designed)) == 1)
    dict(asked(designed)[0].actions)["Recover"]()
    assert designed.session.document is before
    question = next(one for one in designed.messages.messages if "unsaved changes" in one.sentence)
    dict(question.actions)["Don't save"]()
    until(lambda: designed.session.document.chosen == 2)
    assert designed.session.path is None and designed.session.history.unsaved


def test_that_recovered_work_stays_until_it_is_kept_itself_not_the_work_before_it(
    designed: MainWindow, designs: Document, folder: Path, until: Until
) -> None:
    left = folder / "other.kiri"
    recovery.keep(edits.choose(designs, 2).document, RecoveryNote("other", "", recovery.now()), left)
    recovering = designed.services.project.recovery
    recovering.use(folder)
    until(lambda: len(asked(designed)) == 1)
    kept: list[tuple[Document, bool]] = []
    recovering.kept.connect(lambda document: kept.append((document, left.exists())))
    recovering.quiet_ms = 0

    dict(asked(designed)[0].actions)["Recover"]()
    designed.services.fabrication.change(width_mm=88.0)
    recovering._keep()  # as the timer does, while the recovered work is being read
    until(lambda: not left.exists())
    own = recovering.file
    assert own is not None and store.load(own).chosen == 2
    assert [document.chosen for document, _ in kept] == [2]


@pytest.mark.parametrize("obstacle", ["folder", "file"])
def test_that_a_place_that_cannot_be_written_is_told_once_and_the_work_goes_on(
    obstacle: str, heart: MainWindow, folder: Path, until: Until
) -> None:
    recovering = heart.services.project.recovery
    recovering.quiet_ms = 0
    if obstacle == "folder":  # a file stands where the folder should be
        folder.parent.mkdir()
        folder.write_text("no folder")
    recovering.use(folder)
    assert recovering.file is not None
    if obstacle == "file":  # a folder stands where the file should be
        recovering.file.mkdir(parents=True)
    for width in (88.0, 89.0, 90.0):
        heart.services.fabrication.change(width_mm=width)
        heart.session.history.end_drag()
        until(lambda: not heart.session.queue.busy and not recovering.waiting)
    told = [one for one in heart.messages.messages if "Autosave is unavailable" in one.sentence]
    assert len(told) == 1 and told[0].tone is Tone.WARNING
    assert heart.session.document.fabrication.width_mm == 90.0
    if obstacle == "file":
        recovering.file.rmdir()


def test_that_damaged_work_is_named_and_can_be_discarded(window: MainWindow, folder: Path, until: Until) -> None:
    folder.mkdir(parents=True)
    (folder / "torn.kiri").write_bytes(b"PK\x03\x04 torn")
    window.services.project.recovery.use(folder)
    until(lambda: len(asked(window)) == 1)
    (message,) = asked(window)
    assert [label for label, _ in message.actions] == ["Discard", "Keep for later"] and "damaged" in message.details
    dict(message.actions)["Discard"]()
    assert kept_files(folder) == []


def test_that_kept_work_is_a_whole_project(designs: Document, tmp_path: Path) -> None:
    note = RecoveryNote("heart.kiri", "/somewhere/heart.kiri", recovery.now())
    recovery.keep(designs, note, tmp_path / "kept.kiri")
    assert store.load(tmp_path / "kept.kiri") == designs
    assert recovery.read_note(tmp_path / "kept.kiri") == note
    store.save(designs, tmp_path / "project.kiri")
    with refused(ProjectError, "recovery.damaged"):
        recovery.read_note(tmp_path / "project.kiri")


def test_that_saving_counts_for_what_was_written_not_for_what_came_after(designed: MainWindow, until: Until) -> None:
    services = designed.services
    services.fabrication.change(width_mm=88.0)
    path = services.session.path
    assert path is not None
    services.project.save(path)
    services.session.history.end_drag()
    services.fabrication.change(width_mm=99.0)  # before the worker has written
    until(lambda: not services.session.queue.busy)
    assert services.session.history.unsaved and store.load(path).fabrication.width_mm == 88.0
