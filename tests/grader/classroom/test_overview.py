"""The numbers on the instructor's page."""

from __future__ import annotations

import plain_grades as plain
import pytest

from grader.classroom.misconceptions import grouped
from grader.classroom.overview import distribution, overview_page, page_of, tallies
from grader.grading.grade import Student


def test_ten_bars_tell_how_the_points_are_spread() -> None:
    found = distribution([0, 9.9, 10, 55, 100, 100, 104], 100)
    assert found
    assert [bar.count for bar in found.bars] == [2, 1, 0, 0, 0, 1, 0, 0, 0, 3]
    assert (found.count, found.full, found.median) == (7, 3, 55)
    assert (
        found.description
        == "Histogram of 7 students' points: 2 from 0 to 10, 1 from 10 to 20, 1 from 50 to 60, 3 from 90 to 100."
    )


def test_an_empty_class_has_no_distribution() -> None:
    assert distribution([], 100) is None


def test_checks_are_counted_over_those_who_came_through() -> None:
    entries = [plain.entry(of) for of in (plain.RIGHT, plain.HALF, plain.HALF, plain.CRASHED)]
    [tally] = tallies(entries)
    assert (tally.verdict.name, tally.failed, tally.share) == ("test_secret_gap", 2, 66.7)


@pytest.mark.parametrize("student", ["../up", "a b", "x#y?z%", "ü"])
def test_a_link_stays_in_the_folder_of_results(student: str) -> None:
    assert page_of(plain.entry(plain.RIGHT, Student(student))).count("/") == 2


def test_a_fault_of_ours_is_in_no_number() -> None:
    entries, faults = [plain.entry(plain.HALF)], [plain.entry(plain.FAULT, Student("unlucky"))]
    page = overview_page(plain.exercise(), entries, [], faults, grouped(entries, []))
    assert "<div><dt>students</dt><dd>1</dd></div>" in page
    assert "<div><dt>mean</dt><dd>6</dd></div>" in page
    assert "Not graded because of a fault on our side" in page
    assert "the disk is full" in page
