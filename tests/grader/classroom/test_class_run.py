"""A class is graded with one command: its results, what is done once, what is different, what is not a score."""

from __future__ import annotations

import csv
import fcntl
import json
import os
import re
import shutil
import zipfile
from pathlib import Path

import jsonschema
import pytest
from prepared_python import run_prepared
from small_class import POINTS, ROOT, SmallClass

from grader.classroom.formats.registry import TABLES
from grader.exercise import load
from grader.exercise.mistakes import mistakes_of

SCHEMA = json.loads((ROOT / "docs" / "grade.schema.json").read_text(encoding="utf-8"))


#: What a class's results have besides the students' folders and the solution's recordings.
CLASS_FILES = {".lock", "index.html", "grades.csv", "junit.xml", *(table.file for table in TABLES)}


def files_for_the_class(results: Path) -> set[str]:
    """Return the names of the files, without the solution's recordings."""
    return {file.name for file in results.iterdir() if file.is_file() and not file.name.startswith("reference-")}


@pytest.fixture
def done(graded: tuple[SmallClass, str], tmp_path: Path) -> SmallClass:
    """A graded class for this test alone."""
    small = object.__new__(SmallClass)
    small.__dict__ |= vars(graded[0])
    small.folder = shutil.copytree(graded[0].folder, tmp_path / "course")
    small.exercise = small.folder / "exercises" / graded[0].exercise.name
    small.submissions = small.folder / "submissions"
    return small


def test_everybody_gets_what_is_theirs_whatever_others_hand_in(graded: tuple[SmallClass, str]) -> None:
    small, printed = graded
    assert small.finals() == POINTS
    assert small.entry("fay")["grade"]["outcome"] == "did-not-start"
    assert "6 students in a folder with one file (or one folder) per student." in printed
    assert "fay: 0 of 20 points (did-not-start)" in printed
    assert "6 grades: median 16 of 20 points, 2 with full marks." in printed


def test_grades_of_another_exercise_are_never_replaced(done: SmallClass) -> None:
    other = done.folder / "exercises" / "other"
    shutil.copytree(done.exercise, other)
    shutil.copytree(done.folder / "solutions" / done.exercise.name, done.folder / "solutions" / "other")
    before = {student: done.entry(student) for student in POINTS}
    said = run_prepared("grader", "other", "submissions", "--out", "results", cwd=done.folder, env=done.environment)
    assert said.returncode == 2
    assert "holds the grades of the exercise" in said.stderr
    assert "Give each exercise a folder of its own with --out." in said.stderr
    assert {student: done.entry(student) for student in POINTS} == before


def test_each_grade_is_as_the_published_schema_says(graded: tuple[SmallClass, str]) -> None:
    validator = jsonschema.Draft202012Validator(SCHEMA)
    for student in POINTS:
        assert list(validator.iter_errors(graded[0].entry(student))) == []


def test_all_files_lie_where_they_are_looked_for(graded: tuple[SmallClass, str]) -> None:
    results = graded[0].folder / "results"
    assert files_for_the_class(results) == CLASS_FILES
    for student in POINTS:
        there = {file.name for file in (results / "students" / student).iterdir()}
        assert there - {"plot.svg", "recordings.json.gz"} == {"feedback.html", "grade.json", "results.json"}


def test_students_stand_under_the_mistakes_that_they_make(graded: tuple[SmallClass, str]) -> None:
    page = (graded[0].folder / "results" / "index.html").read_text(encoding="utf-8")
    groups = re.findall(r"<summary><b>(\d+)</b> students?: (.*?)</summary>(.*?)</details>", page, re.DOTALL)
    found = {what: re.findall(r'href="students/(\w+)/feedback.html"', names) for _, what, names in groups}
    assert found == {
        "It limits the speed forwards, but not backwards.": ["carl", "emil"],
        "It never checks whether the speed is a number.": ["dora"],
        "What is not a number becomes 1 m/s.": ["emil"],
    }


