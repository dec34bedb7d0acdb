"""Any source (picture, drawing, number table, library name, hand-drawn stroke) -> one Outline.

Vocabulary
----------
outline
    One closed simple polygon, counter-clockwise, y up, area centroid at the origin, area 1.
piece
    A connected filled region of a source; the outline follows the largest one.
island
    A smaller piece that is left out; a note says so.
hole
    A void inside the outline; a kirigami sheet cannot leave one there, so it is filled, and a note says so.
notes
    What was changed between the source and the outline, as sentences for the user.

May import ``foundation`` only; ezdxf only in ``read_dxf``.
"""
