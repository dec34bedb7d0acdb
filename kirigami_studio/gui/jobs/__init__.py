"""Long work beside the window: one worker thread that steps Qt-free generators and reports what they yield.

Vocabulary: a *job* is a generator with a number, a name and a cancel flag; the *board* lives in the window's thread,
starts jobs and hands their reports to whoever asked.
"""
