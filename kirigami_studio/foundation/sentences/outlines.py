"""Sentences of ``outlines``, by the code of the problem."""

from __future__ import annotations

SENTENCES: dict[str, str | tuple[str, str]] = {}
