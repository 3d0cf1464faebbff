"""The home page, and the page that says what the course was built with."""

from __future__ import annotations

import datetime
import os
import platform
import re
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from html import escape
from typing import Any

from grader.exercise.exercise import Exercise
from groundwork.installed import version_of
from spinbook import __version__
from spinbook.build.digest import digest
from spinbook.chapter.chapter import Chapter, ChapterCell
from spinbook.course.course import Course
from spinbook.site.chapter_page import ExecutedNotebook, alternative, is_picture, wrong_cells
from spinbook.site.drawings import PICTURE_FOLDER, Picture, drawing_html, still_of
from spinbook.site.minutes import chapter_facts
from spinbook.site.page import Repository, chapter_page, exercise_page
from spinbook.site.robots import is_robot, robot_html

_SIZE = re.compile(r'\b(width|height)="([\d.]+)(?:px|pt)?"')
#: The range of a plot's curve, in its description.
_RANGE = re.compile(r"(\S+) … (\S+)")
#: A wider picture would be too small to read next to a chapter's title.
_WIDEST = 600


@dataclass(frozen=True)
class HomePicture:
    """A picture at the top of a page: its files, path -> content, and the values for the theme."""

    files: dict[str, bytes]
    about: dict[str, Any]


def home_chapters(
    runs: list[tuple[Chapter, ExecutedNotebook]], exercises: Mapping[str, Exercise]
) -> list[dict[str, Any]]:
    """Return the chapters with their exercises, and whether they ran well, for the list on the home page."""
    return [
        {
            "title": chapter.title,
            "page": chapter_page(chapter.name),
            "summary": chapter.summary,
            "facts": chapter_facts(chapter),
            "errors": len(wrong_cells(chapter, ran)),
            "exercises": [
                {"title": exercise.title, "page": exercise_page(exercise.name), "points": f"{exercise.points:g}"}
                for exercise in (exercises[cell.name or ""] for cell in chapter.exercises)
            ],
        }
        for chapter, ran in runs
    ]


def home_drawing(drawings: Mapping[str, Picture | None]) -> str:
    """Return the first drawing of the course that could be drawn, as HTML; "" if there is none."""
    return next((drawing_html(code, picture, "") for code, picture in drawings.items() if picture), "")


def home_pictures(runs: list[tuple[Chapter, ExecutedNotebook]]) -> list[HomePicture]:
    """Return the plot of the most curves that move and the last trail of a turtle, if the chapters have them."""
    drawings = [(chapter, cell, output) for chapter, ran in runs for cell, output in _pictures(chapter, ran)]
    described = [(alternative(drawn[2], drawn[1]), drawn) for drawn in drawings]
    plots = [(_moving_curves(words), drawn) for words, drawn in described if "samples" in words]
    turtles = [drawn for words, drawn in described if "turtlesim" in words.lower()]
    turtles = [drawn for drawn in turtles if still_of(drawn[2])] or turtles
    best = [max(plots, key=lambda plot: plot[0])[1]] if plots else []
    return [
        *(_shown(*drawn, "What a topic carried, as it arrived") for drawn in best),
        *(_shown(*drawn, "A turtle, driven by a node") for drawn in turtles[-1:]),
    ]


def home_robot(runs: list[tuple[Chapter, ExecutedNotebook]]) -> str:
    """Return the first robot that moves in a chapter, as HTML; "" if there is none."""
    for chapter, ran in runs:
        for robot in _robots(chapter, ran):
            page = f'<a href="{chapter_page(chapter.name)}.html">{escape(chapter.title)}</a>'
            return robot_html(robot, "", f"A robot, moved by a node. From {page}.")
    return ""


