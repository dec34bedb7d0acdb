"""The designs of the open project: how they are made, chosen, changed and read; nothing here draws.

``generation`` plans and runs the generator, ``hand_editor`` (with ``outline_drag``) changes the chosen design by hand,
``chosen_design`` trims and fits it, ``collection`` pins, rejects and brings back, ``gallery_selection`` sorts and
filters the gallery, ``curves`` reads a design at every angle.  Every part gets the session, applies edits through it,
and may import ``gui.session``, ``gui.jobs`` and what lies below them.
"""
