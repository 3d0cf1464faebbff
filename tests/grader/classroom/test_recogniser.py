"""A format is taken only if nearly everything fits; a single name decides nothing."""

from __future__ import annotations

import re
import zipfile
from pathlib import Path

import pytest
from classes import archive, collected, files, folder

from grader.classroom.deadline import Adjuster
from grader.classroom.decisions import decisions
from grader.classroom.roster import RosterRow
from grader.classroom.submissions import SubmissionsError
from grader.grading.grade import Student

LURES = [
    "x_7_assignsubmission_file_node.py",
    "miller_12_34_node.py",
    "Lab_x_attempt_2026-11-20-22-01-00_node.py",
    "joint_velocity/node.py",
    "joint_velocity/timestamp.txt",
    "submitted/a/joint_velocity/node.py",
    "submission_metadata.yml",
    "12-34 - Eve Evil - Nov 20, 2020 1001 PM/node.py",
    "Lee, Ann(ann1)/node.py",
    "eve+joint_velocity+2026-11-20 22:01:00 UTC/node.py",
    "Lee, Ann(ann1)_Submission attachment(s)_node.py",
    "Lee_Ann_ann1_312/node.py",
]


@pytest.mark.parametrize("inside", ["", "eve/"])
@pytest.mark.parametrize("lure", LURES)
def test_one_students_names_decide_nothing_for_others(tmp_path: Path, lure: str, inside: str) -> None:
    others = ["anna.py", "bert/node.py", "carl/joint_velocity/joint_velocity.py", "dora.ipynb"]
    source = folder(tmp_path / "class", [*others, f"{inside}{lure}"])
    found = files(collected(source))
    assert {who: found.get(who) for who in ("anna", "bert", "carl", "dora")} == {
        "anna": "anna.py",
        "bert": "bert/node.py",
        "carl": "carl/joint_velocity/joint_velocity.py",
        "dora": "dora.ipynb",
    }


def test_names_inside_a_students_own_folder_date_nothing(tmp_path: Path) -> None:
    made = {f"s{n}/node.py": "" for n in range(3)} | {"eve/node.py": "", "eve/timestamp.txt": "2020-01-01 00:00 UTC"}
    eve = next(one for one in collected(folder(tmp_path / "class", made)).handed_in if one.student.id == "eve")
    assert eve.file.submitted_from == "the file's date"


@pytest.mark.parametrize(
    "names",
    [
        ["Week 3/anna.py", "Week 3/bert.py", "__MACOSX/Week 3/._anna.py", "Week 3/.DS_Store"],
        ["export/Week 3/anna/node.py", "export/Week 3/bert/node.py"],
    ],
)
def test_a_lone_folder_is_gone_through(tmp_path: Path, names: list[str]) -> None:
    found = collected(archive(tmp_path / "class.zip", names))
    assert list(files(found)) == ["anna", "bert"]
    assert found.kind.endswith("Week 3/")


def test_a_class_of_one_is_a_student_and_not_a_folder_around_a_class(tmp_path: Path) -> None:
    assert list(files(collected(folder(tmp_path / "a", ["anna/node.py", "anna/report.pdf"])))) == ["anna"]
    package = ["anna/ws/pkg/setup.py", "anna/ws/pkg/pkg/node.py", "anna/ws/pkg/package.xml"]
    assert list(files(collected(folder(tmp_path / "b", package)))) == ["anna"]


def test_what_is_half_a_platforms_is_asked_and_every_name_listed(tmp_path: Path) -> None:
    ours = [f"miller{n}_{n}_{n}_node.py" for n in range(6)]
    others = [f"student{n}.py" for n in range(5)]
    source = folder(tmp_path / "class", [*ours, *others])
    with pytest.raises(SubmissionsError, match="6 submissions have names as in a download from Canvas") as error:
        collected(source)
    assert all(name in str(error.value) for name in others)
    assert "--format canvas, or --format folder" in str(error.value)
    assert len(collected(source, format="folder").handed_in) == 11
    forced = collected(source, format="canvas")
    assert len(forced.handed_in) == 6
    assert [name for question in forced.questions for name in question.files] == others


def test_a_format_that_nothing_fits_is_refused(tmp_path: Path) -> None:
    source = folder(tmp_path / "class", ["anna.py", "bert.py"])
    with pytest.raises(
        SubmissionsError, match=re.escape("--format sakai: no file here has a name as in a download from Sakai")
    ):
        collected(source, format="sakai")


