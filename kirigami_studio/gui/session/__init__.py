"""The open document and what every place of the window shares: history, job queue, commands, preferences, messages.

A *job* is a generator with a number, a name and a cancel flag; a *report* is a value that it yields.  ``queue`` runs
jobs in one worker thread and hands their reports to the window's thread.  ``session`` applies edits and tells of
changes by typed signals.
"""
