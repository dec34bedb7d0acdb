"""Sentences of the command line, by the code of the problem."""

from __future__ import annotations

SENTENCES: dict[str, str | tuple[str, str]] = {}
