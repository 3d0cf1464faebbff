"""Files are written whole, with the permissions that the user's umask leaves."""

from __future__ import annotations

import gzip
import os
import subprocess
import sys
from pathlib import Path

import pytest

from groundwork.files import cached, json_object, keep, read_kept, write_folder


@pytest.mark.parametrize("mask", [0o077, 0o022, 0o027, 0o002])
def test_a_file_obeys_the_umask(tmp_path: Path, mask: int) -> None:
    code = "import sys, pathlib; from groundwork.files import write_if_changed\n"
    code += "write_if_changed(pathlib.Path(sys.argv[1]), 'grades')"
    subprocess.run([sys.executable, "-c", code, str(tmp_path / "grades.csv")], umask=mask, check=True)
    assert (tmp_path / "grades.csv").stat().st_mode & 0o777 == 0o666 & ~mask


def test_a_user_without_a_home_folder_has_a_cache_as_in_a_container(monkeypatch: pytest.MonkeyPatch) -> None:
    for name in ("HOME", "SPINBOOK_CACHE", "XDG_CACHE_HOME"):
        monkeypatch.delenv(name, raising=False)
    monkeypatch.setattr(os, "getuid", lambda: 54321)
    assert cached("sandbox") == Path("/.cache/spinbook/sandbox")


def test_a_folder_holds_exactly_the_files_that_it_is_given(tmp_path: Path) -> None:
    write_folder(tmp_path, {"old/notes.md": "old", "same.txt": "same"})
    before = (tmp_path / "same.txt").stat().st_mtime_ns
    write_folder(tmp_path, {"old": b"a file in place of the folder", "same.txt": "same"})
    assert sorted(path.name for path in tmp_path.iterdir()) == ["old", "same.txt"]
    assert (tmp_path / "old").read_text() == "a file in place of the folder"
    assert (tmp_path / "same.txt").stat().st_mtime_ns == before


@pytest.mark.parametrize("content", ["", "[1, 2]", "{", "\udcff"])
def test_a_file_without_a_json_object_is_an_empty_one(tmp_path: Path, content: str) -> None:
    file = tmp_path / "record.json"
    assert json_object(file) == {}
    file.write_text(content, encoding="utf-8", errors="surrogateescape")
    assert json_object(file) == {}
    file.write_text('{"key": 1}')
    assert json_object(file) == {"key": 1}


def test_what_is_kept_is_read_and_what_is_missing_damaged_or_can_not_be_written_is_made_again(tmp_path: Path) -> None:
    file = tmp_path / "kept.gz"
    whole = gzip.compress(b"kept" * 1000)
    assert read_kept(file, gzip.decompress) is None
    for damaged in (b"", whole[:30], whole[:15] + b"\xff" * 20):
        keep(file, damaged)
        assert not read_kept(file, gzip.decompress)

    keep(file, whole)
    assert read_kept(file, gzip.decompress) == b"kept" * 1000
    keep(file / "below a file", whole)
