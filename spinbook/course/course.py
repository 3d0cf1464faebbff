"""course.toml: title, ROS package, order of chapters, versions."""

from __future__ import annotations

import re
import sys
from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from groundwork.problem import Problem
from spinbook.problem import SpinbookError, refuse_errors

if sys.version_info >= (3, 11):
    import tomllib
else:
    import tomli as tomllib

FILE = Path("course.toml")


@dataclass(frozen=True)
class Package:
    """The ROS 2 package that the chapters' nodes make."""

    name: str
    workspace: str = "humanoid_ws"
    version: str = "0.1.0"
    description: str = ""
    maintainer: str = "The authors of the course"
    email: str = "course@example.org"
    license: str = "Apache-2.0"


@dataclass(frozen=True)
class Course:
    """A course. `root` is the folder of course.toml; `chapters` are relative to it, in reading order."""

    root: Path
    title: str
    chapters: tuple[Path, ...]
    package: Package
    repository: str = ""
    ros_distro: str = "jazzy"
    glossary: Path | None = None
    """The file whose headings are the course's terms."""
    site: str = ""
    """Where the website is published; empty if neither course.toml nor the repository says so."""
    run: tuple[Path, ...] | None = None
    """The chapters that `spinbook site` runs; None: all."""

    @property
    def build_folder(self) -> Path:
        """The folder for everything that Spinbook makes."""
        return self.root / "build"

    def is_run(self, chapter: Path) -> bool:
        """Return whether the site runs a chapter: course.toml says so, or somebody has run it before."""
        executed = self.build_folder / "executed" / f"{self.names[chapter]}.ipynb"
        return self.run is None or chapter in self.run or executed.exists()

    @property
    def names(self) -> dict[Path, str]:
        """Each chapter's file -> the name of its notebook and page."""
        return names_of(self.chapters)

    @property
    def exercises(self) -> frozenset[str]:
        """The names of the exercises that exist."""
        folder = self.root / "exercises"
        return frozenset(p.parent.name for p in folder.glob("*/exercise.toml"))


def _wrong(problem: str, fix: str) -> Problem:
    return Problem(FILE, None, problem, fix)


def names_of(chapters: Sequence[Path]) -> dict[Path, str]:
    """Map each file to a unique name: its own, with as many of its folders as that takes."""
    names = {chapter: _name(chapter, 0) for chapter in chapters}
    for folders in range(1, max((len(chapter.parts) for chapter in chapters), default=1)):
        taken = Counter(name.lower() for name in names.values())
        names = {file: _name(file, folders) if taken[name.lower()] > 1 else name for file, name in names.items()}
    taken = Counter(names.values())
    # a-b/c.md and a/b-c.md, or a file with two endings.
    return {
        file: f"{name}-{number}" if taken[name] > 1 else name for number, (file, name) in enumerate(names.items(), 1)
    }


def _name(chapter: Path, folders: int) -> str:
    parts = [*chapter.parent.parts[-folders:], chapter.stem] if folders else [chapter.stem]
    return re.sub(r"[^\w.-]+", "-", "-".join(parts)).strip("-.") or "chapter"


def find_course(start: Path) -> Course:
    """Read the course.toml of this folder or of the nearest one above it. Raises SpinbookError."""
    if folder := course_folder(start):
        return read_course(folder)
    problem = f"there is no course.toml in {start.resolve()} or in any folder above it."
    raise SpinbookError(_wrong(problem, "Go into a course's folder, or name it: spinbook --help"))


def course_folder(start: Path) -> Path | None:
    """Return this folder or the nearest one above it that has a course.toml; None if there is none."""
    folder = start.resolve()
    return next((place for place in (folder, *folder.parents) if (place / FILE).is_file()), None)


