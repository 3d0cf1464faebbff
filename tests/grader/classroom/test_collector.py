"""Submissions are found in folders, downloads and tables; unclear ones become questions, and nothing is guessed."""

from __future__ import annotations

import io
import os
import stat
import tarfile
import tempfile
import zipfile
from collections.abc import Iterator
from dataclasses import replace
from datetime import datetime, timezone
from pathlib import Path
from typing import Any

import pytest

from grader.classroom.archive import MOST_FILES, unpacked
from grader.classroom.collector import CollectOptions, collect
from grader.classroom.submissions import Submissions, SubmissionsError
from grader.exercise import load
from grader.submission import NoSubmission, read

ROOT = Path(__file__).parents[3]
EXERCISE = "joint_velocity"


def written(root: Path, *names: str) -> Path:
    for name in names:
        (root / name).parent.mkdir(parents=True, exist_ok=True)
        (root / name).write_text(f"# {name}\n")
    return root


def zipped(file: Path, *names: str) -> Path:
    with zipfile.ZipFile(file, "w") as archive:
        for name in names:
            archive.writestr(zipfile.ZipInfo(name, (2026, 11, 20, 18, 30, 0)), f"# {name}\n")
    return file


def taken(source: Path, tmp_path: Path, **options: Any) -> Submissions:
    into = tmp_path / "unpacked"
    into.mkdir(exist_ok=True)
    return collect(source, load(ROOT / "exercises" / EXERCISE), into, CollectOptions(**options))


def files(collected: Submissions) -> dict[str, str]:
    return {one.student.id: one.file.name for one in collected.handed_in}


def why(collected: Submissions) -> dict[str, str]:
    return {skipped.file: skipped.why for skipped in collected.skipped}


def test_a_file_a_student_or_a_folder_a_student(tmp_path: Path) -> None:
    root = written(tmp_path / "s", "anna.py", "bert.ipynb", "cleo/node.py", "cleo/report.pdf", "notes.txt", ".DS_Store")
    collected = taken(root, tmp_path)
    assert files(collected) == {"anna": "anna.py", "bert": "bert.ipynb", "cleo": "cleo/node.py", "notes": "notes.txt"}
    assert "not one of" in why(collected)["cleo/report.pdf"]
    assert collected.notes == ("handed in, but not one of .py, .ipynb, .zip: notes.txt",)
    assert "made by a program" in why(collected)[".DS_Store"]
    assert not collected.questions


def test_launch_files_in_xml_and_yaml_are_submissions_and_other_yaml_is_not(tmp_path: Path) -> None:
    collected = taken(written(tmp_path / "s", "anna.launch.xml", "bert.launch.yaml", "cleo.py", "class.yaml"), tmp_path)
    assert files(collected) == {"anna": "anna.launch.xml", "bert": "bert.launch.yaml", "cleo": "cleo.py"}
    assert "not a submission" in why(collected)["class.yaml"]


def test_of_an_exercise_with_a_launch_file_yaml_with_a_launch_in_it_is_one_too(tmp_path: Path) -> None:
    root = written(tmp_path / "s", "cleo.py", "class.yaml", "params.yaml")
    (root / "anna.yaml").write_text("# mine\nlaunch:\n  - node: {pkg: arms, exec: driver}\n")
    exercise = replace(load(ROOT / "exercises" / EXERCISE), nodes=("/arm",))
    collected = collect(root, exercise, tmp_path, CollectOptions())
    assert files(collected) == {"anna": "anna.yaml", "cleo": "cleo.py"}
    assert set(why(collected)) == {"class.yaml", "params.yaml"}


def test_the_upload_that_spinbook_submit_writes_is_a_submission(tmp_path: Path) -> None:
    assert files(taken(written(tmp_path / "s", "anna.zip"), tmp_path)) == {"anna": "anna.zip"}


def test_all_files_of_one_student_are_one_submission(tmp_path: Path) -> None:
    root = written(tmp_path / "s", "anna.py", "anna/node.py", "bert/a.py", "bert/b.ipynb", "cleo.py", "cleo/cleo.py")
    collected = taken(root, tmp_path)
    assert files(collected) == {"anna": "anna.py", "bert": "bert", "cleo": "cleo.py"}
    inside = [sorted(file.name for file in one.file.path.iterdir()) for one in collected.handed_in]
    assert inside[:2] == [["anna.py", "node.py"], ["a.py", "b.ipynb"]]
    assert len(inside[2]) == 2, "none hides the other"


