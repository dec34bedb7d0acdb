"""Errors, sentences, units, files and log: what every other package may use.

Vocabulary: a *resource* is a file shipped with the program; a *unit cell* is the edge of one
undeformed panel, the length unit of layouts; millimetres appear first in a cut plan.
Imports nothing else of this project, and of third-party packages at most numpy; scipy in ``shortest_step``.
"""
