"""Cuts as the window's middle plans them: fabrication settings, plans and exports, own materials."""
