"""What only the instructor can decide is asked before anything is graded; what is decided is as it was said."""

from __future__ import annotations

import csv
import subprocess
import sys
from pathlib import Path

import pytest
from click.testing import CliRunner
from small_class import SmallClass

from grader.classroom.replay import replay
from grader.classroom.results import Results

ON_TIME, LATE = "2026-11-20-10-00-00", "2026-11-20-14-00-00"


@pytest.fixture
def several(small_class: SmallClass) -> SmallClass:
    """A class on Blackboard with several attempts, a pair, a student with two files and one with nothing."""
    sources = {file.stem: file.read_text(encoding="utf-8") for file in small_class.submissions.iterdir()}
    for file in small_class.submissions.iterdir():
        file.unlink()

    def attempt(student: str, when: str, source: str, file: str = "node") -> None:
        small_class.hand_in(f"Lab_1_{student}_attempt_{when}_{file}", sources[source])

    attempt("ana", ON_TIME, "carl")
    attempt("ana", LATE, "ana")
    attempt("bert", ON_TIME, "fay")
    attempt("bert", LATE, "bert")
    attempt("carl", ON_TIME, "dora")
    attempt("emil", ON_TIME, "ana", "one")
    attempt("emil", ON_TIME, "carl", "two")
    (small_class.folder / "groups.csv").write_text("group,student\npair,carl\npair,dora\n")
    (small_class.folder / "roster.csv").write_text(
        "student,name,email\n" + "".join(f"{who},{who.title()},{who}@example.org\n" for who in ("ana", "bert", "zoe"))
    )
    settings = small_class.exercise / "exercise.toml"
    rule = '\n[deadline]\ndue = 2026-11-20T12:00:00\nzone = "Europe/Berlin"\npenalty = "50 % a day"\n'
    settings.write_text(settings.read_text(encoding="utf-8") + rule, encoding="utf-8")
    return small_class


OPTIONS = ("--groups", "groups.csv", "--roster", "roster.csv")


def test_nothing_is_graded_before_everything_is_decided(several: SmallClass) -> None:
    code, printed = several.grade(*OPTIONS)
    assert code == 1, printed
    lines = printed.splitlines()
    assert lines[0] == "5 students in a download from Blackboard, with 4 submissions."
    assert "1 student handed in nothing: zoe" in printed
    assert "not on the roster: carl, dora, emil" in printed
    assert "Deadline: due 2026-11-20 12:00 +0100, days by the calendar of Europe/Berlin." in printed
    assert "2 students handed in several times:" in printed
    assert f"bert handed in 2 attempts: Lab_1_bert_attempt_{ON_TIME}_node.py" in printed
    assert "--attempts last, first or best" in printed
    assert "1 submission: what to run is not clear:" in printed
    assert not (several.folder / "results").exists()


def test_the_best_attempt_is_that_with_the_most_points_late_or_not(several: SmallClass) -> None:
    code, printed = several.grade(*OPTIONS, "--attempts", "best", "--skip")
    assert code == 1, printed
    assert several.finals() == {"ana": 15, "bert": 10, "carl": 17, "dora": 17, "emil": None, "zoe": 0}
    outcomes = {who: several.entry(who)["grade"]["outcome"] for who in several.finals()}
    assert (outcomes["emil"], outcomes["zoe"]) == ("undecided", "missing")
    with (several.folder / "results" / "grades.csv").open(encoding="utf-8-sig", newline="") as file:
        rows = {row["student"]: row for row in csv.DictReader(file)}
    assert {who: row["points"] for who, row in rows.items()} == {
        **{"ana": "15", "bert": "10", "carl": "17", "dora": "17", "emil": "", "zoe": "0"},
    }
    assert rows["ana"]["email"] == "ana@example.org"
    assert rows["ana"]["file"] == f"Lab_1_ana_attempt_{ON_TIME}_node.py"
    page = (several.folder / "results" / "index.html").read_text(encoding="utf-8")
    assert "Waiting for your decision" in page
    assert "nothing handed in" in page

    code, printed = several.grade(*OPTIONS, "--attempts", "best", "--skip")
    assert "4 unchanged since they were graded." in printed
    assert several.finals()["ana"] == 15
    code, printed = several.grade(*OPTIONS, "--attempts", "last", "--skip")
    assert several.finals() == {"ana": 10, "bert": 10, "carl": 17, "dora": 17, "emil": None, "zoe": 0}


