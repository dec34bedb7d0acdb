"""Errors for the user: a code, the values that belong to it, and one clear sentence.

``raise TargetError("outline.too_few_points", count=2)`` says what happened; the sentence stands once, in
:mod:`kirigami_studio.foundation.sentences`, and is made in the user's language only when somebody reads it.
"""

from __future__ import annotations

from collections.abc import Mapping

from kirigami_studio.foundation.sentences import sentence


class KirigamiError(Exception):
    """Root of all errors raised on purpose; ``str(error)`` is the sentence for the user.

    Attributes
    ----------
    code : str
        Names the problem, ``topic.what``; stable, so that programs and tests can tell problems apart.
    fields : mapping of str to object
        The values that the sentence names.
    """

    def __init__(self, code: str, /, **fields: object) -> None:
        super().__init__(code)
        self.code = code
        self.fields: Mapping[str, object] = fields

    def __str__(self) -> str:
        return sentence(self.code, self.fields)

    def __reduce__(self) -> tuple[object, ...]:
        return _remade, (type(self), self.code, dict(self.fields))


def _remade(kind: type[KirigamiError], code: str, fields: Mapping[str, object]) -> KirigamiError:
    """An error that came out of a pickle: worker processes send theirs to the run."""
    return kind(code, **fields)


def text_of(error: BaseException) -> str:
    """Return the text of any error, or the name of its class."""
    try:
        return str(error) or type(error).__name__
    except Exception:
        return type(error).__name__


class UsageError(KirigamiError):
    """The request itself makes no sense (wrong option, impossible number): exit code 2."""


class RatioError(KirigamiError):
    """A ratio field has the wrong shape or holds values that are not finite and positive."""


class SheetError(KirigamiError):
    """A rim or a start outline does not make a sheet."""


class AngleError(UsageError):
    """A deployment angle lies outside the range that the operation accepts."""


class GridError(UsageError):
    """A grid is smaller than 2 x 2, larger than 64 x 64, or not two whole numbers."""


class TargetError(KirigamiError):
    """A target silhouette cannot be read or is not one closed, simple shape."""


class ModelError(KirigamiError):
    """Generator weights are missing, damaged or made for another network."""


class FabricationError(KirigamiError):
    """A cut plan cannot be made with the requested widths, size or material."""


class MechanicsError(KirigamiError):
    """A network of panels that makes no sense, or one without an equilibrium."""


class ExportError(KirigamiError):
    """A file could not be written, or did not pass its own re-reading."""


class ProjectError(KirigamiError):
    """A project file is damaged, of a newer version, or not a project at all."""


class Cancelled(KirigamiError):  # noqa: N818  (an outcome, not a fault)
    """The user asked to stop; nothing was changed."""
