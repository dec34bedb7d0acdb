"""The use cases, each once and without Qt: what the window, the command line and the Python API have in common.

``targets`` and ``parts`` read a target, ``designing`` samples, fits and ranks, ``making`` plans, closes, judges, writes
and verifies, ``projects`` loads and saves, ``two_states`` says from what into what a design opens, ``file_kinds`` lists
what can be written.  What they find out: ``cutting`` plans, ``as_cut`` estimates and simulates, ``verdict`` judges,
``fixes`` tries changes.  A long use case is a generator: its *steps* report
values and look at a *cancel* flag (:mod:`kirigami_studio.foundation.steps`).  Packages that are slow to import (torch,
scikit-image, ezdxf) are imported inside functions: the first import then happens in a worker, after the window is
shown.  Imports ``project``, ``pipeline`` and what lies below them.
"""
