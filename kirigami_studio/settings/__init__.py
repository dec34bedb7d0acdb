"""Every choice of a user, once: how designs are searched for, and how the chosen one is cut.

A setting is a field with its type, range, unit, default, label and help (``foundation.settings``); requests, project
files, command line, Python API and the forms of the window are made from these fields.  Choices about single cuts stand
in ``fabricate.options``.  May import what the floors below know of shapes, materials, papers and fits; knows neither
documents nor runs.
"""
