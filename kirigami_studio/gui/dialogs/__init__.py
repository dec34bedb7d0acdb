"""Dialogs: files, the silhouette library, materials, the export report, the history, help."""
