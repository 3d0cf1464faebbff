"""Small classes to grade."""

from __future__ import annotations

from pathlib import Path

import pytest
from small_class import SmallClass


@pytest.fixture(scope="session")
def cache(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Where the solution's recordings are stored, for all classes of this test process."""
    return tmp_path_factory.mktemp("cache")


@pytest.fixture
def small_class(tmp_path: Path, cache: Path) -> SmallClass:
    """A class for this test alone, not graded yet."""
    return SmallClass(tmp_path / "course", cache)


@pytest.fixture(scope="session")
def graded(tmp_path_factory: pytest.TempPathFactory, cache: Path) -> tuple[SmallClass, str]:
    """A class that was graded by an undisturbed run, and what the command printed. Not to be changed."""
    small = SmallClass(tmp_path_factory.mktemp("graded") / "course", cache)
    code, printed = small.grade()
    assert code == 0, printed
    return small, printed
