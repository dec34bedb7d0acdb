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
seat
    The frame of one T-junction: the through cut's direction, the slit's slant, and the gap between them.
centre
    Where a connector turns: the middle of its neck.  A *centred* connector has it on its node, or where all centres
    moved together so that every void stays a parallelogram.
turn, bow
    The last part of a slit that arrives square to what it rests on, and the arc on which a through cut (or the
    outline) goes around a centred connector.
ending
    The shape that a slit ends in: nothing (straight), a relief hole, an arc around the junction, or a bar along the
    through cut.
joint
    A place where cuts meet on purpose: a slit and its ending, or two slits whose connector was removed.
tab
    A place where the outline is not cut, so that the sheet stays held.
ligament
    Material left between two cuts; its *finished* width is measured after the kerf has burned away.
kerf
    Full width of the cut.  Paths are centre lines of the beam.
overcut
    How far an edge cut runs over the sheet's outline, so that its mouth is open.
engraving
    The name of a design in single strokes on one panel; no cut, so that nothing that is told of cuts counts it.
note, problem
    What the user should know about a plan: a code with values; a problem also has a weight and a place.

May import ``lattice`` and ``foundation``.
"""
