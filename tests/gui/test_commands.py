"""Commands are records: what they say about themselves holds for the actions in the menus."""

from __future__ import annotations

import re
from dataclasses import replace

from kirigami_studio.foundation.resources import resource
from kirigami_studio.gui.session.command import Command, WindowState, Wording
from kirigami_studio.gui.session.overlays import Overlay
from kirigami_studio.gui.widgets.actions import CommandActions
from kirigami_studio.gui.window.main_window import TOOLBAR, MainWindow
from kirigami_studio.project.document import Mark


def test_that_ids_are_unique_and_the_toolbar_names_some(window: MainWindow) -> None:
    ids = [command.id for command in window.commands.records]
    assert len(ids) == len(set(ids))
    assert {name for names in TOOLBAR for name in names if name} <= set(ids)


def test_that_every_action_is_as_its_record_says(designed: MainWindow) -> None:
    state = designed.state()
    for command in designed.commands.records:
        action, wording = designed.commands[command.id], command.wording(state)
        if command.switch is None:
            assert action.isEnabled() == command.enabled_when(state), command.id
            assert action.isCheckable() == (command.checked_when is not None), command.id
        else:
            assert action is command.switch and action.isCheckable(), command.id
        assert action.text() == wording.text and action.statusTip() == wording.tip
        assert action.icon().isNull() == (not wording.icon), command.id


def test_that_commands_follow_the_state_of_the_window(window: MainWindow) -> None:
    empty = window.state()
    records = {command.id: command for command in window.commands.records}
    assert not records["generate"].enabled_when(empty) and not records["pin"].enabled_when(empty)
    ready = replace(empty, has_target=True, has_designs=True, shows_design=True, chosen=Mark.PINNED)
    assert all(records[name].enabled_when(ready) for name in ("generate", "again", "pin", "lock", "export"))
    assert records["pin"].wording(ready).text != records["pin"].wording(empty).text
    running = replace(ready, running=True)
    assert not any(records[name].enabled_when(running) for name in ("generate", "again", "pin", "lock"))
    assert records["cancel"].enabled_when(running) and not records["cancel"].enabled_when(ready)
    assert records["cancel"].enabled_when(replace(ready, busy=True))


def test_that_a_switch_that_does_nothing_stays_as_it_was(window: MainWindow) -> None:
    window.commands["compare"].trigger()  # there is nothing to compare
    assert not window.stage.comparing and not window.commands["compare"].isChecked()


def test_that_a_changed_state_changes_enabling_checking_and_words_at_once(window: MainWindow) -> None:
    def worded(now: WindowState) -> Wording:
        return Wording("Running" if now.running else "Idle", "What goes on")

    command = Command(
        "Probes",
        "probe",
        "Idle",
        "What goes on",
        lambda: None,
        enabled_when=lambda now: not now.running,
        checked_when=lambda now: now.running,
        worded=worded,
    )
    state = [window.state()]
    made = CommandActions(window, (command,), lambda: state[0])
    action = made["probe"]
    assert action.isEnabled() and not action.isChecked() and action.text() == "Idle"
    state[0] = replace(state[0], running=True)
    made.refresh()
    assert not action.isEnabled() and action.isChecked() and action.text() == "Running"


def test_that_the_guide_lists_keys_that_commands_have(window: MainWindow) -> None:
    guide = resource("guide", "guide.md").read_text(encoding="utf-8")
    arrows = {"←": "Left", "→": "Right", "↑": "Up", "↓": "Down"}
    listed = {re.sub("[←→↑↓]", lambda found: arrows[found[0]], keys) for keys in re.findall(r"`(Ctrl\+[^`]+)`", guide)}
    known = {keys for command in window.commands.records for keys in command.shortcuts}
    assert len(listed) > 15 and listed - known == {"Ctrl+A"}  # which selects all in every list


def test_that_a_button_is_its_command(designed: MainWindow) -> None:
    """One action for both: nothing is mirrored, so nothing can differ."""
    stage, commands = designed.stage, designed.commands
    for button, name in (
        (stage.trim, "trim"),
        (stage.hand, "hand"),
        (stage.before, "before"),
        (stage.plots_switch, "plots"),
        (stage.toggles[Overlay.TARGET], "show_target"),
        (designed.gallery.bar.compare, "compare"),
    ):
        assert button.defaultAction() is commands[name]
        assert (button.isEnabled(), button.isChecked()) == (commands[name].isEnabled(), commands[name].isChecked())
    stage.plots_switch.click()
    assert commands["plots"].isChecked() and stage.plots.isVisible()
    commands["plots"].trigger()
    assert not stage.plots_switch.isChecked() and not stage.plots.isVisible()
