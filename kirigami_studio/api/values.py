"""Values that are read only, functions of several angles, and optional packages."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import FrozenInstanceError
from difflib import get_close_matches
from importlib import import_module
from typing import Any, TypeVar

import numpy as np
import numpy.typing as npt

from kirigami_studio.foundation.arrays import FloatArray
from kirigami_studio.foundation.errors import UsageError
from kirigami_studio.lattice.deployment import check_phi

Value = TypeVar("Value")


def read_only(kind: type[Value]) -> type[Value]:
    """Make a frozen dataclass with slots refuse assignments and misspelt names in plain words.

    Its own ``__setattr__`` refers to the class as it was before it got slots, and fails on a misspelt name with a
    TypeError about ``super()``.  Names that begin with an underscore, which notebooks ask for, get no suggestion.
    """

    def missing(self: object, name: str) -> Any:
        if hasattr(type(self), name):  # a property of its own has failed
            return object.__getattribute__(self, name)
        public = [] if name.startswith("_") else [one for one in dir(self) if not one.startswith("_")]
        near = get_close_matches(name, public, 1)
        meant = f". Did you mean: {near[0]!r}?" if near else ""
        raise AttributeError(f"{type(self).__name__!r} object has no attribute {name!r}{meant}")

    def refuse(self: object, name: str, value: object = None) -> None:
        if not hasattr(type(self), name):
            missing(self, name)
        raise FrozenInstanceError(f"cannot assign to field {name!r}")

    for method, does in (("__setattr__", refuse), ("__delattr__", refuse), ("__getattr__", missing)):
        setattr(kind, method, does)
    return kind


def at_angles(function: Callable[[float], Any], phi: npt.ArrayLike) -> Any:
    """Values of a function of the angle, stacked for an array of angles (radians).

    Returns
    -------
    value or array
        That of one angle as it is; for angles of shape S an array of shape S + that of a value.

    Raises
    ------
    AngleError
        Something else than numbers from 0 to pi.
    """
    angles = np.asarray(phi)
    if not angles.ndim:
        return function(phi)  # type: ignore[arg-type]  # refused there unless it is a number
    found: list[FloatArray] = [np.asarray(function(check_phi(angle))) for angle in angles.ravel()]
    shape = found[0].shape if found else ()
    return np.array(found, dtype=np.float64).reshape(*angles.shape, *shape)


def optional_package(name: str, extra: str) -> Any:
    """Import a package that only an extra brings.

    Raises
    ------
    UsageError
        It is not installed.
    """
    try:
        return import_module(name)
    except ImportError as error:
        raise UsageError("api.package_missing", package=name.partition(".")[0], extra=extra) from error
