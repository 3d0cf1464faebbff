"""Exports of thirty students, as each platform writes them: nobody is lost, doubled, or dated by a zip."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from datetime import datetime, timezone
from pathlib import Path

import pytest
from classes import archive, collected, files, folder

from grader.classroom.groups import read_groups
from grader.classroom.roster import read_roster

#: Names of the class: two are equal, one wants to be a formula, a page and a way out. Number 29 hands in for number 30.
HOSTILE = "=HYPERLINK(1) ..%s <b>"
NAMES = [
    "Anna Müller",
    "Anna Müller",
    HOSTILE,
    "Nguyễn Thị Ánh",
    "अंकिता शर्मा",
    *(f"Student S{n:02}" for n in range(6, 31)),
]
UTC = timezone.utc
FIRST, SECOND = datetime(2026, 11, 20, 22, 1, tzinfo=UTC), datetime(2026, 11, 21, 9, 5, tzinfo=UTC)


@dataclass(frozen=True)
class Exported:
    """An export: its files, the format's name, what its first attempts are called, and whether it has dates."""

    files: dict[str, str]
    form: str
    attempts: bool = True
    dates: bool = True


def logins() -> list[tuple[int, str, str]]:
    """Return number, name and login of each student; the pair's second member hands in nothing."""
    return [(n, name, f"s{n:02}") for n, name in enumerate(NAMES[:29], 1)]


def canvas() -> Exported:
    def flat(name: str) -> str:
        return "".join(char for char in name.lower() if char.isalnum() or char == "_" or ord(char) > 0x300)

    made = {
        f"{flat(name)}{'_LATE' * (n == 4)}_{1000 + n}_{50 + n}_joint_velocity.py": login for n, name, login in logins()
    }
    return Exported({**made, f"{flat(NAMES[0])}_1001_99_joint_velocity-1.py": "again"}, "canvas", dates=False)


def moodle() -> Exported:
    def clean(name: str) -> str:
        return "".join("" if char in '<>=%"' else char for char in name.replace("_", " "))

    made = {f"{clean(name)}_{1000 + n}_assignsubmission_file/joint_velocity.py": login for n, name, login in logins()}
    text = {f"{clean(NAMES[0])}_1001_assignsubmission_onlinetext/onlinetext.html": "<p>"}
    return Exported({**made, **text}, "moodle", attempts=False, dates=False)


def blackboard() -> Exported:
    made = {}
    for n, name, login in logins():
        for when in ["2026-11-20-22-01-00", "2026-11-21-09-05-00"][: 2 if n == 1 else 1]:
            made[f"Lab_3_{login}_attempt_{when}.txt"] = f"Name: {name} ({login})\nAssignment: Lab_3\n"
            made[f"Lab_3_{login}_attempt_{when}_joint_velocity.py"] = f"{login} {when}"
    return Exported(made, "blackboard")


def blackboard_in_german() -> Exported:
    made = blackboard().files
    return Exported({name.replace("attempt", "Versuch"): text for name, text in made.items()}, "blackboard")


def brightspace() -> Exported:
    made = {"index.html": "<html>"}
    for n, name, login in logins():
        for when in ["Nov 20, 2026 1001 PM", "Nov 21, 2026 905 AM"][: 2 if n == 1 else 1]:
            made[f"{1000 + n}-77 - {name.replace('<', '').replace('>', '')} - {when}/joint_velocity.py"] = login
    return Exported(made, "brightspace")


def sakai() -> Exported:
    made = {"Lab 3/grades.csv": '"Lab 3","Points"\n'}
    for n, name, login in logins():
        last_first = f"{name.rpartition(' ')[2]}, {name.rpartition(' ')[0]}".replace("(", "").replace(")", "")
        inside = f"Lab 3/{last_first}({login})"
        made[f"{inside}/Submission attachment(s)/joint_velocity.py"] = login
        made[f"{inside}/timestamp.txt"] = "20261120220100000" if n % 2 else "2026-11-20T22:01:00Z"
        made[f"{inside}/comments.txt"] = ""
    return Exported(made, "sakai", attempts=False)


def sakai_without_folders() -> Exported:
    made = {"Lab 3/grades.csv": '"Lab 3","Points"\n\n"Display ID","ID","Last Name","First Name","grade","Submitted"\n'}
    for _, name, login in logins():
        last_first = f"{name.rpartition(' ')[2]}, {name.rpartition(' ')[0]}".replace("(", "").replace(")", "")
        inside = f"Lab 3/{last_first}({login})_"
        made[f"{inside}Submission attachment(s)_joint_velocity.py"] = login
        made[f"{inside}_submissionText.html"] = made[f"{inside}comments.txt"] = ""
        made[f"{inside}Feedback Attachment(s)corrected.py"] = "by the instructor"
        made["Lab 3/grades.csv"] += f'"{login}","{login}","x","y","","2026-11-20T22:01:00Z"\n'
    return Exported(made, "sakai", attempts=False)


