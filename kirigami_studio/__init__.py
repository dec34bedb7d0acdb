"""Kirigami Studio: from a silhouette to a cutter-ready kirigami sheet."""

__version__ = "0.1.0"
