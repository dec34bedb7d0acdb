"""A screen reader's view of the running program: commands in, what AT-SPI says out, one JSON object a line.

Runs on the system's Python, which has the bindings of AT-SPI (Debian: python3-gi, gir1.2-atspi-2.0), and uses nothing
of the program.  ``python3 spoken_tree.py`` reads ``{"do": NAME, ...}``; the functions of ``Reader`` are the names.
"""

import json
import sys
import time
import warnings

import gi

gi.require_version("Atspi", "2.0")
from gi.repository import Atspi, GLib  # noqa: E402 - after the version was chosen

warnings.simplefilter("ignore", DeprecationWarning)
LABELLED_BY = Atspi.RelationType.LABELLED_BY
PATIENCE = 30.0


def children(node):
    """The children that are there; a program may take one away meanwhile."""
    found = (node.get_child_at_index(place) for place in range(node.get_child_count()))
    return [child for child in found if child is not None]


def has(node, state):
    return node.get_state_set().contains(state)


def described(node, depth):
    """What a screen reader can say of a node."""
    value, action = node.get_value_iface(), node.get_action_iface()
    relations = node.get_relation_set()
    labels = [one for one in relations if one.get_relation_type() == LABELLED_BY]
    return {
        "role": node.get_role_name(),
        "name": node.get_name(),
        "about": node.get_description(),
        "depth": depth,
        "focusable": has(node, Atspi.StateType.FOCUSABLE),
        "focused": has(node, Atspi.StateType.FOCUSED),
        "enabled": has(node, Atspi.StateType.ENABLED),
        "checked": has(node, Atspi.StateType.CHECKED),
        "value": value and [value.get_minimum_value(), value.get_current_value(), value.get_maximum_value()],
        "actions": [action.get_action_name(place) for place in range(action.get_n_actions())] if action else [],
        "labels": [one.get_target(place).get_name() for one in labels for place in range(one.get_n_targets())],
    }


class Reader:
    """Walks the tree of the one program on the bus."""

    def __init__(self):
        self._said = []
        self._listener = Atspi.EventListener.new(self._hear)
        self._listener.register("object:announcement")

    def _hear(self, event):
        self._said.append(event.any_data)

    def _program(self):
        desktop = Atspi.get_desktop(0)
        return next(iter(children(desktop)), None)

    def windows(self):
        """Names of the windows in sight."""
        program = self._program()
        return [one.get_name() for one in children(program) if has(one, Atspi.StateType.SHOWING)] if program else []

    def _window(self, title):
        return next(
            one
            for one in children(self._program())
            if title in one.get_name() and has(one, Atspi.StateType.SHOWING)
        )  # fmt: skip

    def tree(self, window):
        """All nodes in sight below the window of a title, depth first."""
        found, waiting = [], [(self._window(window), 0)]
        while waiting:
            node, depth = waiting.pop()
            found.append(described(node, depth))
            inside = [one for one in children(node) if has(one, Atspi.StateType.SHOWING)]
            waiting.extend((one, depth + 1) for one in reversed(inside))
        return found

    def _find(self, window, role, name):
        waiting = [self._window(window)]
        while waiting:
            node = waiting.pop()
            if node.get_role_name() == role and node.get_name().startswith(name):
                return node
            waiting.extend(reversed(children(node)))
        raise LookupError(f"no {role} {name!r} in {window!r}")

    def node(self, window, role, name):
        """One node, by its role and the beginning of its name; in sight or not."""
        return described(self._find(window, role, name), 0)

    def act(self, window, role, name, action="Press"):
        """Carry out an action."""
        actions = self._find(window, role, name).get_action_iface()
        known = [actions.get_action_name(place) for place in range(actions.get_n_actions())]
        return actions.do_action(known.index(action))

    def set_value(self, window, role, name, value):
        """Move a slider, fill in a number."""
        return self._find(window, role, name).get_value_iface().set_current_value(value)

    def focus(self, window, role, name):
        """Give the keyboard to a node."""
        return self._find(window, role, name).get_component_iface().grab_focus()

    def heard(self, text):
        """Wait until an announcement has a text in it, and return that."""
        end, context = time.monotonic() + PATIENCE, GLib.MainContext.default()
        while time.monotonic() < end:
            while context.pending():
                context.iteration(False)
            for said in self._said:
                if text in said:
                    return said
            time.sleep(0.05)
        return ""


def main():
    reader = Reader()
    for line in sys.stdin:
        order = json.loads(line)
        try:
            answer = {"is": getattr(reader, order.pop("do"))(**order)}
        except (LookupError, StopIteration, ValueError, GLib.Error) as problem:
            answer = {"failed": f"{type(problem).__name__}: {problem}"}
        sys.stdout.write(json.dumps(answer) + "\n")
        sys.stdout.flush()


if __name__ == "__main__":
    main()
