"""Deployment + material -> CutPlan in millimetres: what the beam or blade has to follow, in which order.

Vocabulary
----------
slit
    The straight cut of one void in the compact sheet (phi = pi).
edge cut
    A cut from the sheet's edge to the middle of a slit; it separates two edge panels.
T-junction
    Where a cut ends on the middle of another cut (the *through* cut) or on the sheet's edge.  Cuts stop short of it;
    what remains is the *connector* (the hinge of the finished sheet).
ligament
    Material left between two cuts; its *finished* width is measured after the kerf has burned away.
kerf
    Full width of the cut.  Paths are centre lines of the beam.
overcut
    How far an edge cut runs over the sheet's outline, so that its mouth is open.

May import ``lattice`` and ``foundation``.
"""