def test_a_package_is_one_submission_with_the_names_that_the_student_gave(tmp_path: Path) -> None:
    names = ["anna/ws/pkg/package.xml", "anna/ws/pkg/pkg/node.py", "anna/ws/pkg/setup.py", "bert.py"]
    anna, _ = collected(archive(tmp_path / "class.zip", names)).handed_in
    assert anna.file.name == "anna"
    assert sorted(file.relative_to(anna.file.path).as_posix() for file in anna.file.path.rglob("*.*")) == [
        "ws/pkg/package.xml",
        "ws/pkg/pkg/node.py",
        "ws/pkg/setup.py",
    ]


def test_a_copy_beside_a_students_file_is_not_another_student(tmp_path: Path) -> None:
    copies = ["anna.py", "anna (1).py", "Kopie von anna.py", "bert (1).py", "carl (1).py", "carl (2).py"]
    found = collected(folder(tmp_path / "class", copies))
    assert list(files(found)) == ["anna", "bert", "carl_1", "carl_2"]
    assert found.handed_in[0].file.path.is_dir()


def test_a_copy_of_a_file_with_its_owner_before_it_is_that_owners(tmp_path: Path) -> None:
    names = ["Anna Lee - node.py", "Bert K - node.py", "Bert K - node (1).py", "#anna.py#", "~$x.docx", "README.txt"]
    assert list(files(collected(folder(tmp_path / "class", names)))) == ["Anna_Lee", "Bert_K"]


def test_a_class_that_handed_in_another_language_has_its_rows(tmp_path: Path) -> None:
    made = {"anna.cpp": "", "bert.rs": "", "carl.txt": "import rclpy\n", "dora.html": "<html>", "emil.md": "# Mine"}
    found = collected(folder(tmp_path / "class", made))
    assert list(files(found)) == ["anna", "bert", "carl", "dora", "emil"]
    assert found.notes == ("handed in, but not one of .py, .ipynb, .zip: anna.cpp, bert.rs, dora.html, emil.md",)


def test_a_file_named_after_the_exercise_is_nobodys(tmp_path: Path) -> None:
    why = "it is named after the exercise, not after a student"
    found = collected(folder(tmp_path / "class", ["anna.py", "Joint Velocity (1).ipynb"]))
    assert list(files(found)) == ["anna"]
    assert [str(question) for question in found.questions] == [f"Joint Velocity (1).ipynb: {why}"]
    with pytest.raises(SubmissionsError, match=rf"no submission in it\.\n  joint_velocity\.py: {why}"):
        collected(archive(tmp_path / "one.zip", ["joint_velocity.py"]))


def test_a_students_folder_without_a_file_is_named(tmp_path: Path) -> None:
    source = folder(tmp_path / "class", ["anna/node.py", "bert/.git/HEAD"])
    (source / "carl").mkdir()
    skipped = {one.file: one.why for one in collected(source).skipped}
    assert {who: skipped[who] for who in ("bert", "carl")} == dict.fromkeys(("bert", "carl"), "a folder without a file")


@pytest.mark.parametrize(
    ("names", "listed", "asked"),
    [
        (
            ["week1-anna.py", "week1-bert.py"],
            ["anna", "bert"],
            ["they have no name in common: anna is on the roster, week1-anna handed in"],
        ),
        (["0042.py", "bert.py"], ["42", "bert"], ["42 is on the roster, 0042 handed in"]),
        (["0042.py", "bert.py"], ["0042", "carl"], []),
        (["week1-anna.py", "bert.py"], ["anna", "bert"], ["anna is on the roster, week1-anna handed in"]),
        (["7_Lee_Anna.py", "bert.py"], ["7", "bert"], ["7 is on the roster, 7_Lee_Anna handed in"]),
        (
            ["Jorg_Muller.py", "bert.py"],
            ["Jörg Müller", "bert"],
            ["Jörg Müller is on the roster, Jorg_Muller handed in"],
        ),
        (["jmueller.py", "bert.py"], ["Jörg Müller", "bert"], ["Jörg Müller is on the roster, jmueller handed in"]),
        (
            ["Jörg Müller.py", "bert.py"],
            ["jmueller", "bert"],
            ["jmueller is on the roster, Jörg Müller handed in"],
        ),
        (["ana.py", "bert.py"], ["anna", "bert"], ["anna is on the roster, ana handed in"]),
        (["s12345.py", "Anna Lee.py", "bert.py"], ["s12346", "Anna Braun", "bert"], []),
    ],
)
def test_a_roster_with_other_names_than_the_files_is_a_question(
    names: list[str], listed: list[str], asked: list[str], tmp_path: Path
) -> None:
    found = collected(folder(tmp_path / "class", names), roster=tuple(RosterRow(Student(one)) for one in listed))
    assert [*dict.fromkeys(found.mismatches.values())] == asked
    assert any("the roster seems to name" in one.what for one in decisions(found, Adjuster(), {})) == bool(asked)


