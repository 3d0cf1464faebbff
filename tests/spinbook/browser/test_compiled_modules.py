"""The compiled modules of pages are kept in the cache; a site is made with them also where nothing can be kept."""

from __future__ import annotations

from pathlib import Path

import pytest

from spinbook.browser.compiled import with_compiled_modules

ARCHIVES = {"ros.zip": b"source, "}


@pytest.fixture
def node(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A program in the place of Node.js, which marks what it gets as compiled."""
    program = tmp_path / "bin" / "node"
    program.parent.mkdir()
    program.write_text("#!/bin/sh\nfor file in $3/*; do echo compiled >> $file; done\n")
    program.chmod(0o755)
    monkeypatch.setenv("PATH", str(program.parent), prepend=":")
    return program


def test_what_was_compiled_is_kept(tmp_path: Path, node: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("SPINBOOK_CACHE", str(tmp_path / "cache"))

    compiled = with_compiled_modules(tmp_path, ARCHIVES)
    node.write_text("#!/bin/sh\nexit 1\n")

    assert compiled == {"ros.zip": b"source, compiled\n"}
    assert with_compiled_modules(tmp_path, ARCHIVES) == compiled
    assert with_compiled_modules(tmp_path, {"ros.zip": b"newer"}) == {"ros.zip": b"newer"}


@pytest.mark.usefixtures("node")
def test_a_cache_that_cannot_be_written_does_not_stop_the_site(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    no_folder = tmp_path / "file"
    no_folder.touch()
    monkeypatch.setenv("SPINBOOK_CACHE", str(no_folder))

    assert with_compiled_modules(tmp_path, ARCHIVES) == {"ros.zip": b"source, compiled\n"}
