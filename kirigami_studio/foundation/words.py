"""What the program says, in the language of the person who uses it.

Sentences are written in English where they are used, ``tr("Reading {name} …", name=name)``; a catalogue in the format
of GNU gettext, ``locale/LANGUAGE/LC_MESSAGES/kirigami_studio.mo``, may hold them in another language.  The language is
chosen once, when the first sentence is asked for: by ``LANGUAGE``, ``LC_ALL``, ``LC_MESSAGES`` or ``LANG``.
"""

from __future__ import annotations

import gettext
import os
from functools import cache
from pathlib import Path

DOMAIN = "kirigami_studio"
#: A folder of catalogues that is looked into before the bundled one.
FOLDER_VARIABLE = "KIRIGAMI_STUDIO_LOCALE"


def mark(text: str, /) -> str:
    """Mark a sentence for the catalogue that is translated later, when it is read."""
    return text


def tr(text: str, /, **values: object) -> str:
    """Return a sentence in the user's language.

    Parameters
    ----------
    text : str
        English, a literal, so that it can be collected; ``{name}`` marks where a value goes.
    **values
        What goes there; a format such as ``{share:.1f}`` may be part of the text.  Without values the text is taken as
        it is, braces and all.
    """
    found = _catalogue().gettext(text) if text else ""
    return found.format(**values) if values else found


def tr_n(one: str, many: str, count: int, /, **values: object) -> str:
    """Return a sentence about ``count`` things, which both texts may name as ``{count}``."""
    return _catalogue().ngettext(one, many, count).format(count=count, **values)


@cache
def _catalogue() -> gettext.NullTranslations:
    from kirigami_studio.foundation.resources import resource  # its errors are sentences too

    own = os.environ.get(FOLDER_VARIABLE)
    for folder in (Path(own) if own else None, resource("locale")):
        if folder is not None and gettext.find(DOMAIN, folder):
            return gettext.translation(DOMAIN, folder)
    return gettext.NullTranslations()
