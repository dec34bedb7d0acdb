"""The Python API: targets, sheets, designs, cuts and simulations, for notebooks and scripts.

Its names are those of ``import kirigami_studio as ks``, which loads these modules when a name is first asked for;
``docs/python-api.md`` lists them.

- A *target* is a silhouette; a *sheet* is one table of ratios at every angle; a *design* is a sheet with the target
  that it is for, its score and its place over it; *designs* are all those of a project.
- *Cuts* are a design's in a material, width and connector style; a *simulation* is that sheet closed on its connectors.

The values wrap those of the packages below and add pictures for notebooks and short texts; the work is done there, by
:mod:`kirigami_studio.studio` above all.  Angles are radians, lengths unit cells unless a name ends with ``_mm``.
Nothing here knows window or command line.
"""
