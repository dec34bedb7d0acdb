"""Geometry + palette -> paint, on any QPainter: the window, thumbnails and exported pictures draw with this code.

Vocabulary: *world* is the coordinate system of the target (area 1, y up); a :class:`ViewTransform` maps the world to
pixels; a *posed design* is a deployment placed in the world; *missing* is target area that the sheet leaves bare,
*extra* is sheet area outside the target.  Needs a QGuiApplication but no window.  Imports nothing of ``gui`` but
``look``.
"""
