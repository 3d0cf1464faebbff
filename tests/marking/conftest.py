"""Small classes to grade."""

from __future__ import annotations

from pathlib import Path

import pytest
from small_class import SmallClass


@pytest.fixture(scope="session")
def cache(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Where the solution's recordings are kept, for all classes of this test process."""
    return tmp_path_factory.mktemp("cache")


@pytest.fixture
def small_class(tmp_path: Path, cache: Path) -> SmallClass:
    """A class of the test's own, not graded yet."""
    return SmallClass(tmp_path / "course", cache)
