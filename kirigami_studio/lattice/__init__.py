"""Sheet -> exact geometry of compact reconfigurable parallelogram quad kirigami.

Vocabulary
----------
void (i, j)
    Parallelogram hole, ``i`` counted from the top, ``j`` from the left; corners counter-clockwise
    p0 left, p1 bottom, p2 right, p3 top.  *Even* when ``i + j`` is even, else *odd*.
parity rule
    Eq. 1 of the paper: the angle at p0 is phi in even voids and pi - phi in odd ones (``void_angle`` of
    ``lab.baselines.marching``).
local rule
    Eq. 2 of the paper: the side from p0 to p1 is ratio times the side from p0 to p3, turned by the void's angle; so is
    the side from p3 to p2 (there ``march``, void by void; ``compact`` solves all voids at once).
panel (I, J)
    Rigid tile; an m x n array of voids has (m+1) x (n+1) panels.
hinge node
    A corner that neighbouring panels share.  *Edge node*: a panel corner on the sheet's edge.
ratio
    ``x = |p1 - p0| / |p3 - p0|`` of a void (paper, Sec. 2.1).
sheet
    All that decides where the cuts are: ratios, rim, start outline, cell.
mouth, edge hinge
    Where a cut leaves the sheet; the shared node halfway between two mouths.  The *rim* says where the mouths are.
compact sheet
    The state phi = pi: every void a closed slit, the sheet a plain rectangle with its top left
    corner at (0, 0), x to the right, y up, unless it has another start outline.
phi
    Deployment angle in radians: pi compact, 0 the second compact state.

May import ``foundation`` only; torch only in ``batched``.
"""
