"""Pages in a real browser: nothing that a student writes can do anything there, and everyone can read them."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import plain_grades as plain
import pytest
from browser import opened
from graded_class import EXTRA, LATE, WHEN, entry
from playwright.sync_api import Browser, expect

from grader.classroom.course_gradebook import GradedExercise, course_page, course_rows
from grader.classroom.misconceptions import Signature, failures_of, grouped
from grader.classroom.overview import overview_page
from grader.exercise import Exercise
from grader.grading import Grade
from grader.grading.grade import Entry, SkippedFile, Student
from grader.report.feedback import feedback_page
from grader.report.feedback_plot import feedback_plot

EVIL = (
    "</title></script><script>window.pwned=9</script>"
    '<img src="http://example.org/x.png" onerror="window.pwned=8">\u202e'
)


@pytest.fixture(scope="module")
def site(graded: dict[str, Grade], exercise: Exercise, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder of results: index.html and one page per student, one of whom is hostile in every field."""
    names = {"solution": "Grace Hopper", "fixed_dt": "Jörg Müller", "breaks_pages": EVIL}
    entries = [entry(grade, names.get(name, "Ada Lovelace")) for name, grade in graded.items() if name != "host_error"]
    entries = [
        replace(one, student=Student("../a b#?%", EVIL), file=EVIL, adjustments=(replace(LATE, reason=EVIL), EXTRA))
        if one.student.name == EVIL
        else one
        for one in entries
    ]
    faults = [entry(graded["host_error"], "Unlucky Person")]
    dt = Signature(("fixed_dt",), ("dt is always 0.1 s.",), failures_of(graded["fixed_dt"]))
    skipped = [SkippedFile(f"s77/{EVIL}", EVIL)]
    page = overview_page(exercise, entries, skipped, faults, grouped(entries, [dt]))
    results = tmp_path_factory.mktemp("results")
    (results / "index.html").write_text(page, encoding="utf-8")
    for number, one in enumerate([*entries, *faults]):
        folder = results / "students" / (f"evil{number}" if one.student.name == EVIL else one.student.id)
        folder.mkdir(parents=True)
        page = feedback_page(one, exercise, feedback_plot(one.grade, exercise))
        (folder / "feedback.html").write_text(page, encoding="utf-8")
    return results


#: A student of each kind: full marks, mistakes and a plot, a run that broke off, a hostile one, a fault of ours.
KINDS = ("s-solution", "s-fixed_dt", "s-crashes_at_message_37", "evil*", "s-unlucky")


def pages(site: Path) -> list[Path]:
    """Return the class's page, and one of each kind of students'."""
    return [site / "index.html", *(page for kind in KINDS for page in site.glob(f"students/{kind}/feedback.html"))]


def test_no_page_runs_or_requests_what_a_student_wrote(browser: Browser, site: Path) -> None:
    with opened(browser, site / "index.html") as shown:
        for page in pages(site):
            shown.show(page)
            assert shown.page.evaluate("window.pwned") is None
            assert shown.faults == []
            assert shown.page.locator("script").count() == (1 if page.name == "index.html" else 0)


def test_the_policy_stops_a_script_even_if_one_got_in(browser: Browser, site: Path) -> None:
    for page in (site / "index.html", site / "students" / "s-solution" / "feedback.html"):
        forced = page.with_name(f"forced-{page.name}")
        html = page.read_text(encoding="utf-8").replace("</main>", "<script>window.pwned = 1</script></main>")
        forced.write_text(html, encoding="utf-8")
        with opened(browser, forced) as shown:
            assert shown.page.evaluate("window.pwned") is None
            assert any("Content Security Policy" in fault for fault in shown.faults)


@pytest.mark.parametrize(("width", "dark"), [pytest.param(1280, False, marks=pytest.mark.soak), (390, True)])
def test_everybody_can_read_them_at_a_desk_and_on_a_phone(browser: Browser, site: Path, width: int, dark: bool) -> None:
    with opened(browser, site / "index.html", width=width, dark=dark) as shown:
        for page in pages(site):
            shown.show(page)
            shown.page.evaluate("document.querySelectorAll('details').forEach((details) => (details.open = true))")
            assert shown.violations() == [], page
            assert not shown.scrolls_sideways(), page


