"""The errors a person may read.  Each message is one clear sentence: what, where, what to try."""

from __future__ import annotations


class KirigamiError(Exception):
    """Root of every error this program raises on purpose; ``str(error)`` is shown to the user."""


class UsageError(KirigamiError):
    """The request itself makes no sense (wrong option, impossible number): exit code 2."""


class RatioError(KirigamiError):
    """A ratio field has the wrong shape or holds values that are not finite and positive."""


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


class ExportError(KirigamiError):
    """A file could not be written, or did not pass its own re-reading."""


class ProjectError(KirigamiError):
    """A project file is damaged, of a newer version, or not a project at all."""


class Cancelled(KirigamiError):  # noqa: N818  (an outcome, not a fault)
    """The user asked to stop; nothing was changed."""
