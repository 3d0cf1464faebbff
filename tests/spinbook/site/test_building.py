"""Building again makes only what has changed, and errors are reported with the chapter's file and line."""

from __future__ import annotations

import re
from pathlib import Path

import pytest
from small_course import SmallCourse

from spinbook.site.command import pages_of


def snapshot(site: Path) -> dict[str, int]:
    return {file.relative_to(site).as_posix(): file.stat().st_mtime_ns for file in site.rglob("*") if file.is_file()}


def test_nothing_is_made_where_nothing_has_changed(course: SmallCourse) -> None:
    before = snapshot(course.site)

    said = course.spinbook_site()

    assert said.returncode == 0
    assert "8 pages, unchanged" in said.stdout
    assert snapshot(course.site) == before


def test_a_change_of_prose_runs_nothing_spares_other_chapters_and_its_faults_have_a_line(course: SmallCourse) -> None:
    before = snapshot(course.site)
    course.change("chapters/02-more.md", "Words only.", "Other words.")
    course.change("chapters/02-more.md", "Good-bye.", "See [nothing](#not-here).")

    said = course.spinbook_site()

    assert said.returncode == 0, said.stdout + said.stderr
    assert "ran in" not in said.stdout
    assert "Other words." in course.page("chapters/02-more.html")
    after = snapshot(course.site)
    changed = {name for name in after if before.get(name) != after[name]}
    assert "chapters/02-more.html" in changed
    assert not {"chapters/01-talk.html", "about.html", "glossary.html"} & changed
    line = (course.root / "chapters/02-more.md").read_text().split("\n").index("See [nothing](#not-here).") + 1
    assert re.search(rf"^chapters/02-more\.md:{line}: warning: .*not-here", said.stdout, re.MULTILINE)
    assert "Traceback" not in said.stdout + said.stderr
    assert "#not-here" in (course.site / "downloads" / "02-more.ipynb").read_text(), "the notebook is the chapter's"


@pytest.mark.soak
def test_a_chapter_that_is_taken_out_leaves_nothing(course: SmallCourse) -> None:
    course.change("course.toml", ', "chapters/02-more.md"', "")
    course.change("chapters/01-talk.md", "[the next chapter](02-more.md)", "what follows")

    said = course.spinbook_site()

    assert said.returncode == 0, said.stdout + said.stderr
    assert not [name for name in snapshot(course.root / "build" / "site") if "02-more" in name]
    assert not [name for name in snapshot(course.root / "build" / "launch") if "02-more" in name]


def test_what_students_must_not_see_is_not_published(course: SmallCourse) -> None:
    solution = (course.root / "solutions/joint_velocity/solution.py").read_text()
    part = solution.split("# BEGIN SOLUTION\n")[1].split("# END SOLUTION")[0]
    course.change("chapters/02-more.md", "Good-bye.", f"Good-bye.\n\n```text\n{part}\n```")
    before = snapshot(course.site)

    said = course.spinbook_site("--no-run")

    assert said.returncode == 1
    assert "chapters/02-more.md: error: a part of the solution of joint_velocity would be published" in said.stdout
    assert snapshot(course.site) == before


def test_a_chapter_that_has_never_run_can_not_be_shown(course: SmallCourse) -> None:
    (course.root / "build" / "executed" / "01-talk.ipynb").unlink()
    before = snapshot(course.site)

    said = course.spinbook_site("--no-run")

    assert said.returncode == 1
    assert "chapters/01-talk.md: error: it has not run yet" in said.stdout
    assert snapshot(course.site) == before


def test_help_teaches(built: SmallCourse) -> None:
    said = built.spinbook_site("--help").stdout

    assert "spinbook site --serve" in said
    assert "build/site/index.html" in said


def test_while_writing_pages_are_served_so_that_they_can_reload(built: SmallCourse) -> None:
    def get(path: str) -> tuple[str, bytes]:
        status: list[str] = []
        body = pages_of(built.site)({"PATH_INFO": path}, lambda said, headers: status.append(said))
        return status[0], b"".join(body)

    status, page = get("/")
    assert status == "200 OK"
    assert b"Content-Security-Policy" not in page
    assert get("/../../course.toml")[0] == "404 Not Found"