def test_a_students_name_becomes_the_name_of_a_folder(tmp_path: Path) -> None:
    collected = taken(written(tmp_path / "s", "Anna Müller (A2).py", "-x y-/n.py", "$$$/n.py"), tmp_path)
    assert {one.student.id: one.student.name for one in collected.handed_in} == {
        "Anna_Müller_A2": "Anna Müller (A2)",
        "-x_y-": "-x y-",
        "nameless": "$$$",
    }


def test_nbgraders_folder_of_submissions(tmp_path: Path) -> None:
    root = written(
        tmp_path / "course",
        *(f"submitted/anna/{EXERCISE}/joint_velocity.ipynb", "submitted/anna/other/other.ipynb"),
        *(f"submitted/bert/{EXERCISE}/joint_velocity.ipynb", "source/joint_velocity/joint_velocity.ipynb"),
    )
    (root / "submitted" / "anna" / EXERCISE / "timestamp.txt").write_text("2026-11-20 18:30:00.123456 UTC\n")
    collected = taken(root, tmp_path)
    assert files(collected) == {
        "anna": f"submitted/anna/{EXERCISE}/joint_velocity.ipynb",
        "bert": f"submitted/bert/{EXERCISE}/joint_velocity.ipynb",
    }
    anna, bert = (one.file for one in collected.handed_in)
    assert (anna.submitted, anna.submitted_from) == (
        datetime(2026, 11, 20, 18, 30, tzinfo=timezone.utc),
        "timestamp.txt",
    )
    assert bert.submitted is None
    other = "submitted/anna/other/other.ipynb"
    assert why(collected) == {
        other: "another assignment, other",
        "source/joint_velocity/joint_velocity.ipynb": "not in submitted/",
    }


def test_nbgraders_folder_itself(tmp_path: Path) -> None:
    root = written(tmp_path / "submitted", f"anna/{EXERCISE}/a.ipynb", "bert/other/b.ipynb")
    assert files(taken(root, tmp_path)) == {"anna": f"anna/{EXERCISE}/a.ipynb"}
    written(root, f"cleo/{EXERCISE.title()}/c.ipynb")
    assert list(files(taken(root, tmp_path))) == ["anna", "cleo"], "in a file system that knows capitals"


MOODLE = (
    "Anna Müller_1234567_assignsubmission_file_/joint_velocity.py",
    "Bert O'Neil_1234568_assignsubmission_file_joint_velocity.py",
    "Bert O'Neil_1234568_assignsubmission_onlinetext_/onlinetext.html",
)


@pytest.mark.parametrize("packed", [True, False])
def test_a_download_from_moodle(tmp_path: Path, packed: bool) -> None:
    source = zipped(tmp_path / "class.zip", *MOODLE) if packed else written(tmp_path / "class", *MOODLE)
    collected = taken(source, tmp_path)
    assert collected.kind == "a download from Moodle"
    anna, bert = collected.handed_in
    assert (anna.student.id, anna.student.name) == ("Anna_Müller_1234567", "Anna Müller")
    assert bert.student.lms == {"Identifier": "Participant 1234568", "Full name": "Bert O'Neil"}
    assert anna.file.path.read_text() == f"# {MOODLE[0]}\n"
    assert anna.file.submitted is None, "Moodle writes no dates into its zip"
    assert MOODLE[2] not in files(collected).values()


CANVAS = ("muelleranna_12345_678901_joint_velocity-2.py", "oneilbert_LATE_12346_678902_joint_velocity.py")


@pytest.mark.parametrize("packed", [True, False])
def test_a_download_from_canvas(tmp_path: Path, packed: bool) -> None:
    source = zipped(tmp_path / "class.zip", *CANVAS) if packed else written(tmp_path / "class", *CANVAS)
    collected = taken(source, tmp_path)
    assert collected.kind == "a download from Canvas"
    assert files(collected) == {"muelleranna_12345": CANVAS[0], "oneilbert_12346": CANVAS[1]}
    assert [one.student.lms for one in collected.handed_in] == [{"ID": "12345"}, {"ID": "12346"}]


