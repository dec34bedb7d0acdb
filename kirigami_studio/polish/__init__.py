"""A good guess -> the best match the sheet can make: second-order fits on the exact geometry.

The one stage that sees the lattice and the evaluator together.

Vocabulary: the *objective* is a sum of squared distances between outline and target, both ways; a *pose* is the
similarity transform that carries the layout to the target and is fitted along with the ratios; a *route* is a row of
easier shapes that a search fits on its way to the target; a sheet is *lifted* when it is carried to another grid; a
*phase* is what counts for some steps of a fit; *even panels* are those of the uniform sheet, which a term pulls
towards; the *transport map* pulls panels to where the optimal transport map has them in the target; a *cover* is a fit
that may stick out of the target because it will be trimmed.

May import ``evaluate``, ``lattice``, ``outlines`` and ``foundation``.
"""
