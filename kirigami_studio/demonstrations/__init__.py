"""The window demonstrated: a whole session without a display, and pictures of every state for people to look at.

Nothing imports this package; it drives the real window as a person would.
"""