def test_for_the_overview_only_mistakes_are_graded_that_may_explain_a_failure(
    graded: tuple[SmallClass, str], cache: Path
) -> None:
    kept = {file.name.split("-")[1]: json.loads(file.read_text()) for file in (cache / "mistakes").iterdir()}
    mistakes = {mistake.name: mistake for mistake in mistakes_of(load(graded[0].exercise))}
    assert kept.keys() == {"only_forwards", "trusts_every_number", "full_speed_for_no_number"}
    assert {name: set(failures) for name, failures in kept.items()} == {
        name: set(mistakes[name].caught_by) for name in kept
    }


def test_what_is_unchanged_is_not_graded_again(done: SmallClass) -> None:
    before = {file: file.read_bytes() for file in (done.folder / "results").rglob("*") if file.is_file()}
    code, printed = done.grade()
    assert code == 0, printed
    assert "6 unchanged since they were graded." in printed
    assert {file: file.read_bytes() for file in (done.folder / "results").rglob("*") if file.is_file()} == before


def test_what_changed_is_graded_again_and_the_difference_is_reported(done: SmallClass) -> None:
    done.hand_in("carl", (done.submissions / "ana.py").read_text(encoding="utf-8") + "# carl\n")
    code, printed = done.grade()
    assert code == 0, printed
    assert "5 unchanged since they were graded." in printed
    assert "1/1 carl: 15 -> 20 points; up: test_too_fast_backwards (+5)" in printed
    assert done.finals() == {**POINTS, "carl": 20}


def test_regrade_grades_one_student_again_though_nothing_changed(done: SmallClass) -> None:
    kept = done.folder / "results" / "students" / "dora" / "grade.json"
    entry = json.loads(kept.read_text(encoding="utf-8"))
    for verdict in entry["grade"]["verdicts"]:
        # As an older, mistaken version might have judged.
        if verdict["name"] == "test_not_a_number":
            verdict |= {"status": "passed", "earned": 3, "finding": None}
        if verdict["name"] in ("test_safe_speeds_pass", "test_node_is_as_described"):
            verdict |= {"status": "failed", "earned": 0}
    entry["grade"]["score"] = 17
    kept.write_text(json.dumps(entry), encoding="utf-8")
    code, printed = done.grade("--regrade", "dora")
    assert code == 0, printed
    assert "5 unchanged" in printed
    up = "up: test_safe_speeds_pass (+1), test_node_is_as_described (+2)"
    assert f"dora: 17 -> 17 points; {up}; down: test_not_a_number (-3)" in printed
    code, printed = done.grade("--regrade", "nobody")
    assert code == 2
    assert '--regrade nobody: no submission from a student called "nobody".' in printed


def test_a_fault_of_ours_is_tried_again_listed_apart_and_never_scored(done: SmallClass, tmp_path: Path) -> None:
    hidden = done.exercise / "hidden_checks.py"
    right = hidden.read_text(encoding="utf-8")
    tries = tmp_path / "tries"
    breaks = f"""    if any(message.data < -100 for message in backwards.received):
        with open({str(tries)!r}, "a") as file:
            file.write("x")
        raise RuntimeError("the check has a hole")
    backwards.must_match("data")"""
    hidden.write_text(right.replace('    backwards.must_match("data")', breaks), encoding="utf-8")
    forwards = (done.submissions / "carl.py").read_text(encoding="utf-8")
    done.hand_in("carl", forwards.replace("min(LIMIT, message.data)", "min(LIMIT, message.data * 1000)"))
    for name in ("bert", "dora", "emil"):
        (done.submissions / f"{name}.py").unlink()
    code, printed = done.grade()
    assert code == 3, printed
    assert "not graded, because of a fault of Spinbook or the machine: carl" in printed
    assert "the check has a hole" in printed
    assert tries.read_text() == "xx", "tried once more, and no oftener"
    assert "graded earlier, handed in nothing now, not in the tables: bert, dora, emil" in printed
    assert done.finals() == {**POINTS, "carl": None}
    page = (done.folder / "results" / "index.html").read_text(encoding="utf-8")
    assert "Not graded because of a fault on our side" in page
    with (done.folder / "results" / "grades.csv").open(encoding="utf-8-sig") as file:
        points = {row["student"]: row["points"] for row in csv.DictReader(file)}
    assert points == {"ana": "20", "carl": "", "fay": "0"}
    hidden.write_text(right, encoding="utf-8")
    code, printed = done.grade()
    assert code == 0, printed
    assert done.finals()["carl"] is not None