def ilias() -> Exported:
    def ascii_only(name: str) -> str:
        return "".join(char for char in name if char.isascii() and (char.isalnum() or char == " "))

    made = {}
    for n, name, login in logins():
        first, _, last = (ascii_only(name) or "X Y").rpartition(" ")
        late = "Late Submission - " if n == 4 else ""
        made[f"Lab_3/Submissions/{last or 'X'}_{first or 'Y'}_{login}_{300 + n}/{late}joint_velocity.py"] = login
    return Exported({**made, "Lab_3/Lab_3.xlsx": "PK"}, "ilias", attempts=False, dates=False)


def gradescope() -> Exported:
    made, listed = {}, ""
    for n, name, login in logins():
        made[f"assignment_12_export/submission_{900 + n}/joint_velocity.py"] = login
        listed += f"submission_{900 + n}:\n  :submitters:\n"
        listed += f"  - :name: {name!r}\n    :sid: '{1000 + n}'\n    :email: {login}@x.org\n"
        if n == 29:
            listed += f"  - :name: {NAMES[29]!r}\n    :sid: '1030'\n    :email: s30@x.org\n"
        listed += "  :created_at: 2026-11-20 22:01:00.123456000 Z\n  :score: 0.0\n"
    return Exported({**made, "assignment_12_export/submission_metadata.yml": listed}, "gradescope", attempts=False)


def nbgrader() -> Exported:
    made = {}
    for _, _, login in logins():
        made[f"course/submitted/{login}/joint_velocity/joint_velocity.ipynb"] = login
        made[f"course/submitted/{login}/joint_velocity/timestamp.txt"] = "2026-11-20 22:01:00.000000 UTC"
        made[f"course/submitted/{login}/ps2/ps2.ipynb"] = "{}"
        made[f"course/autograded/{login}/joint_velocity/joint_velocity.ipynb"] = "old"
    return Exported(made, "nbgrader", attempts=False)


EXPORTS = [
    canvas,
    moodle,
    blackboard,
    blackboard_in_german,
    brightspace,
    sakai,
    sakai_without_folders,
    ilias,
    gradescope,
    nbgrader,
]


@pytest.mark.parametrize("packed", [True, False])
@pytest.mark.parametrize("export", EXPORTS)
def test_an_export_is_recognised_and_everybody_in_it_has_one_submission(
    tmp_path: Path, export: Callable[[], Exported], packed: bool
) -> None:
    made = export()
    source = archive(tmp_path / "class.zip", made.files) if packed else folder(tmp_path / "class", made.files)
    last = collected(source, attempts="last", zone=UTC)
    assert made.form in last.kind.lower()
    assert len(last.handed_in) == (30 if export is gradescope else 29)
    assert not last.questions
    assert len({one.student.id.casefold() for one in last.handed_in}) == len(last.handed_in)
    contents = {one.file.path.read_text(encoding="utf-8").split()[0] for one in last.handed_in}
    assert len(contents) == 29
    for one in last.handed_in:
        if made.dates:
            assert one.file.submitted in (FIRST, SECOND), one
        else:
            assert one.file.submitted is None, "the date of a download is not that of a submission"
    if made.attempts:
        asked = collected(source, zone=UTC)
        assert [question.unclear for question in asked.questions] == ["attempts"]
        assert len(asked.handed_in) == 28
        first = collected(source, attempts="first", zone=UTC)
        who = asked.questions[0].student.id
        assert files(first)[who] != files(last)[who]


@pytest.mark.parametrize("export", [export for export in EXPORTS if export is not gradescope])
def test_a_pair_is_a_row_each_with_one_submission(tmp_path: Path, export: Callable[[], Exported]) -> None:
    source = archive(tmp_path / "class.zip", export().files)
    alone = collected(source, attempts="last", zone=UTC)
    one = next(one.student for one in alone.handed_in if one.file.path.read_text(encoding="utf-8").startswith("s29"))
    (tmp_path / "groups.csv").write_text(
        f"group,student,name\npair 7,{one.id},\npair 7,s30,Zoe Zed\n", encoding="utf-8"
    )
    found = collected(source, attempts="last", zone=UTC, groups=read_groups(tmp_path / "groups.csv"))
    assert len(found.handed_in) == 30
    assert not found.missing
    assert {files(found)[one.id], files(found)["s30"]} == {files(alone)[one.id]}


