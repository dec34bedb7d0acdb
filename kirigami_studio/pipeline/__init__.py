"""Request -> ranked, scored candidates: the only package that composes the stages.

Vocabulary: a *request* is the target outline and all else that decides the result; *events* report the way there; a
*result* holds the candidates best first; the *worth* of a candidate, which ranks it, is its match less prices for what
eyes and cutters mind; a *redesign* makes another candidate of one.  Knows neither Qt nor files on
disk.  May import ``polish``, ``export`` and all below them.
"""
