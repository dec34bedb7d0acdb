"""Demonstrations of the window: a whole session without a display, and screenshots of every state for review.

Nothing imports this package; it drives the real window as a user would.
"""