def test_canvas_costs_nobody_on_time_points_and_late_work_needs_a_date(several: SmallClass) -> None:
    for file in several.submissions.iterdir():
        file.unlink()
    right = "import rclpy\n\nrclpy.spin(\n"
    several.hand_in("ana_1_10_node", right)
    several.hand_in("bert_LATE_2_11_node", right)
    code, printed = several.grade()
    assert code == 1, printed
    assert "the dates of 1 submission are unknown, 1 student marked as late" in printed
    assert "bert_2: bert_LATE_2_11_node.py" in printed
    assert "Canvas writes no dates" in printed
    roster = several.folder / "roster.csv"
    roster.write_text("student,submitted\nbert_2,2026-11-20 13:00\nana_1,\n")
    code, printed = several.grade("--roster", "roster.csv")
    assert code == 0, printed
    assert "Nothing was graded" not in printed
    assert several.entry("ana_1")["adjustments"] == []
    assert several.entry("bert_2")["submitted"] == "2026-11-20T13:00:00+01:00"
    assert several.entry("bert_2")["adjustments"][0]["reason"].startswith("handed in 1 h 0 min late, by the roster")


@pytest.mark.parametrize("out", ["a_file", "a_file/results", "/proc/spinbook/results", "/sys/spinbook"])
def test_results_that_can_not_be_written_are_a_sentence(small_class: SmallClass, out: str) -> None:
    (small_class.folder / "a_file").write_text("")
    code, printed = small_class.grade(out=out)
    assert code == 3, printed
    assert "the results can't be written" in printed
    assert "Traceback" not in printed
    assert (small_class.folder / "a_file").read_text() == ""


#: Grades a class three times, in one process: on a file system for the results that is too small, on a larger one, and
#: on one that can only be read. It is in a namespace of its own, inside which sandboxes do not work.
FULL = """
import subprocess
from grader.command import grade
for options in ("size=120k", "remount,size=20m", "remount,ro"):
    subprocess.run(["mount", "-t", "tmpfs", "-o", options, "tmpfs", "results"], check=True)
    try:
        grade(["speed_limit", "submissions", "--out", "results", "--isolation", "none"])
    except SystemExit as end:
        print("code", end.code, flush=True)
"""


@pytest.mark.skipif(
    subprocess.run(["unshare", "-Urm", "true"], capture_output=True).returncode != 0, reason="no user namespaces here"
)
def test_a_full_disk_stops_the_class_and_keeps_what_was_graded(small_class: SmallClass) -> None:
    (small_class.folder / "results").mkdir()
    done = subprocess.run(
        ["unshare", "-Urm", sys.executable, "-c", FULL],
        cwd=small_class.folder,
        env=small_class.environment,
        capture_output=True,
        text=True,
        timeout=240,
    )
    first, second, _ = done.stdout.split("code 3")
    second, third = second.split("code 0")
    assert "results: the results can't be written: No space left on device." in first
    assert "What was graded is kept." in first
    kept = first.count(" of 20 points")
    assert 0 < kept < 6
    assert f"{kept} unchanged since they were graded." in second or f"{kept - 1} unchanged" in second
    assert "6 grades: median 16 of 20 points, 2 with full marks." in second
    assert third.count("\n") == 2, "the first line, and nothing graded"
    assert "results can't be written: Read-only file system" in done.stderr
    assert "Traceback" not in done.stdout + done.stderr


def test_a_graded_run_is_replayed_without_running_anything(
    graded: tuple[SmallClass, str], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    small = graded[0]
    monkeypatch.chdir(small.folder)
    done = CliRunner().invoke(replay, ["results", "carl", "--out", str(tmp_path / "replay")])
    assert done.exit_code == 0, done.output
    assert "carl: 15 of 20 points" in done.output
    stored = Results(small.folder / "results").stored("carl")
    assert stored
    plots = {file.stem for file in (tmp_path / "replay" / "plots").iterdir()}
    bags = {file.name for file in (tmp_path / "replay" / "bags").iterdir()}
    assert plots == bags == set(stored.recordings)
    assert any("first wrong" in file.read_text() for file in (tmp_path / "replay" / "plots").iterdir())
    assert all((tmp_path / "replay" / "bags" / name / "metadata.yaml").exists() for name in bags)
    unknown = CliRunner().invoke(replay, ["results", "nobody"])
    assert unknown.exit_code == 2
    assert "no grade of a student called 'nobody' (there are: ana, bert, carl" in unknown.output
