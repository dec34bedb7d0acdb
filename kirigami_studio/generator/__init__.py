"""Target outline -> ratio fields, by conditional flow matching (paper, Sec. 2.3): inference only.

Vocabulary
----------
z
    ``log10`` of a ratio field, the variable that flows.
condition
    What the network knows of the target: contour points, radial extent and phi, in a normalised pose.
Euler steps
    How many times the velocity field is evaluated between noise (t = 0) and design (t = 1).
variant
    One bundled set of weights, e.g. ``prior``.

May import ``lattice``, ``outlines`` and ``foundation``; torch is welcome here.
"""