@pytest.mark.parametrize(
    ("names", "noted"),
    [
        (["week1-anna", "week2-anna", "week1-bert"], ["week1-anna, week2-anna"]),
        (["Lee A - 2026-11-20", "Lee A - 2026-11-21", "Lee B"], ["Lee A - 2026-11-20, Lee A - 2026-11-21"]),
        (["Anna", "anna", "bert"], ["Anna, anna"]),
        (["team-1", "team-2", "team-3"], []),
        (["s1", "s2", "anna_123456", "anna_123457"], []),
    ],
)
def test_names_that_may_be_one_students_are_said_to_be_several(
    names: list[str], noted: list[str], tmp_path: Path
) -> None:
    found = collected(folder(tmp_path / "class", [f"{name}.py" for name in names]))
    notes = [f"counted as 2 students: {same}. Rename the files if they are one student's" for same in noted]
    assert (len(found.handed_in), list(found.notes)) == (len(names), notes)


def test_a_table_beside_the_folder_of_a_class_does_not_make_it_a_student(tmp_path: Path) -> None:
    found = collected(folder(tmp_path / "class", ["week 3/anna.py", "week 3/bert.py", "grades.csv", "README.md"]))
    assert list(files(found)) == ["anna", "bert"]
    assert [skip.file for skip in found.skipped] == ["README.md", "grades.csv"]


def test_of_several_assignments_none_is_taken_by_chance(tmp_path: Path) -> None:
    names = ["submitted/anna/ps1/a.ipynb", "submitted/anna/ps2/a.ipynb", "submitted/bert/ps1/a.ipynb"]
    with pytest.raises(SubmissionsError, match=r"has the assignments ps1, ps2, and none is called joint_velocity\."):
        collected(folder(tmp_path / "a", names))
    named = [name.replace("ps1", "Joint_Velocity") for name in names]
    assert list(files(collected(folder(tmp_path / "b", named)))) == ["anna", "bert"]


def test_nbgraders_exchange_has_a_folder_for_each_attempt(tmp_path: Path) -> None:
    made = [f"inbound/{who}+joint_velocity+2026-11-2{n} 10:00:00 UTC+x1/a.ipynb" for n in (1, 2) for who in "ab"]
    source = folder(tmp_path / "class", [*made, "inbound/a+ps2+2026-11-21 10:00:00 UTC/a.ipynb"])
    assert [question.unclear for question in collected(source).questions] == ["attempts", "attempts"]
    last = collected(source, attempts="last")
    assert files(last) == {"a": made[2], "b": made[3]}
    assert [str(one.file.submitted) for one in last.handed_in] == ["2026-11-22 10:00:00+00:00"] * 2


def test_brightspace_may_write_files_without_folders_and_groups(tmp_path: Path) -> None:
    flat = [f"{n}-7 - {who} - Nov 20, 2026 1001 PM - node.py" for n, who in enumerate(("Anna M", "Bert-Ole B"))]
    found = collected(archive(tmp_path / "a.zip", flat))
    assert files(found) == {"Anna_M_0": flat[0], "Bert-Ole_B_1": flat[1]}
    groups = [f"Group {n} - Nov 20, 2026 100{n} PM/node.py" for n in (1, 2)]
    assert list(files(collected(archive(tmp_path / "b.zip", groups)))) == ["Group_1", "Group_2"]


@pytest.mark.filterwarnings("ignore:Duplicate name")
def test_of_two_files_of_one_name_in_a_zip_none_replaces_the_other(tmp_path: Path) -> None:
    with zipfile.ZipFile(tmp_path / "class.zip", "w") as out:
        for name in ("anna.py", "anna.py", "bert.py"):
            out.writestr(name, "")
    (question,) = collected(tmp_path / "class.zip").questions
    assert str(question) == "anna handed in anna.py: the archive holds several files of this name"
