"""Notebooks for the site: executes those for its pages, and prepares those that open anywhere."""

from __future__ import annotations

import base64
import json
import lzma
import re
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from typing import Any
from urllib.parse import quote

from rich.console import Console

from spinbook.build.execution import NotebookJob, execute
from spinbook.build.notebooks import BuildResult, build_notebooks, report
from spinbook.course.course import FILE, Course
from spinbook.handout.pins import imported_packages
from spinbook.interfaces.definitions import compile_course
from spinbook.problem import SpinbookError
from spinbook.site.page import Repository


def bring_up_to_date(course: Course, console: Console, *, is_strict: bool, run: bool) -> bool:
    """Compile the course's interfaces, build each chapter's notebook, and `run` those whose code has changed.

    Return False if something has to be fixed first. If `is_strict`, that includes cells that fail, errors of nodes, and
    code that is shown but not run.
    """
    try:
        compile_course(course)
    except SpinbookError as error:
        console.print(str(error), markup=False)
        return False
    built = list(build_notebooks(course, is_strict=is_strict))
    report(console, built)
    if any(item.failed for item in built):
        return False
    return not run or _run_changed(course, console, built, is_strict=is_strict)


def _run_changed(course: Course, console: Console, built: list[BuildResult], *, is_strict: bool) -> bool:
    chosen = [item for item in built if course.is_run(item.chapter)]
    if left := [item.name for item in built if item not in chosen]:
        console.print(
            f"{len(left)} chapters are shown without outputs, because nobody asked to run them.", markup=False
        )
        fix = f"To run one: spinbook build --execute {left[0]}, or add its file to `run` in {FILE}."
        console.print(f"    {fix}", markup=False)
    jobs = [NotebookJob(item.chapter, item.notebook, course.build_folder) for item in chosen]
    good = True
    with console.status("Checking which chapters have to run …") as status:
        for executed in execute(
            jobs, 2, lambda at: status.update(f"Running {at.chapter}: {at.done} of {at.cells} cells")
        ):
            for failure in executed.failures:
                console.print(str(failure), markup=False)
            for warning in (*executed.node_errors, *executed.warnings):
                console.print(str(warning), markup=False)
            if not executed.cached and not executed.failures:
                console.print(f"{executed.chapter} ran in {executed.seconds:.0f} s", markup=False)
            good = good and not (is_strict and (executed.failures or executed.node_errors))
    return good


# The notebooks that open anywhere are on a branch of their own, `notebooks`, with the files for Binder and Codespaces:
# https://colab.research.google.com/github/OWNER/NAME/blob/BRANCH/FILE
# https://mybinder.readthedocs.io/en/latest/howto/badges.html
# https://docs.github.com/codespaces/setting-up-your-project-for-codespaces


BRANCH = "notebooks"
_BINDER_PYTHON = "python-3.11"
_CODESPACES_IMAGE = "mcr.microsoft.com/devcontainers/python:3.11-bookworm"

_INSTALL = """\
# Installs ROS 2 and the course's commands, if they are missing.
import importlib.util, subprocess, sys

if missing := [name for name in ("rclpy", "spinbook") if importlib.util.find_spec(name) is None]:
    print("Installing ROS 2 and the course's commands: about a minute …", flush=True)
    wanted = {requirement!r}
    done = subprocess.run([sys.executable, "-m", "pip", "install", "--quiet", wanted], capture_output=True, text=True)
    if done.returncode:
        print(done.stderr[-2000:])
        raise SystemExit("The installation failed. The wheels of ROS 2 need Linux on x86-64 and Python 3.10 to 3.14.")
    from spinbook.fresh_wheels import load_fresh_wheels

    load_fresh_wheels()
    print("Installed.")
else:
    print("Everything is installed.")"""


_EXERCISES = '''\
# Adds what %check needs: the public parts of exercises, and compiled messages. Existing files are not changed.
import base64, importlib.util, json, lzma, pathlib, subprocess, sys

packed = r"""
{packed}
"""
for name, text in json.loads(lzma.decompress(base64.b85decode("".join(packed.split())))).items():
    file = pathlib.Path(name)
    if not file.exists():
        file.parent.mkdir(parents=True, exist_ok=True)
        file.write_bytes(text.encode("utf-8", "surrogateescape"))
for wheel in sorted(pathlib.Path("wheels").glob("compiled_interfaces_*.whl")):
    if importlib.util.find_spec(wheel.name.partition("-")[0].removeprefix("compiled_interfaces_")) is None:
        subprocess.run([sys.executable, "-m", "pip", "install", "--quiet", "--no-deps", str(wheel)], check=False)
importlib.invalidate_caches()
if pathlib.Path("exercises").is_dir():
    print("The exercises are in the folder", pathlib.Path("exercises").resolve())'''


