"""Long work beside the window: one worker thread runs generators, and the window takes what they report.

A *job* is a generator with a number, a name and a cancel flag; a *report* is what it yields.  :mod:`queue` runs jobs;
the other modules hold the generators by topic.  They know no widgets.  Packages that are slow to import (torch,
scikit-image, ezdxf) are imported inside the functions: the first import then happens in the worker, after the window
is shown.
"""
