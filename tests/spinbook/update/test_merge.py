"""A student's cells and an author's changes are merged, and nothing of the student's is ever lost."""

from __future__ import annotations

import copy
import json
from collections import Counter
from typing import Any

import nbformat
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from update_notebooks import Cell, cell, cells_of, notebook, ran, texts

from spinbook.update.merge import content, merged
from spinbook.update.plan import NoNotebook, merged_notebook

TITLE = cell("# A chapter", "title", "markdown")
SETUP = cell("%load_ext spinbook", "spinbook-setup")
TALKER = cell("%%node talker\nimport rclpy\nprint('talks')", "node-talker", node="talker")
TASK = cell("## The task\nWrite a listener.", "exercise-listener-task", "markdown")
STARTER = cell("%%node listener\n# TODO: listen", "exercise-listener-starter", node="listener", exercise="listener")
END = cell("## The end", "the-end", "markdown")
BASE = notebook(TITLE, SETUP, TALKER, TASK, STARTER, END)

MINE = cell("%%node listener\nprint('I listen')", "exercise-listener-starter", node="listener", exercise="listener")
OWN = cell("# my own thoughts", "a1b2c3", "markdown")


def edited(made: Cell, text: str) -> Cell:
    return {**made, "source": text}


def test_what_only_the_course_changed_is_taken_and_what_only_the_student_changed_is_kept() -> None:
    talker = edited(TALKER, TALKER["source"].replace("talks", "talks louder"))
    result, report = merged_notebook(
        BASE, notebook(TITLE, SETUP, TALKER, TASK, MINE, END), notebook(TITLE, SETUP, talker, TASK, STARTER, END)
    )
    assert texts(result) == [c["source"] for c in (TITLE, SETUP, talker, TASK, MINE, END)]
    assert report.conflicts == []


def test_both_changed_is_a_conflict_the_students_stays_and_the_new_one_is_text_below() -> None:
    starter = edited(STARTER, STARTER["source"] + "\n# TODO: listen twice ```")
    mine = notebook(TITLE, SETUP, TALKER, TASK, ran(MINE, "heard"), END)
    result, report = merged_notebook(BASE, mine, notebook(TITLE, SETUP, TALKER, TASK, starter, END))
    kept, shown = cells_of(result)[4:6]
    assert kept == ran(MINE, "heard")
    assert shown["cell_type"] == "markdown"
    assert shown["source"].startswith("**CHANGED IN THE NEW HANDOUT.**")
    assert f"````python\n{starter['source']}\n````" in shown["source"]
    assert report.conflicts == ["%%node listener"]
    nbformat.validate(json.loads(result))


def test_outputs_stay_where_the_code_did_and_go_where_it_changed() -> None:
    talker = edited(TALKER, "%%node talker\nprint('new')")
    mine = notebook(TITLE, ran(SETUP, "ready"), ran(TALKER, "old words"), TASK, STARTER, END)
    result, _ = merged_notebook(BASE, mine, notebook(TITLE, SETUP, talker, TASK, STARTER, END))
    assert cells_of(result)[1] == ran(SETUP, "ready")
    assert cells_of(result)[2]["outputs"] == []


def test_cells_of_the_students_stay_behind_what_they_stood_behind() -> None:
    more = cell("## Another section", "another", "markdown")
    mine = notebook(TITLE, OWN, SETUP, TALKER, TASK, MINE, edited(OWN, "x = 1"), END)
    result, report = merged_notebook(BASE, mine, notebook(TITLE, more, SETUP, TALKER, TASK, STARTER, END))
    assert [c["id"] for c in cells_of(result)][:5] == ["title", "a1b2c3", "another", "spinbook-setup", "node-talker"]
    assert texts(result)[6:] == [MINE["source"], "x = 1", END["source"]]
    assert report.added == ["## Another section"]