def test_two_programs_of_one_student_are_a_question(done: SmallClass) -> None:
    (done.submissions / "ana").mkdir()
    shutil.copy(done.submissions / "carl.py", done.submissions / "ana" / "other.py")
    code, printed = done.grade()
    assert code == 1
    assert "1 submission: what to run is not clear:" in printed
    assert "Nothing was graded. Decide, or grade all others with --skip." in printed
    assert done.finals() == POINTS, "what was graded stays"
    code, printed = done.grade("--skip")
    assert code == 1
    assert "5 unchanged since they were graded." in printed
    assert done.finals() == {**POINTS, "ana": None}
    assert "Waiting for your decision" in (done.folder / "results" / "index.html").read_text(encoding="utf-8")


def test_late_work_loses_and_a_changed_due_date_needs_no_grading(done: SmallClass, cache: Path) -> None:
    stored = set(cache.rglob("*"))
    # They were submitted from 2026-11-18 11:06:40 UTC on.
    settings = done.exercise / "exercise.toml"
    rule = '\n[deadline]\ndue = 2026-11-17T12:00:00Z\npenalty = "10 % a day up to 50 %"\n'
    settings.write_text(settings.read_text(encoding="utf-8") + rule, encoding="utf-8")
    wishes = done.folder / "overrides.csv"
    wishes.write_text(
        "student,points,due,reason\nana,,2026-11-19 12:00,was ill\ncarl,+3,,found a mistake in the task\n"
    )
    code, printed = done.grade("--overrides", str(wishes))
    assert code == 0, printed
    assert "6 unchanged since they were graded." in printed
    assert done.finals() == {"ana": 20, "bert": 18, "carl": 16.5, "dora": 15.3, "emil": 10.8, "fay": 0}
    assert set(cache.rglob("*")) == stored, "nor was the solution or a mistake run again"
    reasons = [adjustment["reason"] for adjustment in done.entry("carl")["adjustments"]]
    assert reasons[0].startswith("handed in 23 h 10 min late, by the file's date: 10 % of 15 points")
    assert reasons[1] == "found a mistake in the task"
    assert "was ill" in (done.folder / "results" / "students" / "ana" / "feedback.html").read_text(encoding="utf-8")
    for file in done.submissions.iterdir():
        os.utime(file, (1_795_000_000,) * 2)
    code, printed = done.grade()
    assert code == 1
    assert "All files have one date, 2026-11-18 11:06 +0000: that of a copy, not of a submission." in printed


def test_a_mistake_in_the_overrides_is_reported_with_its_line(done: SmallClass) -> None:
    wishes = done.folder / "overrides.csv"
    wishes.write_text("student,points,reason\nana,18,\n")
    code, printed = done.grade("--overrides", str(wishes))
    assert code == 2
    assert "overrides.csv:2: the reason is missing." in printed
    assert "Traceback" not in printed
    wishes.write_text("student,due,reason\nana,2026-11-24,ill\n")
    assert "ana has another due date, but exercise.toml has no [deadline]." in done.grade("--overrides", str(wishes))[1]


def test_whom_the_roster_may_name_otherwise_waits_and_gets_no_zero(done: SmallClass) -> None:
    roster = done.folder / "roster.csv"
    roster.write_text("student\nana\nbert\ncarl\ndora\nemil\nfay_lee\ngus\n")
    code, printed = done.grade("--roster", str(roster), "--skip")
    assert code == 1
    assert "needs your decision: fay_lee: fay_lee is on the roster, fay handed in" in printed
    assert done.finals() == {**POINTS, "fay_lee": None, "gus": 0}


