"""An upload contains everything, is the same from run to run, and shows what in it was damaged or edited."""

from __future__ import annotations

import io
import json
import stat
import zipfile
from collections.abc import Callable
from pathlib import Path

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from grader.exercise import Exercise, load
from grader.submission import read
from grader.submission.problems import Unreadable
from grader.submission.reader import of_upload
from grader.submission.upload import RECORD, pack, unpack

CODE = b"class JointVelocity:\n    pass\n"
NOTEBOOK = json.dumps(
    {
        "cells": [
            {"cell_type": "code", "source": "%%node joint_velocity\nclass JointVelocity:\n    x = 1", "metadata": {}}
        ]
    }
).encode()
FILES = {"joint_velocity.py": CODE, "week3.ipynb": NOTEBOOK}
UPLOAD = pack({"exercise": "joint_velocity", "student": "Ada Lovelace"}, FILES)


@pytest.fixture(scope="module")
def exercise() -> Exercise:
    return load(Path(__file__).parents[3] / "exercises" / "joint_velocity")


def changed(**contents: bytes | None) -> bytes:
    """Return the upload with some files changed, or removed; every checksum of the zip is right."""
    kept = entries(UPLOAD)
    for name, content in contents.items():
        kept[name.replace("__", ".")] = content or b""
        if content is None:
            del kept[name.replace("__", ".")]
    return zipped(kept)


def entries(upload: bytes) -> dict[str, bytes]:
    with zipfile.ZipFile(io.BytesIO(upload)) as archive:
        return {name: archive.read(name) for name in archive.namelist()}


def zipped(files: dict[str, bytes], compression: int = zipfile.ZIP_STORED) -> bytes:
    out = io.BytesIO()
    with zipfile.ZipFile(out, "w", compression) as archive:
        for name, content in files.items():
            archive.writestr(name, content)
    return out.getvalue()


def test_what_is_packed_is_there_again_and_faultless() -> None:
    upload = unpack(UPLOAD)
    assert upload.files == FILES
    assert upload.record["student"] == "Ada Lovelace"
    assert upload.faults == ()


def test_the_same_content_gives_the_same_bytes() -> None:
    turned = dict(reversed(list(FILES.items())))
    assert pack({"student": "Ada Lovelace", "exercise": "joint_velocity"}, turned) == UPLOAD


@pytest.mark.parametrize(
    ("upload", "fault"),
    [
        (changed(joint_velocity__py=b"x = 1\n"), "joint_velocity.py has been changed"),
        (changed(week3__ipynb=None), "week3.ipynb is missing"),
        (changed(submission__json=b"{"), "submission.json can't be read"),
        (changed(submission__json=b'{"a": "\\ud800"}'), "submission.json can't be read"),
        (changed(submission__json=entries(UPLOAD)[RECORD].replace(b"Ada", b"Eve")), "submission.json has been changed"),
        (changed(notes__txt=b"hello"), "notes.txt has been added"),
    ],
)
def test_an_edited_upload_says_which_part_and_is_graded_all_the_same(
    upload: bytes, fault: str, exercise: Exercise
) -> None:
    assert fault in "; ".join(unpack(upload).faults)
    submission = of_upload("upload.zip", upload, exercise)
    assert fault in submission.warning
    assert submission.program


def test_a_zip_that_was_packed_by_hand_is_graded_and_that_is_said(exercise: Exercise) -> None:
    same = NOTEBOOK.replace(b"x = 1", b"pass")
    submission = of_upload("upload.zip", changed(submission__json=None, week3__ipynb=same), exercise)
    assert "submission.json is missing" in submission.warning
    assert submission.source == CODE.decode()
    assert submission.notes == ("Taken: joint_velocity.py.",)
    assert "they differ" in of_upload("upload.zip", changed(submission__json=None), exercise).question


def test_damaged_code_is_taken_from_the_notebook_beside_it(exercise: Exercise) -> None:
    damaged = UPLOAD.replace(CODE, CODE.replace(b"pass", b"fail"))
    submission = of_upload("upload.zip", damaged, exercise)
    assert "joint_velocity.py is damaged" in submission.warning
    assert "x = 1" in submission.source


def test_an_upload_that_was_packed_again_by_hand_is_as_good(exercise: Exercise) -> None:
    packed = {f"handed in/{name}": content for name, content in entries(UPLOAD).items()}
    upload = zipped({**packed, "__MACOSX/handed in/._joint_velocity.py": b"rubbish"}, zipfile.ZIP_DEFLATED)
    submission = of_upload("upload.zip", upload, exercise)
    assert submission.warning == ""
    assert submission.source == CODE.decode()


def test_an_upload_for_another_exercise_is_reported(exercise: Exercise) -> None:
    submission = of_upload("upload.zip", pack({"exercise": "speed_limit"}, FILES), exercise)
    assert "'speed_limit'" in submission.warning


def link() -> bytes:
    out = io.BytesIO()
    with zipfile.ZipFile(out, "w") as archive:
        entry = zipfile.ZipInfo("joint_velocity.py")
        entry.external_attr = (stat.S_IFLNK | 0o777) << 16
        archive.writestr(entry, "/etc/passwd")
    return out.getvalue()


#: Each is packed when its test runs: the bombs take a tenth of a second.
NOT_UPLOADS: dict[str, tuple[Callable[[], bytes], str]] = {
    "empty": (bytes, "not a valid archive"),
    "cut off": (lambda: UPLOAD[: len(UPLOAD) // 2], "cut off"),
    "link": (link, "symbolic link"),
    "one bomb": (lambda: zipped({"joint_velocity.py": bytes(50_000_000)}, zipfile.ZIP_DEFLATED), "more than 4 MB"),
    "many bombs": (
        lambda: zipped({f"{i}.bin": bytes(400_000) for i in range(20)}, zipfile.ZIP_DEFLATED),
        "more than 4 MB",
    ),
    "many files": (lambda: zipped({f"{i}.py": b"" for i in range(1000)}), "1000 files"),
    "two of one name": (lambda: zipped({"a/x.py": b"", "a//x.py": b""}), "two files called a/x.py"),
}


@pytest.mark.parametrize("name", NOT_UPLOADS)
def test_what_is_no_upload_is_reported_and_does_no_harm(name: str, exercise: Exercise) -> None:
    packed, why = NOT_UPLOADS[name]
    content = packed()
    with pytest.raises(Unreadable, match=why):
        unpack(content)
    submission = of_upload("upload.zip", content, exercise)
    assert submission.program is None
    assert why in submission.problem


def test_names_that_lead_elsewhere_lead_nowhere(tmp_path: Path, exercise: Exercise) -> None:
    file = tmp_path / "in" / "upload.zip"
    file.parent.mkdir()
    file.write_bytes(zipped({"../../joint_velocity.py": CODE, "/tmp/x.txt": b"x", "..\\y.txt": b"y"}))
    submission = read(str(file), exercise)
    assert submission.source == CODE.decode()
    assert sorted(path.name for path in tmp_path.rglob("*")) == ["in", "upload.zip"]


@settings(max_examples=200, deadline=None, derandomize=True)
@given(st.integers(0, len(UPLOAD) - 1), st.binary(min_size=1, max_size=8))
def test_no_damage_goes_unnoticed_or_breaks_the_reader(at: int, rubbish: bytes) -> None:
    damaged = UPLOAD[:at] + rubbish + UPLOAD[at + len(rubbish) :]
    try:
        upload = unpack(damaged)
    except Unreadable:
        return
    assert upload.faults or upload.files == FILES