@dataclass(frozen=True)
class Opener:
    """A service that opens a notebook, by its common name."""

    name: str
    url: str


def openers(repository: Repository, notebook: str) -> tuple[Opener, ...]:
    """Return the services that can open the notebook of this name; none if the course is not on GitHub."""
    if repository.github is None:
        return ()
    owner, name = repository.github
    container = quote(f".devcontainer/{notebook}/devcontainer.json", safe="")
    return (
        Opener("Colab", f"https://colab.research.google.com/github/{owner}/{name}/blob/{BRANCH}/{notebook}.ipynb"),
        Opener("Binder", f"https://mybinder.org/v2/gh/{owner}/{name}/{BRANCH}?urlpath=lab/tree/{notebook}.ipynb"),
        Opener("Codespaces", f"https://codespaces.new/{owner}/{name}/tree/{BRANCH}?devcontainer_path={container}"),
    )


#: Spinbook's own repository, and the line of a course's requirements.txt that names another source.
_SPINBOOK = "git+https://github.com/spinbook/spinbook"
_NAMED = re.compile(r"^spinbook(?:\[[\w,]*\])?\s*@\s*(\S+)", re.MULTILINE)


def requirement(repository: Repository, cells: Iterable[str] = ()) -> str:
    """Return pip's requirement to run notebooks with these cells: Spinbook with ROS 2 and colcon, from the course's own
    source.
    """
    plots = ",plots" if any(package.startswith("matplotlib==") for package in imported_packages(cells)) else ""
    return f"spinbook[ros,colcon,notebooks{plots}] @ {_origin(repository)}"


def _origin(repository: Repository) -> str:
    if repository.url and (repository.root / "spinbook" / "cli.py").is_file():
        return f"git+{repository.url}@{repository.commit or 'main'}"
    requirements = repository.root / "requirements.txt"
    named = (
        _NAMED.search(requirements.read_text(encoding="utf-8", errors="replace")) if requirements.is_file() else None
    )
    return named[1] if named else _SPINBOOK


def launch_notebook(notebook: Mapping[str, Any], spinbook: str, exercises: Mapping[str, bytes]) -> dict[str, Any]:
    """Return the notebook with a cell before its first code cell that installs `spinbook` if it is missing.

    `exercises` are the files of students' copies, and wheels of interfaces, by path. The notebook contains them, so
    that `%check` works wherever it is opened.
    """
    cells = list(notebook["cells"])
    first = next((index for index, cell in enumerate(cells) if cell["cell_type"] == "code"), len(cells))
    added = [_hidden("install", _INSTALL.replace("{requirement!r}", repr(spinbook)))]
    if exercises:
        added.append(_hidden("exercises", _EXERCISES.replace("{packed}", _packed(exercises))))
    return {**notebook, "cells": [*cells[:first], *added, *cells[first:]]}


def _hidden(kind: str, source: str) -> dict[str, Any]:
    """Return a cell whose code JupyterLab hides."""
    return {
        "cell_type": "code",
        "id": f"spinbook-{kind}",
        "metadata": {"spinbook": {"kind": kind, "line": 1}, "jupyter": {"source_hidden": True}},
        "source": source,
        "outputs": [],
        "execution_count": None,
    }


def _packed(files: Mapping[str, bytes]) -> str:
    """Return the files as lines of text for a Python string."""
    plain = json.dumps({name: content.decode("utf-8", "surrogateescape") for name, content in sorted(files.items())})
    text = base64.b85encode(lzma.compress(plain.encode())).decode()
    return "\n".join(text[start : start + 110] for start in range(0, len(text), 110))


def branch_files(names: Iterable[str], spinbook: str, title: str) -> dict[str, str]:
    """Return the other files of the branch: path -> text."""
    files = {
        "README.md": f"# {title}: notebooks\n\nMade by `spinbook site`; edits are lost at the next build.\n",
        "requirements.txt": f"{spinbook}\njupyterlab\n",
        "runtime.txt": f"{_BINDER_PYTHON}\n",
    }
    for name in names:
        files[f".devcontainer/{name}/devcontainer.json"] = _container(name)
    return files


def _container(notebook: str) -> str:
    container = {
        "name": notebook,
        "image": _CODESPACES_IMAGE,
        "postCreateCommand": "pip install -r requirements.txt",
        "customizations": {
            "codespaces": {"openFiles": [f"{notebook}.ipynb"]},
            "vscode": {"extensions": ["ms-python.python", "ms-toolsai.jupyter"]},
        },
    }
    return json.dumps(container, indent=2) + "\n"
