"""Chapters written for eight book tools are correct, in the notebook and on the site; book/ has one of each."""

from __future__ import annotations

import json
import shutil
from pathlib import Path
from typing import Any

import pytest

from spinbook.build.notebooks import build_notebooks
from spinbook.course.course import Course, read_course
from spinbook.site.build import build_site

BOOK = Path(__file__).with_name("book")
CHAPTERS = ["docusaurus", "mkdocs", "myst", "jekyll", "docsify", "github", "quarto", "gitbook"]


@pytest.fixture(scope="module")
def course(tmp_path_factory: pytest.TempPathFactory) -> Course:
    """The book as a course, its notebooks built and, without outputs, its site."""
    root = tmp_path_factory.mktemp("flavours") / "book"
    shutil.copytree(BOOK, root)
    course = read_course(root)
    assert [item.problems for item in build_notebooks(course)] == [()] * len(CHAPTERS)
    shutil.copytree(root / "build/notebooks", root / "build/executed")
    site = build_site(course, lambda page: None, as_it_ran=True)
    assert site.problems == ()
    return course


def cells(course: Course, name: str) -> list[dict[str, Any]]:
    notebook = json.loads((course.build_folder / f"notebooks/{name}.ipynb").read_text())
    return list(notebook["cells"])


def prose(course: Course, name: str) -> str:
    return "\n\n".join(cell["source"] for cell in cells(course, name) if cell["cell_type"] == "markdown")


def page(course: Course, name: str) -> str:
    return (course.build_folder / f"site/chapters/{name}.html").read_text()


@pytest.mark.parametrize("name", CHAPTERS)
def test_every_flavour_has_its_node_as_a_cell(course: Course, name: str) -> None:
    nodes = [cell["source"].split("\n")[0] for cell in cells(course, name) if cell["source"].startswith("%%node")]

    assert [line.split()[1] for line in nodes] == ["talker"]


@pytest.mark.parametrize("name", CHAPTERS)
def test_nothing_of_a_book_tools_own_language_is_left(course: Course, name: str) -> None:
    shown = prose(course, name)

    for mark in (
        ":::",
        "!!!",
        "???",
        "===",
        "{%",
        "{:",
        "<Tab",
        "import Tabs",
        "{image}",
        "{tab",
        "toctree",
        "{/*",
        "8<",
    ):
        assert mark not in shown


@pytest.mark.parametrize(
    ("name", "title", "words"),
    [
        ("docusaurus", "Before you begin", "You know what a **node** is."),
        ("docusaurus", "Caution", "Stop the motors first."),
        ("mkdocs", "Look first", "Read the log before you change anything."),
        ("myst", "Warning", "A topic has one type."),
        ("myst", "By the way", "Types have names such as `std_msgs/msg/String`."),
        ("jekyll", "Warning", "The robot moves. Keep away from it."),
        ("docsify", "Warning", "Never unplug the robot while it moves."),
        ("github", "Important", "Source your workspace."),
        ("quarto", "A tip", "Name topics by what they carry."),
        ("gitbook", "Caution", "Do not stand in front of the robot."),
        ("gitbook", "Tip", "Messages have types."),
    ],
)
def test_admonitions_have_their_title_in_the_notebook_and_on_the_site(
    course: Course, name: str, title: str, words: str
) -> None:
    assert f"> **{title}**\n>\n> {words}" in prose(course, name)
    assert f'<p class="admonition-title">{title}</p>' in page(course, name)


@pytest.mark.parametrize("name", CHAPTERS)
def test_pictures_are_in_the_notebook_and_on_the_site(course: Course, name: str) -> None:
    attached = [file for cell in cells(course, name) for file in cell.get("attachments", {})]

    assert attached
    assert all(f"attachment:{file}" in prose(course, name) for file in attached)
    shown = [part.split('"')[0] for part in page(course, name).split("<img")[1:] for part in part.split('src="')[1:2]]
    folder = course.build_folder / "site/chapters"
    assert shown
    assert all((folder / source).resolve().is_file() for source in shown)


@pytest.mark.parametrize(
    ("name", "text", "target"),
    [
        ("docusaurus", "MkDocs", "mkdocs{}#a-node"),
        ("docusaurus", "the folder", "github{}"),
        ("jekyll", "docsify", "docsify{}"),
        ("jekyll", "GitHub", "github{}"),
        ("github", "MyST", "myst{}"),
        ("quarto", "VitePress", "gitbook{}"),
    ],
)
def test_links_lead_to_the_other_chapters(course: Course, name: str, text: str, target: str) -> None:
    assert f"[{text}]({target.format('.ipynb')})" in prose(course, name)
    assert f'href="{target.format(".html")}"' in page(course, name)


def test_titles_of_links_and_references_stay_and_links_in_code_are_left_alone(course: Course) -> None:
    assert '[GitHub](github.ipynb "The same")' in prose(course, "docsify")
    assert '[again]: mkdocs.ipynb "MkDocs"' in prose(course, "github")
    assert "`[not a link](../myst.md)`" in prose(course, "github")


def test_pictures_of_mdx_and_jekyll_are_found(course: Course) -> None:
    assert '<img src="attachment:img-graph.png" alt="Again" />' in prose(course, "docusaurus")
    assert "![again](attachment:img-logo.png)" in prose(course, "jekyll")


def test_titles_in_the_front_matter_become_headings(course: Course) -> None:
    for name, title in (("docusaurus", "Topics with Docusaurus"), ("jekyll", "Topics with Jekyll")):
        assert prose(course, name).startswith(f"# {title}\n")
        assert f"<h1>{title}" in page(course, name)


def test_tabs_that_do_not_run_are_folded_and_those_that_do_are_cells(course: Course) -> None:
    sources = [cell["source"] for cell in cells(course, "docusaurus")]

    assert sources[0].endswith("**Python**")
    assert sources[2].startswith("%%node talker")
    assert sources[3].startswith("<details>\n<summary>C++</summary>\n\n```cpp")
    assert "<summary>Windows</summary>" in page(course, "myst")


def test_a_list_goes_on_counting_behind_a_cell(course: Course) -> None:
    assert "2. Look at the picture." in prose(course, "mkdocs")
    assert "3. Name its executable in `setup.py`:\n\n   ```python\n   entry_points" in prose(course, "github")


def test_a_file_that_is_included_is_what_runs(course: Course) -> None:
    assert 'RATE = 2.0\nprint(f"{RATE} Hz")' in [cell["source"] for cell in cells(course, "mkdocs")]


def test_a_picture_that_changes_is_built_anew(course: Course) -> None:
    before = cells(course, "quarto")
    picture = course.root / "docs/img/graph.png"
    picture.write_bytes(picture.read_bytes() + b"\0")

    fresh = {item.name for item in build_notebooks(course) if item.fresh}

    assert "quarto" in fresh
    assert "github" not in fresh
    assert cells(course, "quarto") != before
