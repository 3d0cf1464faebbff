"""Chapters may have any names: with dots, the same in different folders, with spaces."""

from __future__ import annotations

import json
from pathlib import Path

from course_folder import CourseFolder

from spinbook.course.course import names_of


def test_chapters_of_one_name_in_different_folders_are_told_apart_by_their_folders() -> None:
    files = [Path(name) for name in ("intro.md", "a/index.md", "b/index.md", "a/b/README.md", "two words/Über uns.md")]

    assert list(names_of(files).values()) == ["intro", "a-index", "b-index", "README", "Über-uns"]


def test_a_name_is_never_given_twice() -> None:
    files = [Path(name) for name in ("a/b.md", "a/b.mdx", "a-b.md", "x/a-b.md", "c/x/a-b.md")]

    assert len(set(names_of(files).values())) == len(files)


def test_a_name_that_no_chapter_has_is_reported_and_fails(course: CourseFolder) -> None:
    said = course.write(nodes="# Nodes\n").spinbook("build", "--execute", "node")

    assert said.returncode == 1
    assert "there is no chapter `node`" in said.stdout
    assert "Did you mean `nodes`?" in said.stdout


def test_equal_names_in_two_folders_make_two_notebooks(course: CourseFolder) -> None:
    for folder in ("one", "two"):
        (course.root / folder).mkdir()
        (course.root / folder / "index.md").write_text(f"# {folder}\n\nSee [the other](../one/index.md).\n")
    chapters = json.dumps(["one/index.md", "two/index.md"])
    (course.root / "course.toml").write_text(f'title = "T"\nchapters = {chapters}\n[package]\nname = "robot"\n')

    assert course.spinbook("build").returncode == 0
    assert "[the other](one-index.ipynb)" in course.notebook("two-index").cells[0].source
