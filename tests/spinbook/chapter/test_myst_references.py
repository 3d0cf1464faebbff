"""MyST's labels and references become links with words, in notebooks and on the site, also between chapters."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path

import pytest

from spinbook.build.notebooks import build_notebooks
from spinbook.chapters import read_all
from spinbook.course.course import Course, read_course
from spinbook.site.build import build_site

FIRST = """\
(start)=
# Nodes & Topics

See [below](my-setup), [](my-setup), {ref}`my-setup`, {ref}`the setup <my-setup>`, and [](#what-is-ros2-run).

```{note}
In a box: {ref}`services:Call`.
```

> Quoted, over
> two lines: {ref}`the calls of
> services <services:call>` and more.

| what | where |
| --- | --- |
| calls | [](services:Call) |

Not here: `{ref}` is code, and so is `[](my-setup)`.

```text
{ref}`my-setup` in a fence
```

(my-setup)=
## Set up the *robot*

Text. The next chapter is {doc}`labs/second`, also {doc}`that one </book/labs/second>` and [](labs/second.md).

## What is `ros2 run`?

Nothing.
"""
SECOND = """\
---
title: Services
---

(services:Call)=
(other-name)=

## Call [one](https://example.org)

Back to {ref}`start`, {doc}`../first`, [the set-up](#my-setup) and {numref}`Figure %s <fig-graph>`, {numref}`fig-graph`.

```{figure} graph.png
:name: fig-graph
:alt: Two nodes

Two nodes and a topic.
```

Text with {sub}`other` roles.
(in-between)=
More. See [here](in-between).
"""
PICTURE = Path(__file__).parent / "book/docs/img/graph.png"
BROKEN = """\
# Broken

(known)=
## Known

It says {ref}`nowhere`, {ref}`words <nowhere>`, [a link](TeamRepo),
[](gone), {doc}`no/such` and [a file](no-such.md).
"""


@pytest.fixture
def write(tmp_path: Path) -> Callable[..., Course]:
    """Writes a course of chapters in book/: `write(first=TEXT)`."""

    def write_course(**chapters: str) -> Course:
        files = {name.replace("__", "/"): text for name, text in chapters.items()}
        for name, text in files.items():
            (tmp_path / f"book/{name}.md").parent.mkdir(parents=True, exist_ok=True)
            (tmp_path / f"book/{name}.md").write_text(text)
        names = json.dumps([f"book/{name}.md" for name in files])
        (tmp_path / "course.toml").write_text(f'title = "References"\nchapters = {names}\n[package]\nname = "refs"\n')
        return read_course(tmp_path)

    return write_course


def prose(course: Course, name: str) -> str:
    notebook = json.loads((course.build_folder / f"notebooks/{name}.ipynb").read_text())
    return "\n\n".join(cell["source"] for cell in notebook["cells"])


@pytest.fixture
def course(write: Callable[..., Course]) -> Course:
    """Two chapters that refer to each other, built."""
    course = write(first=FIRST, labs__second=SECOND)
    (course.root / "book/labs/graph.png").write_bytes(PICTURE.read_bytes())
    assert [item.problems for item in build_notebooks(course)] == [(), ()]
    return course


def test_references_have_the_words_of_the_heading_and_lead_to_it(course: Course) -> None:
    shown = prose(course, "first")

    setup = "#Set-up-the-robot"
    assert f"See [below]({setup}), [Set up the *robot*]({setup}), [Set up the *robot*]({setup})," in shown
    assert f"[the setup]({setup}), and [What is `ros2 run`?](#What-is-ros2-run?)." in shown
    assert "(my-setup)=" not in shown


def test_references_lead_to_other_chapters_from_boxes_quotations_and_tables(course: Course) -> None:
    shown = prose(course, "first")

    assert "> In a box: [Call one](second.ipynb#Call-one)." in shown
    assert "> two lines: [the calls of services](second.ipynb#Call-one)\n> and more." in shown
    assert "| calls | [Call one](second.ipynb#Call-one) |" in shown
    back = prose(course, "second")
    assert "Back to [Nodes & Topics](first.ipynb#Nodes-&-Topics), [Nodes & Topics](first.ipynb)," in back
    assert "[the set-up](first.ipynb#Set-up-the-robot)" in back


def test_documents_are_linked_by_their_titles(course: Course) -> None:
    assert "is [Services](second.ipynb), also [that one](second.ipynb) and [Services](second.ipynb)." in prose(
        course, "first"
    )


def test_figures_have_their_captions_and_other_places_the_heading_above(course: Course) -> None:
    shown = prose(course, "second")

    assert "[Figure](#Call-one), [Two nodes and a topic.](#Call-one)." in shown
    assert "More. See [here](#Call-one)." in shown


def test_code_stays_as_it_is_and_other_roles_show_their_content(course: Course) -> None:
    assert "Not here: `{ref}` is code, and so is `[](my-setup)`." in prose(course, "first")
    assert "{ref}`my-setup` in a fence" in prose(course, "first")
    assert "<sub>other</sub>" in prose(course, "second")


def test_on_the_site_they_lead_to_the_headings_ids(course: Course) -> None:
    notebooks = course.build_folder / "notebooks"
    (course.build_folder / "executed").mkdir()
    for file in notebooks.glob("*.ipynb"):
        (course.build_folder / "executed" / file.name).write_bytes(file.read_bytes())
    assert build_site(course, lambda page: None, as_it_ran=True).problems == ()

    first = (course.build_folder / "site/chapters/first.html").read_text()
    second = (course.build_folder / "site/chapters/second.html").read_text()
    for page, target in ((first, "set-up-the-robot"), (first, "what-is-ros2-run"), (second, "call-one")):
        assert f'id="{target}"' in page
    assert 'href="#set-up-the-robot"' in first
    assert 'href="second.html#call-one"' in first
    assert 'href="#what-is-ros2-run"' in first
    assert 'href="first.html#set-up-the-robot"' in second
    assert '<a class="reference internal" href="second.html">' in first


def test_a_changed_heading_changes_the_chapters_that_refer_to_it(course: Course) -> None:
    file = course.root / "book/labs/second.md"
    file.write_text(file.read_text().replace("## Call [one]", "## Ask [one]"))
    list(build_notebooks(course))

    assert "[Ask one](second.ipynb#Ask-one)" in prose(course, "first")


def test_unknown_names_stay_as_text_and_are_reported_once(write: Callable[..., Course]) -> None:
    course = write(broken=BROKEN)
    (reading,) = read_all(course)

    assert [(problem.line, problem.problem) for problem in reading.problems] == [
        (6, "a reference leads to the label `TeamRepo`, which no chapter has."),
        (6, "a reference leads to the label `nowhere`, which no chapter has."),
        (7, "a link leads to `no-such.md`, and there is no such file."),
        (7, "a reference leads to the document `no/such`, and there is no such file."),
        (7, "a reference leads to the label `gone`, which no chapter has."),
    ]
    assert reading.chapter is not None
    assert (
        "It says nowhere, words, a link,\ngone, no/such and [a file](no-such.md)." in reading.chapter.cells[-1].source
    )


def test_a_course_without_labels_keeps_its_links(write: Callable[..., Course]) -> None:
    (reading,) = read_all(write(plain="# Plain\n\n[a page](TeamRepo)\n"))

    assert [problem.problem for problem in reading.problems] == [
        "a link leads to `TeamRepo`, and there is no such file."
    ]
