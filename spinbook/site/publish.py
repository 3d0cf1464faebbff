"""Stages, checks and publishes the site: only what may be published, and nothing that students must not see."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from pathlib import Path

from grader.exercise.exercise import Exercise, ExerciseError
from grader.exercise.loading import load
from grader.files import write_if_changed
from spinbook.course.course import Course
from spinbook.handout.leaks import leaks, secrets_of_all
from spinbook.problem import Problem, SpinbookError
from spinbook.site.contents import Contents
from spinbook.site.page import FRAME_SUFFIX, HOME

#: What is taken from Sphinx's output.
_IMAGES = "_images"
_OURS = ("early.js", "site.js", "run.js", "search.js", "site.css", "print.css", "icon.svg", "search-data.js")


def publish(html: Path, pages: Iterable[str], files: Mapping[str, str | bytes], site: Path) -> int:
    """Make `site` hold these `pages` of `html` and these `files`: path -> content. Returns how many files it holds."""
    wanted = {Path(f"{page}.html"): (html / f"{page}.html").read_bytes() for page in pages}
    used = b"\n".join(wanted.values())
    for image in (html / _IMAGES).glob("*"):
        # Sphinx keeps pictures of earlier builds.
        if image.name.encode() in used:
            wanted[image.relative_to(html)] = image.read_bytes()
    for name in _OURS:
        wanted[Path("_static", name)] = (html / "_static" / name).read_bytes()
    for path, content in files.items():
        wanted[Path(path)] = content.encode("utf-8") if isinstance(content, str) else content
    # Pages of GitHub would leave out folders that begin with an underscore.
    wanted[Path(".nojekyll")] = b""
    for relative, data in wanted.items():
        write_if_changed(site / relative, data)
    _remove_others(site, set(wanted))
    return len(wanted)


def _remove_others(site: Path, wanted: set[Path]) -> None:
    for file in sorted(site.rglob("*"), reverse=True):
        if file.is_file() and file.relative_to(site) not in wanted:
            file.unlink()
        elif file.is_dir() and not any(file.iterdir()):
            file.rmdir()


def stage(contents: Contents, folder: Path) -> None:
    """Make `folder` hold the pages, and nothing else. Files that are as they should be keep their times."""
    wanted: dict[Path, str | bytes] = {folder / path: data for path, data in contents.pictures.items()}
    for page in contents.pages:
        wanted[folder / f"{page.name}{page.suffix}"] = page.text + (_table_of(contents) if page.name == HOME else "")
        wanted[folder / f"{page.name}{FRAME_SUFFIX}"] = page.frame(contents.openers)
    for file, content in wanted.items():
        write_if_changed(file, content)
    for file in folder.rglob("*"):
        if file.is_file() and file not in wanted:
            file.unlink()


def _table_of(contents: Contents) -> str:
    """Sphinx learns the order of the pages from it; the theme shows it its own way."""
    pages = "\n".join(page.name for page in contents.pages if page.name != HOME)
    return f"\n```{{toctree}}\n:hidden:\n\n{pages}\n```\n"


_FIX = (
    "Students must not see it. Take it out of the chapter, the task or the public checks. A line of the solution that "
    "they may see belongs before # BEGIN SOLUTION."
)


def prove_nothing_leaks(course: Course, contents: Contents) -> None:
    """Raise SpinbookError if a solution, a hidden check or a scenario of any exercise is in what is to be published.

    The pages are looked at before Sphinx gets them: in HTML every line of code is full of marks.
    """
    exercises = [_load(course, name) for name in sorted(course.exercises)]
    taught = "\n".join(contents.taught)
    known, names = secrets_of_all(exercises, taught)
    found: dict[Path, str] = {}
    for file, what in leaks(_published(contents), known + names):
        page = file.removesuffix(".frame").partition(".")[0]
        found.setdefault(contents.origins.get(page, Path("build", file)), what)
    if found:
        text = (Problem(file, None, f"{what} would be published.", _FIX) for file, what in found.items())
        raise SpinbookError(*text)


def _load(course: Course, name: str) -> Exercise:
    try:
        return load(course.root / "exercises" / name)
    except ExerciseError as error:
        raise SpinbookError(error.problem) from None


def _published(contents: Contents) -> dict[str, bytes]:
    files: dict[str, str | bytes] = {f"{page.name}{page.suffix}": page.text for page in contents.pages}
    files |= {f"{page.name}.frame": page.frame(contents.openers) for page in contents.pages}
    files |= {f"site/{path}": content for path, content in contents.files.items()}
    files |= {f"launch/{path}": content for path, content in contents.branch.items()}
    # Packed, nothing could be found in them.
    files |= {f"launch/{path}": content for path, content in contents.copies.items()}
    return {path: content.encode() if isinstance(content, str) else content for path, content in files.items()}
