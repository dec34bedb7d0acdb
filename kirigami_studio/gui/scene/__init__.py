"""Geometry + palette -> paint, on any QPainter: the window, the thumbnails and exported pictures draw with this code.

Vocabulary: *world* is the target's frame (area 1, y up); a *frame* maps world to pixels; a *posed design* is a
deployment placed in the world; *missing* is target that the sheet leaves bare, *extra* is sheet beyond the target.
Needs a QGuiApplication but no window.  May import everything of this project but the other rooms of ``gui``
except ``theme``.
"""
