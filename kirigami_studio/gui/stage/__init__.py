"""The chosen design at any angle: the deployment slider, overlays, plots, artwork, and editing by hand."""
