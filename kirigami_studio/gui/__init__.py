"""The studio window: document -> what the user sees; gesture -> edit.

Vocabulary: a *view* draws and reports gestures; a *panel* groups controls; the *stage* holds the one design that is
shown large; a *job* is long work in a thread of its own; a *palette* is a set of colours by role.

No other package imports anything here, except the command line, which calls
:func:`kirigami_studio.gui.window.application.run`.
May import everything but ``training`` and ``benchmark``; torch is never loaded before the window is shown.
"""
