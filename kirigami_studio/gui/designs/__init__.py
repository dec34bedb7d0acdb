"""The designs as the window's middle knows them: one concern each, which proposes edits and never draws.

``one_design`` is the base of what works on the chosen design in the worker; ``design_cache`` keeps decoded motions.
"""
