"""What connects the panels of the window with its controller: gestures one way, changes to show the other.

One module for each concern: the whole window, the target, the designs with their gallery, the stage with hand editing.
The controller changes the document; nothing here does.
"""