def test_a_table_that_names_files(tmp_path: Path) -> None:
    root = written(tmp_path / "s", "1.py", "deep/2.ipynb")
    table = root / "class.csv"
    table.write_text(
        "\ufefffile;student;name;email;submitted;SIS ID\n"
        "1.py;anna;Anna Müller;anna@example.org;2026-11-22 23:59;A1\n\n"
        "deep/2.ipynb;bert;;;2026-11-22T22:00:00Z;\n3.py;cleo;;;;\n",
        encoding="utf-8",
    )
    collected = taken(table, tmp_path)
    anna, bert = collected.handed_in
    assert (anna.student.name, anna.student.email, anna.student.lms) == (
        *("Anna Müller", "anna@example.org"),
        {"SIS ID": "A1"},
    )
    assert (bert.file.submitted, bert.file.submitted_from) == (
        datetime(2026, 11, 22, 22, tzinfo=timezone.utc),
        "the CSV file",
    )
    (root / "1.py").rename(root / "ü.py")
    table.write_text("file,student\nu\u0308.py,anna\n", encoding="utf-8")
    assert len(taken(table, tmp_path).handed_in) == 1, "a Mac and Windows write ü in two ways"
    [cleo] = collected.questions
    assert str(cleo) == "cleo handed in 3.py: line 5 names it, but there is no such file"


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("name,student\nx,y\n", "class.csv:1: there is no column 'file'"),
        ("file,student\na.py,\n", "class.csv:2: file = 'a.py', student = ''"),
        ("file,student,submitted\na.py,anna,yesterday\n", "class.csv:2: submitted = 'yesterday'"),
    ],
)
def test_a_mistake_in_a_table_is_reported_with_its_line(tmp_path: Path, text: str, message: str) -> None:
    table = written(tmp_path / "s", "a.py") / "class.csv"
    table.write_text(text)
    with pytest.raises(SubmissionsError, match=message.replace("(", r"\(")):
        taken(table, tmp_path)


def test_a_student_named_twice_in_a_table_is_a_question(tmp_path: Path) -> None:
    table = written(tmp_path / "s", "a.py", "b.py", "c.py") / "class.csv"
    table.write_text("file,student\na.py,anna\nb.py,anna\nc.py,cleo\n")
    collected = taken(table, tmp_path)
    assert list(files(collected)) == ["cleo"]
    assert collected.questions[0].files == ("a.py", "b.py")


def test_no_name_in_a_zip_leads_out_of_its_folder(tmp_path: Path) -> None:
    source = zipped(tmp_path / "class.zip", "../../evil.py", "/etc/evil2.py", "a\\..\\..\\evil3.py", "fine.py")
    collected = taken(source, tmp_path)
    into = (tmp_path / "unpacked").resolve()
    assert {one.file.path.resolve().parent for one in collected.handed_in} == {into}
    assert "fine" in files(collected)
    assert sorted(path.name for path in tmp_path.iterdir()) == ["class.zip", "unpacked"]


def test_a_class_in_a_zip_in_a_zip_is_not_one_students_work(tmp_path: Path) -> None:
    zipped(tmp_path / "class.zip", "anna.py", "bert.py")
    with zipfile.ZipFile(tmp_path / "export.zip", "w") as archive:
        archive.write(tmp_path / "class.zip", "class.zip")
    with pytest.raises(SubmissionsError, match=r"export\.zip holds nothing but class\.zip, in which are 2 submissions"):
        taken(tmp_path / "export.zip", tmp_path)


def test_one_students_package_in_a_zip_in_a_zip_is_theirs(tmp_path: Path) -> None:
    zipped(tmp_path / "anna.zip", "vel/package.xml", "vel/setup.py", "vel/vel/node.py", "vel/vel/angles.py")
    with zipfile.ZipFile(tmp_path / "export.zip", "w") as archive:
        archive.write(tmp_path / "anna.zip", "anna.zip")
    assert files(taken(tmp_path / "export.zip", tmp_path)) == {"anna": "anna.zip"}


