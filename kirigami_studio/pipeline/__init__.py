"""Outline + wishes -> ranked, scored candidates: the only package that composes the stages.

Vocabulary: a *request* is everything that decides the result; *events* report the way there; a *result* holds the
candidates best first.  Knows neither Qt nor files on disk.  May import ``polish``, ``export`` and all below them.
"""
