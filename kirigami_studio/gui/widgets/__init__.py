"""Widgets and drawing that belong to no place: canvas, fields, cards, charts, theme, icons, readable numbers.

Vocabulary of drawing: *world* is the coordinate system of the target (area 1, y up); a :class:`ViewTransform` maps the
world to pixels; *missing* is target area that the sheet leaves bare, *extra* is sheet area outside the target.
"""