def test_sections_in_another_order_are_taken_and_a_students_own_order_is_kept() -> None:
    turned = notebook(TITLE, SETUP, TASK, STARTER, TALKER, END)
    result, report = merged_notebook(BASE, notebook(TITLE, SETUP, TALKER, OWN, TASK, MINE, END), turned)
    assert texts(result) == [c["source"] for c in (TITLE, SETUP, TASK, MINE, TALKER, OWN, END)]
    assert not report.order_kept
    moved = notebook(TITLE, SETUP, TALKER, END, TASK, MINE)
    result, report = merged_notebook(BASE, moved, turned)
    assert texts(result) == texts(moved)
    assert report.order_kept


def test_what_the_course_took_out_goes_unless_the_student_changed_it() -> None:
    talker = edited(TALKER, "%%node talker\nprint('mine')")
    mine = notebook(TITLE, SETUP, talker, TASK, MINE, END)
    result, report = merged_notebook(BASE, mine, notebook(TITLE, SETUP, STARTER))
    assert texts(result) == [c["source"] for c in (TITLE, SETUP, talker, MINE)]
    assert report.kept_though_removed == ["%%node talker"]
    assert report.removed == ["## The task", "## The end"]


def test_a_deleted_cell_stays_deleted_unless_it_changed_and_a_missing_exercise_is_reported() -> None:
    task = edited(TASK, "## The task\nWrite two listeners.")
    result, report = merged_notebook(BASE, notebook(SETUP, END), notebook(TITLE, SETUP, TALKER, task, STARTER, END))
    assert texts(result) == [SETUP["source"], task["source"], END["source"]]
    assert report.back == ["## The task"]
    assert report.missing == ["%%node listener"]


def test_a_deleted_check_is_reported_too() -> None:
    check = cell("%check listener", "exercise-listener-check")
    check["metadata"]["spinbook"] = {"kind": "check"}
    base = notebook(TITLE, SETUP, STARTER, check)
    result, report = merged_notebook(base, notebook(TITLE, SETUP, MINE), notebook(TITLE, SETUP, STARTER, check, END))
    assert check["source"] not in texts(result)
    assert report.missing == ["%check listener"]


def test_cells_that_lost_their_ids_are_found_by_content_by_node_and_by_likeness() -> None:
    def colab(made: Cell, number: int) -> Cell:
        return {k: v for k, v in made.items() if k != "id"} | {"metadata": {"id": f"x{number}"}}

    task = edited(TASK, TASK["source"] + " Think first.")
    mine = [colab(c, i) for i, c in enumerate((TITLE, SETUP, TALKER, task, MINE, END))]
    old = json.loads(notebook(*mine))
    old["nbformat_minor"] = 0
    new_end = edited(END, "## The end, at last")
    new = notebook(TITLE, SETUP, TALKER, TASK, edited(STARTER, "%%node listener\n# TODO: hear"), new_end)
    result, report = merged_notebook(BASE, json.dumps(old).encode(), new)
    assert report.conflicts == ["%%node listener"]
    assert [t for t in texts(result) if "CHANGED" not in t] == [
        *(c["source"] for c in (TITLE, SETUP, TALKER, task, MINE, new_end))
    ]
    nbformat.validate(json.loads(result))


def test_a_cell_that_was_copied_is_one_cell_and_a_cell_of_the_students_own() -> None:
    copied = edited(MINE, MINE["source"] + "\n# second try")
    mine = notebook(TITLE, SETUP, TALKER, TASK, MINE, {**copied, "id": "copy"}, END)
    result, _ = merged_notebook(BASE, mine, notebook(TITLE, SETUP, TALKER, TASK, STARTER, OWN, END))
    assert texts(result)[4:6] == [MINE["source"], copied["source"]]


def test_without_what_was_handed_out_every_difference_is_the_students() -> None:
    mine = notebook(TITLE, SETUP, edited(TALKER, "%%node talker\nprint('whose?')"), TASK, MINE, OWN, END)
    result, report = merged_notebook(None, mine, BASE)
    assert [t for t in texts(result) if "CHANGED" not in t] == texts(mine)
    assert report.conflicts == ["%%node talker", "%%node listener"]


