"""Drawings in a page's text."""

from __future__ import annotations

from pathlib import Path

from spinbook.site.page import Repository
from spinbook.site.prose import Links, rich

TEXT = "See [the task](task.md).\n\n```mermaid\nflowchart LR\n    A --> B\n```\n"


def test_a_drawing_is_the_site_s_own_and_a_link_leads_to_the_repository(tmp_path: Path) -> None:
    links = Links({}, Repository(tmp_path, "https://github.com/example/course"))

    page = rich(TEXT, links, "chapters", "chapters", lambda code: '<img src="../_drawings/a.svg">')

    assert '<img src="../_drawings/a.svg">' in page
    assert "(https://github.com/example/course/blob/main/chapters/task.md)" in page
