"""What is saved and undone: gesture -> named edit -> new document; document <-> ``.kiri`` file.

Vocabulary
----------
document
    The frozen value of everything the user made: target, settings, candidates, the chosen one, fabrication.
edit
    A document with the label of what led to it, as the Undo menu shows it.
history
    The documents before and after the present one; a *drag* is a run of edits that undoes as one.
project file
    A zip with a manifest, the document as JSON and all ratios as one array; a *migration* lifts an older version.

May import ``evaluate``, ``fabricate``, ``lattice``, ``outlines`` and ``foundation``, not ``pipeline``.
"""
