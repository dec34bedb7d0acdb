"""Panels on elastic ligaments, as cut: what resists, what stretches, where the sheet jams.

Vocabulary
----------
panel
    A rigid part of the sheet, with a displacement and a turn.
ligament
    An elastic joint of two panels: a slender strip, or a T-junction, which is a rotation centre with a stiffness.
contact
    A void angle, which resists when it is nearly closed.
network
    Panels, ligaments and contacts in mm and N.
motion
    u_x, u_y and theta of every panel, (P, 3), from where it is at rest.
drive
    What is held or moved, step by step.
reaction
    What it takes to hold or move it: the energy's gradient at the driven degrees of freedom.
snap
    A jump from one equilibrium to another, where the least eigenvalue of the free Hessian has reached zero.

Not modelled: friction, plastic set and motion out of the plane.

May import ``lattice`` and ``foundation``.
"""