def test_the_class_at_a_glance(browser: Browser, site: Path) -> None:
    with opened(browser, site / "index.html") as shown:
        page = shown.page
        chart = page.get_by_role("img", name="Histogram")
        assert "students' points" in (chart.get_attribute("aria-label") or "")
        group = page.locator("details", has_text="2 students: dt is always 0.1 s.")
        group.locator("summary").click()
        expect(group.get_by_role("link", name="Jörg Müller")).to_be_visible()
        expect(page.get_by_role("region", name="Not graded because of a fault on our side")).to_contain_text(
            "Unlucky Person"
        )
        expect(page.get_by_role("region", name="Skipped")).to_contain_text("s77/")
        expect(page.get_by_role("region", name="Most failed checks")).to_contain_text(
            "Velocities are right when the messages arrive at uneven times"
        )


def test_a_row_opens_the_students_page(browser: Browser, site: Path) -> None:
    with opened(browser, site / "index.html") as shown:
        row = shown.page.get_by_role("row", name="Jörg Müller")
        cell = row.locator("td.number").first
        cell.scroll_into_view_if_needed()
        box = cell.bounding_box()
        assert box
        # The link of its row covers every cell: the click goes to a position.
        shown.page.mouse.click(box["x"] + box["width"] / 2, box["y"] + box["height"] / 2)
        shown.page.wait_for_url("**/s-fixed_dt/feedback.html")
        expect(shown.page.get_by_role("heading", level=1)).to_have_text("Jörg Müller")


def test_the_table_is_sorted_by_a_click_and_is_in_order_without_script(browser: Browser, site: Path) -> None:
    def column(number: int, rows: Callable[[], list[str]]) -> list[str]:
        return [row.split("\t")[number].strip() for row in rows()]

    with opened(browser, site / "index.html") as shown:
        table = shown.page.locator("table.sortable")

        def rows() -> list[str]:
            return [row.inner_text() for row in table.locator("tbody tr").all()]

        names = column(0, rows)
        assert names == sorted(names, key=str.casefold)
        for descending in (False, True):
            shown.page.get_by_role("button", name="Points").click()
            points = [float(value) for value in column(1, rows)]
            assert points == sorted(points, reverse=descending)


def test_a_student_of_any_id_has_a_link_that_stays_in_the_results(browser: Browser, site: Path) -> None:
    with opened(browser, site / "index.html") as shown:
        links = [link.get_attribute("href") or "" for link in shown.page.locator("tbody a").all()]
        assert "students/..%2Fa%20b%23%3F%25/feedback.html" in links
        assert all(link.count("/") == 2 for link in links)


def test_an_empty_class_has_a_page_too(browser: Browser, exercise: Exercise, tmp_path: Path) -> None:
    none: list[Entry] = []
    (tmp_path / "index.html").write_text(overview_page(exercise, none, [], none, grouped(none, [])), encoding="utf-8")
    with opened(browser, tmp_path / "index.html") as shown:
        assert shown.faults == []
        expect(shown.page.get_by_role("main")).to_contain_text("Nobody has a score yet.")


def test_times_are_shown_in_their_own_zone(browser: Browser, site: Path) -> None:
    assert WHEN.utcoffset()
    with opened(browser, site / "index.html") as shown:
        expect(shown.page.get_by_role("row", name="Jörg Müller")).to_contain_text("20 Nov 2026, 23:41 +01:00")


def test_a_printed_feedback_page_is_one_sheet(browser: Browser, site: Path) -> None:
    with opened(browser, site / "index.html") as shown:
        for page in [page for page in pages(site) if page.parent.name.startswith("s-")]:
            shown.show(page)
            assert shown.page.pdf(format="A4").count(b"/Type /Page\n") <= 1, page.parent.name


def test_the_table_of_nine_exercises_fits_on_a_desk(browser: Browser, tmp_path: Path) -> None:
    names = "joint_velocity heartbeat go_to_goal motor_switch calibrate_joint move_joint motion_operator joint_filter"
    graded = {"s1": plain.entry(plain.HALF, Student("s1", "Grace Brewster Murray Hopper"))}
    exercises = [GradedExercise(name, name, 10.0, graded) for name in [*names.split(), "robot_description"]]
    page = tmp_path / "index.html"
    page.write_text(course_page("Humanoids", exercises, course_rows(exercises)), encoding="utf-8")
    with opened(browser, page) as shown:
        assert shown.page.locator(".scroll").evaluate("place => place.scrollWidth <= place.clientWidth")