@pytest.mark.parametrize("data", [b"", b"[]", b'{"cells": 3}', b'{"cells": [1]}', b"[" * 100_000, b"\xff"])
def test_what_is_no_notebook_is_reported(data: bytes) -> None:
    with pytest.raises(NoNotebook):
        merged_notebook(BASE, data, notebook(TITLE))


# Any student, any author.

WORDS = st.sampled_from(["", "x = 1", "%stop --all", "print('a long line of code', 3)", "## Heading", "%%node talker"])
KINDS = st.sampled_from(["code", "markdown"])
BASES = st.lists(st.tuples(WORDS, KINDS), max_size=7).map(
    lambda made: [cell(t, f"b{i}", k) for i, (t, k) in enumerate(made)]
)
EDITS = st.lists(
    st.tuples(
        st.sampled_from(["edit", "delete", "add", "move", "copy", "retype", "new id", "no id"]),
        st.integers(0, 7),
        st.integers(0, 7),
        st.sampled_from(["mine", "theirs", "x = 2", "%%node talker\npass", ""]),
    ),
    max_size=6,
)


def after(cells: list[Cell], edits: list[tuple[str, int, int, str]], who: str) -> list[Cell]:
    """Return somebody's edits of cells."""
    cells = copy.deepcopy(cells)
    for number, (edit, at, to, words) in enumerate(edits):
        if edit == "add" or not cells:
            cells.insert(at, cell(words, f"{who}{number}"))
            continue
        one = cells[at % len(cells)]
        if edit == "edit":
            one["source"] = words
        elif edit == "retype":
            one["cell_type"] = "raw"
        elif edit == "new id":
            one["id"] = f"{who}{number}"
        elif edit == "no id":
            one.pop("id", None)
        elif edit == "copy":
            cells.insert(to, copy.deepcopy(one) | {"id": f"{who}{number}"})
        else:
            cells.remove(one)
            if edit == "move":
                cells.insert(to, one)
    return cells


def counted(cells: list[Cell]) -> Counter[Any]:
    return Counter(content(c) for c in cells)


@settings(max_examples=150, deadline=None, derandomize=True)
@given(BASES, EDITS, EDITS)
def test_no_cell_of_the_students_is_ever_lost(base: list[Cell], mine: list[Any], new: list[Any]) -> None:
    students, authors = after(base, mine, "m"), after(base, new, "n")
    once, _ = merged(base, students, authors)
    own = counted(students) - counted(base)
    assert own <= counted(once)
    # Nor when the update is done again, after one that was interrupted before it was remembered; only a mere copy of a
    # cell that the author removed can't be distinguished from that cell then.
    theirs = Counter({cell: count for cell, count in own.items() if cell not in counted(base)})
    assert theirs <= counted(merged(base, once, authors)[0])


@settings(max_examples=150, deadline=None, derandomize=True)
@given(BASES, EDITS, EDITS)
def test_what_the_author_wrote_is_there_too(base: list[Cell], mine: list[Any], new: list[Any]) -> None:
    students, authors = after(base, mine, "m"), after(base, new, "n")
    result, _ = merged(base, students, authors)
    everything = "\n".join(content(c)[1] for c in result)
    assert all(text in everything for _, text in counted(authors) - counted(base))


@settings(max_examples=100, deadline=None, derandomize=True)
@given(BASES, EDITS)
def test_who_changed_nothing_gets_the_new_cells(base: list[Cell], new: list[Any]) -> None:
    authors = after(base, new, "n")
    assert [content(c) for c in merged(base, base, authors)[0]] == [content(c) for c in authors]


@settings(max_examples=150, deadline=None, derandomize=True)
@given(BASES, EDITS, EDITS)
def test_the_same_handout_changes_nothing(base: list[Cell], mine: list[Any], new: list[Any]) -> None:
    students, authors = after(base, mine, "m"), [c for c in after(base, new, "n") if "id" in c]
    assert merged(base, students, base)[0] == students
    once, _ = merged(base, students, authors)
    assert merged(authors, once, authors)[0] == once
