"""One small course, run and built once; tests that change it take a copy."""

from __future__ import annotations

import shutil
from collections.abc import Iterator
from pathlib import Path

import pytest
from small_course import SmallCourse, served, write_course


@pytest.fixture(scope="session")
def built(tmp_path_factory: pytest.TempPathFactory) -> SmallCourse:
    """The course with its site, as it was first built: nobody changes it."""
    course = write_course(tmp_path_factory.mktemp("site") / "course")
    said = course.spinbook_site()
    assert said.returncode == 0, said.stdout + said.stderr
    return course


@pytest.fixture(scope="session")
def address(built: SmallCourse) -> Iterator[str]:
    """Where the site is served."""
    with served(built.site) as url:
        yield url


@pytest.fixture
def course(built: SmallCourse, tmp_path: Path) -> SmallCourse:
    """A built course to change."""
    shutil.copytree(built.root, tmp_path / "course")
    return SmallCourse(tmp_path / "course")
