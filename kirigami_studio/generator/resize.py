"""Carry fields from the network's grid to any other grid: the lattice's own rule."""

from kirigami_studio.lattice.resize import resize_fields

__all__ = ["resize_fields"]
