"""Canvases and lists: they draw what they are shown and report gestures as signals; they never change the document."""