def read_course(root: Path) -> Course:
    """Read `root / course.toml`. Raises SpinbookError with every problem in it."""
    try:
        text = (root / FILE).read_text(encoding="utf-8-sig")
    except (OSError, UnicodeDecodeError) as error:
        raise SpinbookError(_wrong(f"it can't be read: {error}.", "Save it as UTF-8.")) from None
    try:
        data = tomllib.loads(text)
    except tomllib.TOMLDecodeError as error:
        at = re.search(r"line (\d+)", str(error))
        line = int(at.group(1)) if at else text.count("\n") + 1
        fix = "Put texts in quotes and lists in square brackets; see docs/writing-chapters.md."
        raise SpinbookError(Problem(FILE, line, f"it is not TOML: {error}.", fix)) from None
    problems: list[Problem] = []
    title = _text(data, "title", problems)
    chapters = data.get("chapters")
    if not isinstance(chapters, list) or not chapters or not all(isinstance(c, str) for c in chapters):
        fix = 'Write for example: chapters = ["chapters/01-start.md"]'
        problems.append(_wrong("`chapters` is not a list of files.", fix))
        chapters = []
    for name in {c for c in chapters if chapters.count(c) > 1}:
        problems.append(_wrong(f"`{name}` is listed twice.", "Remove one of them."))
    for name in chapters:
        if Path(name).is_absolute() or ".." in Path(name).parts:
            problems.append(_wrong(f"`{name}` is outside the course.", "Name files inside the course's folder."))
    run = _chapters_to_run(data, chapters, problems)
    package = _package(data.get("package"), problems)
    refuse_errors(problems)
    assert package is not None
    return Course(
        root=root,
        title=title,
        chapters=tuple(Path(name) for name in chapters),
        package=package,
        repository=str(data.get("repository", "")).rstrip("/"),
        ros_distro=str(data.get("ros_distro", "jazzy")),
        glossary=Path(str(data["glossary"])) if data.get("glossary") else None,
        site=_site(str(data.get("site", "")), str(data.get("repository", ""))),
        run=run,
    )


def _chapters_to_run(data: dict[str, Any], chapters: list[Any], problems: list[Problem]) -> tuple[Path, ...] | None:
    """Return the chapters that the site runs; None if course.toml does not say."""
    run = data.get("run")
    if run is None:
        return None
    if not isinstance(run, list):
        fix = 'Write for example: run = ["chapters/01-start.md"], or leave it out to run all.'
        problems.append(_wrong("`run` is not a list of chapters.", fix))
        return None
    absent = [name for name in run if name not in chapters]
    problems += [_wrong(f"`run` names `{name}`, which is not in `chapters`.", "Correct it.") for name in absent]
    return tuple(Path(str(name)) for name in run)


def _site(given: str, repository: str) -> str:
    """Return the website's address, ending in a slash: as given, or that of the repository's GitHub Pages."""
    if given:
        return given.rstrip("/") + "/"
    match = re.fullmatch(r"https://github\.com/([\w-]+)/([\w.-]+?)(?:\.git)?/?", repository)
    return f"https://{match[1].lower()}.github.io/{match[2]}/" if match else ""


def _text(data: dict[str, Any], key: str, problems: list[Problem]) -> str:
    value = data.get(key)
    if not isinstance(value, str) or not value.strip():
        problems.append(_wrong(f"`{key}` is missing.", f'Write a line such as: {key} = "…"'))
        return ""
    return value


def _package(table: Any, problems: list[Problem]) -> Package | None:
    if not isinstance(table, dict) or not isinstance(table.get("name"), str):
        fix = 'Write: [package]\\nname = "my_robot"'
        problems.append(_wrong("the table `[package]` with a `name` is missing.", fix))
        return None
    name = table["name"]
    # REP 144's rule for package names.
    if not (name[:1].isalpha() and name.isidentifier() and name.islower() and "__" not in name):
        fix = "Use lower-case letters, digits and single underscores, a letter first."
        problems.append(_wrong(f"`{name}` can't be a ROS package's name.", fix))
    if unknown := sorted(set(table) - set(Package.__dataclass_fields__)):
        fix = f"Known are: {', '.join(Package.__dataclass_fields__)}."
        problems.append(_wrong(f"`[package]` has unknown keys: {', '.join(unknown)}.", fix))
        return None
    return Package(**{key: str(value) for key, value in table.items()})