def test_two_gradings_never_write_into_one_folder(done: SmallClass) -> None:
    with (done.folder / "results" / ".lock").open("w") as lock:
        fcntl.flock(lock, fcntl.LOCK_EX)
        code, printed = done.grade()
    assert code == 2
    assert "another grading is writing to this folder" in printed


#: File names that are also names of files in the results, that have a meaning in a spreadsheet, a page, a terminal or
#: a shell, or that no text can contain.
HOSTILE_NAMES = (
    *("index.html", "grades.csv", "junit.xml", "students", "plot.svg", *(table.file for table in TABLES)),
    *("=HYPERLINK(1)", "<script>alert(1)<_script>", "[bold]red[_bold]", "\x1b[2J", "a\nb", "\udcff", "-rf", "--out"),
    *("CON", "$(reboot)", "%s%n", "\u202egnp", "x" * 240, "\u00e9" * 100, "{{ 7 * 7 }}"),
)


def test_no_name_of_a_student_and_no_fault_in_one_stops_a_class(small_class: SmallClass) -> None:
    right = (small_class.submissions / "ana.py").read_text(encoding="utf-8")
    for file in small_class.submissions.iterdir():
        file.unlink()
    names = [*HOSTILE_NAMES, "student00", "student01"]
    for name in names:
        small_class.hand_in(name, right if name in ("students", "-rf") else "")
    results = small_class.folder / "results"
    (results / "students").mkdir(parents=True)
    (results / "students" / "student00").write_text("no folder can be made here")
    code, printed = small_class.grade()
    assert code == 3, printed
    assert f"{len(names) - 1} grades: median 0 of" in printed
    assert "not graded, because of a fault of Spinbook or the machine: student00" in printed
    kept = {file.parent.name for file in results.glob("students/*/grade.json")}
    assert len(kept) == len(names) - 1
    assert {"index.html", "grades.csv", "junit.xml", "students"} < kept
    with (results / "grades.csv").open(encoding="utf-8-sig", newline="") as grades:
        assert sorted(row["points"] for row in csv.DictReader(grades)) == ["", *["0"] * (len(kept) - 2), "20", "20"]
    page = (results / "index.html").read_text(encoding="utf-8")
    assert 'href="students/index.html/feedback.html"' in page


def test_changed_checks_judge_what_was_recorded_and_replace_nothing_unasked(done: SmallClass) -> None:
    checks = done.exercise / "hidden_checks.py"
    text = checks.read_text(encoding="utf-8")
    weaker = text.replace('    backwards.must_match("data")', "    assert backwards.received")
    assert weaker != text
    checks.write_text(weaker, encoding="utf-8")
    done.hand_in("bert", "changed = True\n")
    code, printed = done.grade("--rejudge")
    assert code == 0, printed
    assert "carl: 15 -> 20 points; up: test_too_fast_backwards (+5)" in printed
    assert "emil: 12 -> 17 points; up: test_too_fast_backwards (+5)" in printed
    assert "no recordings that fit, so grade them without --rejudge: bert" in printed
    assert "Nothing was replaced." in printed
    assert done.finals() == POINTS
    code, printed = done.grade("--rejudge", "--yes", "--publish")
    assert code == 0, printed
    assert done.finals() == {**POINTS, "carl": 20, "emil": 17}
    zips = done.folder / "results" / "to-students"
    assert {file.stem for file in zips.iterdir()} == set(POINTS)
    with zipfile.ZipFile(zips / "carl.zip") as archive:
        assert archive.namelist() == ["speed_limit/feedback.html"]
        assert b"20" in archive.read("speed_limit/feedback.html")
    done.hand_in("bert", (done.submissions / "ana.py").read_text(encoding="utf-8"))
    code, printed = done.grade()
    assert "5 unchanged since they were graded." in printed, "the new grades are as good as others"