@pytest.mark.parametrize("export", EXPORTS)
def test_one_odd_file_changes_nothing_for_the_others_and_is_never_left_out_in_silence(
    tmp_path: Path, export: Callable[[], Exported]
) -> None:
    made = export()
    whole = collected(archive(tmp_path / "whole.zip", made.files), attempts="last", zone=UTC)
    inside = "course/submitted/" if export is nbgrader else next(iter(made.files)).rpartition("/")[0].split("/")[0]
    top = (
        inside
        if inside.endswith("/")
        else f"{inside}/"
        if made.form not in ("canvas", "moodle", "blackboard", "brightspace")
        else ""
    )
    top = "Lab_3/Submissions/" if export is ilias else top
    odd = {f"{top}zed.py": "# zed", f"{top}notes.txt": "mine"}
    odded = collected(archive(tmp_path / "odd.zip", {**made.files, **odd}), attempts="last", zone=UTC)
    assert files(odded) == files(whole)
    assert [(one.student.id, one.files, one.unclear) for one in odded.questions] == [("zed", (f"{top}zed.py",), "name")]


def test_canvas_says_who_is_late_and_never_when(tmp_path: Path) -> None:
    source = archive(tmp_path / "class.zip", canvas().files)
    late = [one for one in collected(source, attempts="last").handed_in if one.file.time.late]
    assert [one.student.lms["ID"] for one in late] == ["1004"]


def test_canvas_hides_names_in_anonymous_marking_and_a_group_has_one_submission(tmp_path: Path) -> None:
    hidden = archive(tmp_path / "a.zip", ["anon_ab3Cd_51_node.py", "LATE_anon_x9Zzz_52_node.py"])
    found = collected(hidden)
    assert {one.student.id: one.file.time.late for one in found.handed_in} == {"anon_ab3Cd": False, "anon_x9Zzz": True}
    groups = tmp_path / "groups.csv"
    groups.write_text("group,student,name\nLab Group 3,anna,Anna\nLab Group 3,bert,Bert\n", encoding="utf-8")
    class_ = archive(tmp_path / "b.zip", ["labgroup3_77_51_node.py", "cleo_78_52_node.py"])
    found = collected(class_, groups=read_groups(groups))
    assert files(found) == {
        "anna": "labgroup3_77_51_node.py",
        "bert": "labgroup3_77_51_node.py",
        "cleo_78": "cleo_78_52_node.py",
    }


@pytest.mark.parametrize(
    "names",
    [
        ["Team A_12_assignsubmission_file/node.py", "Team B_13_assignsubmission_file/node.py"],
        [
            f"Team {t}-{who}_{n}_assignsubmission_file_/node.py"
            for n, (t, who) in enumerate(["A", x] for x in ("Anna", "Bert"))
        ],
    ],
    ids=["a folder per team", "a folder per member"],
)
def test_a_team_in_moodle_gives_each_member_the_grade(tmp_path: Path, names: list[str]) -> None:
    groups = tmp_path / "groups.csv"
    groups.write_text("group,student,name\nTeam A,anna,Anna\nTeam A,bert,Bert\nTeam B,cleo,Cleo\n", encoding="utf-8")
    found = collected(archive(tmp_path / "class.zip", names), groups=read_groups(groups))
    assert {one.student.name for one in found.handed_in} >= {"Anna", "Bert"}
    assert len(found.students) == 3
    assert [note for note in found.notes if "in no group" in note] == []
    groups.write_text("group,student\nTeam A,anna\n", encoding="utf-8")
    found = collected(tmp_path / "class.zip", groups=read_groups(groups))
    assert any(note.startswith("in no group of --groups: ") for note in found.notes)


def test_of_a_group_whose_members_differ_nobody_gets_nothing_in_silence(tmp_path: Path) -> None:
    (tmp_path / "groups.csv").write_text("group,student\nA,anna\nA,bert\nA,cleo\n", encoding="utf-8")
    groups = read_groups(tmp_path / "groups.csv")
    found = collected(folder(tmp_path / "class", {"anna.py": "one", "bert.py": "two"}), groups=groups)
    assert not found.missing
    contents = {one.student.id: one.file.path for one in found.handed_in}
    assert (contents["anna"].read_text(), contents["bert"].read_text()) == ("one", "two")
    assert sorted(file.read_text() for file in contents["cleo"].iterdir()) == ["one", "two"]


def test_sakai_and_gradescope_say_who_is_in_a_group(tmp_path: Path) -> None:
    made = {
        "Lab/Ann Lee/members.txt": "Lee, Ann(ann1); Li, Bo(bo2)",
        "Lab/Ann Lee/Submission attachment(s)/node.py": "",
        "Lab/Cy Ott/members.txt": "Ott, Cy(cy3)",
        "Lab/Cy Ott/Submission attachment(s)/node.py": "",
    }
    found = collected(archive(tmp_path / "class.zip", made))
    assert list(files(found)) == ["ann1", "bo2", "cy3"]
    assert found.handed_in[0].file == found.handed_in[1].file


