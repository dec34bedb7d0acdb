"""The studio window: document -> what a person sees; gesture -> edit.

Vocabulary: a *view* draws and reports gestures; a *panel* groups controls; the *stage* holds the one design that is
shown large; a *job* is long work beside the window; a *palette* is a set of colours by role.

Nothing here is imported by any other room except the command line's door, :func:`kirigami_studio.gui.application.run`.
May import everything but ``training`` and ``benchmark``; torch is never loaded before the window is shown.
"""
