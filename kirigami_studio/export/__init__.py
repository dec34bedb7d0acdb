"""CutPlan or Deployment -> verified files: DXF, SVG and PDF in true millimetres, PNG and GIF to look at.

Vocabulary
----------
exporter
    What writes one kind of file; chosen by extension through ``registry``.
profile
    How a machine's program wants layers coloured.
verified
    Written beside the goal, read back, compared with what was meant, and only then renamed into place.

May import ``fabricate``, ``evaluate``, ``lattice``, ``outlines`` and ``foundation``; ezdxf only in the ``dxf`` modules.
"""
