"""Connects the panels of the window with its controller: gestures in one direction, changes to show in the other.

One module for each concern: the whole window, the target, the designs with their gallery, the stage with hand editing.
The controller changes the document; nothing here does.
"""
