"""A page's process uses the code that an earlier one has compiled from the same archive."""

from __future__ import annotations

import builtins
import importlib
import sys
import zipfile
import zipimport
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

from spinbook.browser.in_page import code_cache

MODULE = "made_for_a_page"
SOURCE = "import pathlib\n\n\ndef half(number):\n    return number / 2\n"


@pytest.fixture
def archive(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[Path]:
    """An archive with one module, on Python's path."""
    file = tmp_path / "ros.zip"
    write(file, SOURCE)
    monkeypatch.setattr(zipimport, "_compile_source", zipimport._compile_source)  # type: ignore[attr-defined]
    monkeypatch.syspath_prepend(file)
    yield file
    sys.modules.pop(MODULE, None)


def write(archive: Path, source: str) -> None:
    with zipfile.ZipFile(archive, "w") as files:
        files.writestr(f"{MODULE}.py", source)


def imported_anew() -> Any:
    """Import the module as a new process would."""
    sys.modules.pop(MODULE, None)
    importlib.invalidate_caches()
    return importlib.import_module(MODULE)


def without_a_compiler(patch: pytest.MonkeyPatch) -> None:
    def refuse(*words: object, **named: object) -> None:
        raise AssertionError("compiled again")

    patch.setattr(builtins, "compile", refuse)


def test_what_one_process_has_compiled_the_next_one_does_not_compile(
    archive: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    code_cache.keep()
    imported_anew()
    code = code_cache.kept()

    code_cache.use(memoryview(code))
    with monkeypatch.context() as patch:
        without_a_compiler(patch)
        module = imported_anew()

    assert module.half(3) == 1.5
    assert module.half.__code__.co_filename == f"{archive}/{MODULE}.py"


def test_a_file_that_has_changed_is_compiled_again(archive: Path) -> None:
    code_cache.keep()
    imported_anew()
    code = code_cache.kept()
    write(archive, SOURCE.replace("/ 2", "/ 4"))

    code_cache.use(code)

    assert imported_anew().half(3) == 0.75


def test_a_file_that_no_process_has_imported_yet_is_compiled(archive: Path) -> None:
    code_cache.keep()
    code = code_cache.kept()

    code_cache.use(code)

    assert imported_anew().half(3) == 1.5
