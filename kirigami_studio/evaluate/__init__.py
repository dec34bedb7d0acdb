"""Deployment x Outline -> Score: how well, and how soundly, a design shows its target.

Vocabulary
----------
silhouette
    The filled outline of the sheet at an angle phi: panels plus the voids inside.
similarity
    Translation, rotation and isotropic scale, never a reflection: a sheet cannot be turned over by fitting.
sIoU
    Intersection over union of two 128 x 128 masks under the best similarity (paper, Appendix "Silhouette similarity
    metric"); *exact IoU* is the same number on the polygons themselves, without a raster.
gain
    sIoU minus the sIoU of the uniform layout (all ratios 1), which every score is compared with.
invalid quad
    Panel or void whose four corners collapse or cross.  *Overlap ratio*: share of panel area lost to overlap.
contact
    First angle on the way from the compact sheet at which the outline crosses itself.
trim
    Cutting the edge panels along the target in the deployed state; what stays around hinges is *keep* cells deep.  The
    trimmed IoU is another number than the untrimmed one and never shown as such.
posed design
    The moving sheet in the target's frame; screen, pictures and animation show this one motion.

May import ``lattice``, ``outlines`` and ``foundation``; neither ``generator`` nor ``fabricate``.
"""
