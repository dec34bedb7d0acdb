"""The target: drawn on the board, read from a file or a picture, chosen part by part, measured in mm.

A tool follows the pointer and the keys, paints what it is about to do, and hands over one :class:`Change` when the
gesture is complete.  Tools know the drawing board in mm (``target.placed``) and no document.
"""