@pytest.mark.parametrize("kind", ["gz", "bz2", "xz", ""])
def test_a_tar_is_read_as_a_zip_is(tmp_path: Path, kind: str) -> None:
    source = tmp_path / f"class.tar.{kind}"
    with tarfile.open(source, f"w:{kind}") as archive:  # type: ignore[call-overload]
        for name in ("./anna.py", "bert/node.py", "../../evil.py", "__MACOSX/._x.py", "dora.py", "dora.py"):
            archive.addfile(tarfile.TarInfo(name), io.BytesIO())
        for name, sort in (("link.py", tarfile.SYMTYPE), ("hard.py", tarfile.LNKTYPE), ("device.py", tarfile.CHRTYPE)):
            entry = tarfile.TarInfo(name)
            entry.type, entry.linkname, entry.mtime = sort, "/etc/passwd", 10**14
            archive.addfile(entry)
    collected = taken(source, tmp_path)
    assert files(collected) == {"anna": "anna.py", "bert": "bert/node.py", "evil": "evil.py", "link": "link.py"}
    assert [one.file.path.parent == tmp_path / "unpacked" for one in collected.handed_in] == [True] * 4
    assert [one.student.id for one in collected.questions] == ["device", "dora", "hard"]
    source.write_bytes(source.read_bytes()[: 100 if kind else 1000])
    with pytest.raises(SubmissionsError, match=r"it is not a valid tar file: .* Was the download cut off"):
        list(unpacked(source, tmp_path))


