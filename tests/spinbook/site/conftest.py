"""One small course, run and built once; tests that change it take a copy."""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

import pytest
from course_folder import CourseFolder
from playwright.sync_api import Browser, BrowserContext
from program_chapters import LONGER, PIECES, TERMINALS
from small_course import ROOT, SmallCourse, served, write_course


@pytest.fixture(scope="session")
def built(tmp_path_factory: pytest.TempPathFactory) -> SmallCourse:
    """The course with its site, as it was first built: no test changes it."""
    course = write_course(tmp_path_factory.mktemp("site") / "course")
    said = course.spinbook_site()
    assert said.returncode == 0, said.stdout + said.stderr
    return course


@pytest.fixture(scope="session")
def address(built: SmallCourse) -> Iterator[str]:
    """Where the site is served."""
    with served(built.site) as url:
        yield url


@pytest.fixture(scope="session")
def programs(tmp_path_factory: pytest.TempPathFactory) -> Iterator[str]:
    """Where a site of three chapters is served. Nothing ran when it was made: tests run it."""
    folder = CourseFolder(tmp_path_factory.mktemp("programs")).write(longer=LONGER, pieces=PIECES, terminals=TERMINALS)
    settings = folder.root / "course.toml"
    settings.write_text(f"run = []\n{settings.read_text()}")
    made = folder.spinbook("site")
    assert made.returncode == 0, made.stdout + made.stderr
    with served(folder.root / "build" / "site") as url:
        yield url


@pytest.fixture(scope="session")
def reader(browser: Browser) -> Iterator[BrowserContext]:
    """A browser in which somebody has run a node before: Pyodide starts in a quarter of the time."""
    context = browser.new_context()
    yield context
    context.close()


@pytest.fixture(scope="session")
def real_course(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The build folder of the real course, built and run in a folder of its own. SPINBOOK_BUILT names one that is."""
    if built := os.environ.get("SPINBOOK_BUILT"):
        return Path(built)
    folder = tmp_path_factory.mktemp("course")
    shutil.copy(ROOT / "course.toml", folder)
    for name in ("chapters", "exercises", "solutions", "interfaces"):
        if (ROOT / name).is_dir():
            shutil.copytree(ROOT / name, folder / name)
    command = [sys.executable, "-m", "spinbook", "site"]
    done = subprocess.run(command, cwd=folder, capture_output=True, text=True, timeout=1500, check=False)
    assert done.returncode == 0, done.stdout + done.stderr
    return folder / "build"


@pytest.fixture
def course(built: SmallCourse, tmp_path: Path) -> SmallCourse:
    """A built course to change."""
    shutil.copytree(built.root, tmp_path / "course")
    return SmallCourse(tmp_path / "course")
