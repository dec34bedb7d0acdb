"""Ground floor: the errors, units, bundled files and log that every other room may use.

Vocabulary: a *resource* is a file shipped with the program; a *unit cell* is the edge of one
undeformed panel, the length unit of layouts; millimetres appear first in a cut plan.
Imports nothing of this project and of the outside world numpy at most.
"""
