"""Errors, units, log and bundled files."""

from __future__ import annotations

import inspect
import logging
import shutil
from collections.abc import Iterator
from pathlib import Path

import pytest

from kirigami_studio.foundation import errors, resources
from kirigami_studio.foundation.errors import KirigamiError, UsageError
from kirigami_studio.foundation.log import topic
from kirigami_studio.foundation.resources import resource, resource_root
from kirigami_studio.foundation.units import MM_PER_INCH


def test_that_every_error_is_one_that_a_host_can_show() -> None:
    found = inspect.getmembers(errors, inspect.isclass)
    classes = [entry for _, entry in found if entry.__module__ == errors.__name__]
    assert len(classes) >= 10
    assert all(issubclass(entry, KirigamiError) and entry.__doc__ for entry in classes)


def test_that_impossible_numbers_count_as_wrong_usage_and_bad_files_do_not() -> None:
    assert issubclass(errors.GridError, UsageError) and issubclass(errors.AngleError, UsageError)
    assert not issubclass(errors.RatioError, UsageError) and not issubclass(errors.ProjectError, UsageError)


def test_that_an_inch_is_the_international_one() -> None:
    assert MM_PER_INCH == 25.4


def test_that_a_room_logs_under_its_own_name() -> None:
    assert topic("export") is logging.getLogger("kirigami_studio.export")


def test_that_bundled_files_are_found_in_this_installation() -> None:
    assert resource("silhouettes").is_dir()
    assert resource("silhouettes").parent == resource_root()


@pytest.fixture
def elsewhere(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[Path]:
    """The module as if the package lay in ``tmp_path``/site."""
    package = tmp_path / "site" / "kirigami_studio"
    (package / "foundation").mkdir(parents=True)
    monkeypatch.setattr(resources, "__file__", str(package / "foundation" / "resources.py"))
    resource_root.cache_clear()
    yield package
    resource_root.cache_clear()


def test_that_a_wheel_prefers_the_files_it_carries(elsewhere: Path) -> None:
    (elsewhere.parent / "resources" / "silhouettes").mkdir(parents=True)
    (elsewhere / "resources" / "silhouettes").mkdir(parents=True)
    assert resource_root() == elsewhere / "resources"
    shutil.rmtree(elsewhere / "resources")
    resource_root.cache_clear()
    assert resource_root() == elsewhere.parent / "resources"


def test_that_an_incomplete_installation_says_so(elsewhere: Path) -> None:
    with pytest.raises(FileNotFoundError, match="install Kirigami Studio again"):
        resource_root()
