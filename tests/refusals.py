"""Refusals are told apart by their code and values, not by the words of a sentence."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from typing import TypeVar

import pytest

from kirigami_studio.foundation.errors import KirigamiError

Refusal = TypeVar("Refusal", bound=KirigamiError)


@contextmanager
def refused(kind: type[Refusal], code: str, /, **fields: object) -> Iterator[pytest.ExceptionInfo[Refusal]]:
    """Expect an error of a kind with this code, and these values among those that its sentence names."""
    with pytest.raises(kind) as caught:
        yield caught
    error = caught.value
    assert error.code == code, f"{error.code}: {error}"
    assert {name: error.fields.get(name) for name in fields} == fields
    assert str(error) != code  # it has a sentence