def chapter_opening(chapter: Chapter, ran: ExecutedNotebook) -> HomePicture | None:
    """Return what moves at the top of a chapter's page: its first robot, otherwise its last moving picture that is not
    wide, such as a timeline."""
    for robot in _robots(chapter, ran):
        return HomePicture({}, {"robot": robot_html(robot, "../", "A robot, moved by a node of this chapter.")})
    moving = [drawn for drawn in _pictures(chapter, ran) if still_of(drawn[1])]
    shown = [_shown(chapter, *drawn, "From this chapter, as it was recorded") for drawn in moving]
    narrow = [picture for picture in shown if picture.about.get("width", 0) <= _WIDEST]
    return next(reversed(narrow or shown), None)


def _moving_curves(words: str) -> int:
    return sum(low != high for low, high in _RANGE.findall(words))


def _robots(chapter: Chapter, ran: ExecutedNotebook) -> Iterator[dict[str, Any]]:
    return (output for cell in chapter.cells for output in filter(is_robot, ran.outputs(cell.id)))


def _pictures(chapter: Chapter, ran: ExecutedNotebook) -> Iterator[tuple[ChapterCell, dict[str, Any]]]:
    """Yield the SVGs, which all pictures of Spinbook's are."""
    outputs = ((cell, output) for cell in chapter.cells for output in filter(is_picture, ran.outputs(cell.id)))
    return ((cell, output) for cell, output in outputs if "image/svg+xml" in output["data"])


def _shown(chapter: Chapter, cell: ChapterCell, output: Mapping[str, Any], caption: str) -> HomePicture:
    svg = "".join(output["data"]["image/svg+xml"])
    size = {side: round(float(length)) for side, length in _SIZE.findall(svg.partition(">")[0])}
    path = f"{PICTURE_FOLDER}/{digest(svg)[:16]}.svg"
    still = still_of(output)
    files = {path: svg.encode()} | ({still.path: still.data} if still else {})
    about = {
        "src": path,
        "still": still.path if still else "",
        "alt": alternative(output, cell),
        "caption": caption,
        "page": f"{chapter_page(chapter.name)}.html",
        "chapter": chapter.title,
        **size,
    }
    return HomePicture(files, about)


def built_on() -> str:
    """Return today, or SOURCE_DATE_EPOCH's day: https://reproducible-builds.org/specs/source-date-epoch/."""
    epoch = os.environ.get("SOURCE_DATE_EPOCH", "")
    utc = datetime.timezone.utc
    now = datetime.datetime.fromtimestamp(int(epoch), utc) if epoch.isdigit() else datetime.datetime.now(utc)
    return now.date().isoformat()


def about_markdown(course: Course, repository: Repository, middleware: str) -> str:
    """Return the page in MyST Markdown."""
    rclpy = version_of("ros-jazzy-rclpy", "ros-rclpy", "rclpy", otherwise="of a ROS installation")
    return f"""\
# About this course

Every output on these pages was produced by real ROS 2 nodes while the site was built. Nothing was typed in by hand:
when a node is wrong, its page shows it.

## Versions

| | |
| --- | --- |
| ROS 2 | {course.ros_distro.capitalize()}, rclpy {rclpy} |
| Middleware | {middleware} |
| Python | {platform.python_version()} |
| Spinbook | {__version__} |
| Built on | {built_on()} |
| Commit | {_commit(repository)} |

## Run it yourself

On Linux, with Python 3.10 to 3.14:

```bash
git clone {repository.url or "THE-COURSE"}.git course
cd course
make course
```

`make course` installs ROS 2 from PyPI into the folder `.venv`, runs every chapter, and builds this site. You need no
administrator's rights. Then open a notebook of `build/notebooks` in any editor.

Each chapter can also be opened in a browser, with nothing to install: look under *Open in …* at the top of its page.
Its first cell installs what is missing.

## Reading

The switch at the top changes between light and dark. The search works without a network. Each page prints well, and
every picture says in words what it shows.

Nothing on these pages is loaded from anywhere else, and nobody is counted.
"""


def _commit(repository: Repository) -> str:
    if not repository.commit:
        return "not in a repository"
    short = f"`{repository.commit[:10]}`"
    return f"[{short}]({repository.url}/commit/{repository.commit}), {repository.date}" if repository.url else short