def test_a_folder_that_gradescope_lists_and_that_is_missing_is_named(tmp_path: Path) -> None:
    made = {name: text for name, text in gradescope().files.items() if "submission_901/" not in name}
    found = collected(archive(tmp_path / "class.zip", made))
    why = "it names folders that are not there: submission_901"
    assert [(one.file, one.why) for one in found.skipped] == [([*made][-1], why)]


def test_who_handed_in_nothing_in_sakai_is_named(tmp_path: Path) -> None:
    made = {"Lab/Lee, Ann(ann1)/Submission attachment(s)/node.py": ""}
    nothing = {"Lab/Ott, Di(di4)/comments.txt": "", **made}
    assert [skip.file for skip in collected(archive(tmp_path / "b.zip", nothing)).skipped] == [*nothing][:1]


MOODLES = "Identifier,Full name,Email address,Status,Last modified (submission)\n"
ROSTERS = {
    canvas: "Student,ID,SIS Login ID,Section\n,,,Manual Posting\n    Points Possible,,,\n"
    + "".join(
        f'"{name.rpartition(" ")[2]}, {name.rpartition(" ")[0]}",{1000 + n},s{n:02},A\n'
        for n, name in enumerate(NAMES, 1)
    ),
    moodle: MOODLES
    + "".join(
        f'Participant {1000 + n},{name},s{n:02}@x.org,Submitted,"Friday, 20 November 2026, 10:01 PM"\n'
        for n, name in enumerate(NAMES, 1)
    ),
    blackboard: "Last Name,First Name,Username\n" + "".join(f"{name},,s{n:02}\n" for n, name in enumerate(NAMES, 1)),
    sakai: '"Lab 3","Points"\n\nDisplay ID,ID,Last Name,First Name\n'
    + "".join(f"s{n:02},s{n:02},{name},\n" for n, name in enumerate(NAMES, 1)),
    gradescope: "First Name,Last Name,SID,Email\n"
    + "".join(f"{name},,{1000 + n},s{n:02}@x.org\n" for n, name in enumerate(NAMES, 1)),
    nbgrader: "student,name\n" + "".join(f"s{n:02},{name}\n" for n, name in enumerate(NAMES, 1)),
}


@pytest.mark.parametrize("export", ROSTERS)
def test_the_platforms_own_list_is_a_roster(tmp_path: Path, export: Callable[[], Exported]) -> None:
    (tmp_path / "roster.csv").write_text(ROSTERS[export], encoding="utf-8")
    source = archive(tmp_path / "class.zip", export().files)
    found = collected(source, attempts="last", zone=UTC, roster=read_roster(tmp_path / "roster.csv", UTC))
    assert len(found.students) == 30
    assert len(found.missing) == (0 if export is gradescope else 1)
    assert len({student.id for student in found.students}) == 30
    assert not any("not on the roster" in note for note in found.notes)
    if export is moodle:
        assert {one.file.submitted for one in found.handed_in} == {FIRST}
        assert {one.file.submitted_from for one in found.handed_in} == {"Moodle's worksheet"}


def test_a_roster_names_each_student_once_and_never_takes_a_submission_away(tmp_path: Path) -> None:
    (tmp_path / "roster.csv").write_text("student,name\nanna,Anna\nanna,Anna\nbert,Anna\n", encoding="utf-8")
    found = collected(folder(tmp_path / "class", ["anna.py"]), roster=read_roster(tmp_path / "roster.csv", None))
    assert (list(files(found)), [student.id for student in found.missing]) == (["anna"], ["bert"])


@pytest.mark.parametrize(
    ("name", "who"),
    [
        ("millerzed_77_text.html", "millerzed_77"),
        ("Zed Zee_77_assignsubmission_onlinetext/onlinetext.html", "Zed_Zee_77"),
        ("Lab_3_zed_attempt_2026-11-20-22-01-00.txt", "zed"),
        ("Lab 3/Zee, Zed(zed)/timestamp.txt", "zed"),
        ("course/submitted/zed/joint_velocity/timestamp.txt", "zed"),
    ],
)
def test_who_handed_in_only_a_text_has_a_row_too(tmp_path: Path, name: str, who: str) -> None:
    exports = {"millerzed": canvas, "Zed Zee": moodle, "Lab_3_zed": blackboard, "Lab 3": sakai, "course": nbgrader}
    made = exports[name.partition("/")[0].partition("_77")[0].partition("_attempt")[0]]()
    found = collected(archive(tmp_path / "class.zip", {**made.files, name: "2026-11-20 22:01 UTC"}), attempts="last")
    assert len(found.handed_in) == 30
    assert files(found)[who] == name
    assert any(note.endswith(f"not one of .py, .ipynb, .zip: {name}") for note in found.notes)