def test_a_bomb_in_a_tar_is_refused(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("grader.classroom.archive.MOST_BYTES_IN_ALL", 1_000_000)
    with tarfile.open(tmp_path / "class.tgz", "w:gz") as archive:
        entry = tarfile.TarInfo("bomb.py")
        entry.size = 5_000_000
        archive.addfile(entry, io.BytesIO(bytes(entry.size)))
    with pytest.raises(SubmissionsError, match="unpacked, it is larger than"):
        taken(tmp_path / "class.tgz", tmp_path)


def test_links_and_encrypted_files_in_a_zip_are_named_and_have_a_row(tmp_path: Path) -> None:
    source = tmp_path / "class.zip"
    with zipfile.ZipFile(source, "w") as archive:
        link = zipfile.ZipInfo("link.py")
        link.create_system = 3
        link.external_attr = (stat.S_IFLNK | 0o777) << 16
        archive.writestr(link, "/etc/passwd")
        archive.writestr("secret.py", "# secret")
        archive.writestr("fine.py", "# fine")
    content = bytearray(source.read_bytes())
    for mark, offset in ((b"PK\x03\x04", 6), (b"PK\x01\x02", 8)):  # the flag that says: encrypted
        start = -1
        while (start := content.find(mark, start + 1)) >= 0:
            if b"secret.py" in content[start : start + 60]:
                content[start + offset] |= 1
                break
    source.write_bytes(content)
    collected = taken(source, tmp_path)
    assert list(files(collected)) == ["fine", "link"]
    assert "symbolic link" in read(str(collected.handed_in[1].file.path), load(ROOT / "exercises" / EXERCISE)).problem
    assert [str(question) for question in collected.questions] == [
        "secret handed in secret.py: it is encrypted. Unpack the zip file with its password, and give the folder."
    ]


def test_an_archive_of_another_kind_is_to_be_unpacked(tmp_path: Path) -> None:
    (tmp_path / "class.rar").write_bytes(b"Rar!\x1a\x07\x01\x00")
    with pytest.raises(SubmissionsError, match="an archive of another kind: unpack it, and give the folder"):
        taken(tmp_path / "class.rar", tmp_path)


def test_a_bomb_in_a_zip_is_cut_off_and_judged_too_large(tmp_path: Path) -> None:
    source = tmp_path / "class.zip"
    with zipfile.ZipFile(source, "w", zipfile.ZIP_DEFLATED) as archive, archive.open("bomb.py", "w") as entry:
        for _ in range(100):
            entry.write(bytes(1_000_000))
    collected = taken(source, tmp_path)
    (bomb,) = collected.handed_in
    assert bomb.file.path.stat().st_size < 31_000_000


def test_a_folder_in_place_of_an_archive_is_reported(tmp_path: Path) -> None:
    with pytest.raises(SubmissionsError, match=r"it is not a valid zip file: .*Is a directory"):
        list(unpacked(tmp_path, tmp_path))


def test_a_zip_of_too_many_files_is_refused(tmp_path: Path) -> None:
    source = zipped(tmp_path / "class.zip", *(f"{number}.py" for number in range(MOST_FILES + 1)))
    with pytest.raises(SubmissionsError, match="more than"):
        taken(source, tmp_path)


@pytest.mark.parametrize("content", [b"", b"no zip", b"PK\5\6" + bytes(10)])
def test_what_is_no_zip_is_reported(tmp_path: Path, content: bytes) -> None:
    source = tmp_path / "class.zip"
    source.write_bytes(content)
    with pytest.raises(SubmissionsError, match=r"class\.zip"):
        taken(source, tmp_path)


def test_a_damaged_file_in_a_zip_is_a_question_and_no_zero(tmp_path: Path) -> None:
    whole = io.BytesIO()
    with zipfile.ZipFile(whole, "w") as archive:
        archive.writestr("anna.py", "# anna " + "x" * 100)
        archive.writestr("bert.py", "# bert")
    (tmp_path / "class.zip").write_bytes(whole.getvalue().replace(b"x" * 50, b"y" * 50, 1))
    collected = taken(tmp_path / "class.zip", tmp_path)
    assert list(files(collected)) == ["bert"]
    assert "anna handed in anna.py: it can't be read: Bad CRC-32" in str(collected.questions[0])


def test_dates_that_no_student_made_are_unknown(tmp_path: Path) -> None:
    made = written(tmp_path / "class", "anna/node.py", "anna/.git/HEAD", "bert/node.py")
    os.utime(made / "bert" / "node.py", (0, 0))
    assert [one.file.submitted for one in taken(made, tmp_path).handed_in] == [None, None]
    with zipfile.ZipFile(tmp_path / "class.zip", "w") as archive:
        archive.writestr(zipfile.ZipInfo("anna.py"), "")
    assert [one.file.submitted for one in taken(tmp_path / "class.zip", tmp_path).handed_in] == [None]


def test_links_in_a_folder_are_not_followed(tmp_path: Path) -> None:
    root = written(tmp_path / "s", "anna.py")
    written(tmp_path / "elsewhere", "other.py")
    (root / "bert").symlink_to(tmp_path / "elsewhere")
    assert list(files(taken(root, tmp_path))) == ["anna"]


@pytest.mark.parametrize("names", [(), ("notes.txt",)])
def test_nothing_to_grade_is_reported(tmp_path: Path, names: tuple[str, ...]) -> None:
    root = tmp_path / "s"
    root.mkdir()
    with pytest.raises(SubmissionsError, match="There is no submission in it"):
        taken(written(root, *names), tmp_path)


@pytest.fixture
def folder_of_a_user() -> Iterator[Path]:
    """A folder of a user who may not read everything, as root may."""
    before = os.geteuid()
    if before == 0:
        os.seteuid(65534)
    try:
        with tempfile.TemporaryDirectory() as folder:
            yield Path(folder)
            os.chmod(Path(folder, "class", "bert"), 0o700)  # noqa: PTH101
    finally:
        os.seteuid(before)


def test_what_may_not_be_read_stops_the_class_and_is_nobodys_zero(folder_of_a_user: Path) -> None:
    source = written(folder_of_a_user / "class", "anna.py", "bert/node.py", "carl.py")
    (source / "anna.py").chmod(0)
    with pytest.raises(SubmissionsError, match=r"anna\.py: it can't be read: Permission denied\. .*chmod -R u\+rX"):
        taken(source, folder_of_a_user)
    with pytest.raises(NoSubmission, match=r"anna\.py: it can't be read: Permission denied\."):
        read(str(source / "anna.py"), load(ROOT / "exercises" / EXERCISE))
    (source / "anna.py").unlink()
    (source / "bert").chmod(0)
    with pytest.raises(SubmissionsError, match="bert: it can't be read: Permission denied"):
        taken(source, folder_of_a_user)
