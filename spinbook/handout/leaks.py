"""Looks through a handout for what must not be in it, whatever way it may have got there."""

from __future__ import annotations

import io
import json
import zipfile
from collections.abc import Iterator, Mapping
from dataclasses import dataclass

from spinbook.handout.secrets import Secret, bare


@dataclass(frozen=True)
class Leak:
    """A secret in a file of a handout. `at` says where in the course's files it is, and `line` in the file itself.

    `line` is None, and `at` empty, where that can't be told.
    """

    file: str
    what: str
    line: int | None
    at: str


def leaks(files: Mapping[str, bytes], known: list[Secret]) -> Iterator[tuple[str, str]]:
    """(file, what it is) for each file and each thing that is secret in it: see `located`."""
    for leak in located(files, known):
        yield leak.file, leak.what


def located(files: Mapping[str, bytes], known: list[Secret]) -> Iterator[Leak]:
    """Find each thing that is secret in each file, once. Looks into notebooks, wheels and zips, too.

    Of a notebook everything counts: cells, outputs, attachments, and metadata of the whole and of each cell.
    """
    for name, content in files.items():
        text = bare(f"{name}\n{_readable(name, content)}")
        first: dict[str, Secret] = {}
        for secret in known:
            if secret.text in text:
                first.setdefault(secret.what, secret)
        for secret in first.values():
            yield _leak(name, content, secret)
        if name.endswith((".whl", ".zip")):
            with zipfile.ZipFile(io.BytesIO(content)) as archive:
                inner = {f"{name}/{entry}": archive.read(entry) for entry in archive.namelist()}
            yield from located(inner, known)


def _leak(name: str, content: bytes, secret: Secret) -> Leak:
    if name.endswith(".ipynb"):
        chapter = _chapter_line(content, secret)
        return Leak(name, secret.what, None, ", ".join(filter(None, (chapter, _same(secret)))))
    return Leak(name, secret.what, _line_in(content.decode("utf-8", errors="replace"), secret), _same(secret))


def _same(secret: Secret) -> str:
    return f"the same as {secret.at}" if secret.at else ""


def _line_in(text: str, secret: Secret) -> int | None:
    """Return the line in which a secret begins."""
    start = bare(text).find(secret.text)
    for number, line in enumerate(text.split("\n") if start >= 0 else (), start=1):
        start -= len(bare(line))
        if start < 0:
            return number
    return None


def _chapter_line(content: bytes, secret: Secret) -> str:
    """Return the chapter and line from which a notebook has the secret, as the notebook's metadata tell it."""
    try:
        notebook = json.loads(content)
        chapter = notebook["metadata"]["spinbook"]["chapter"]
        for cell in notebook["cells"]:
            line = _line_in("".join(cell["source"]), secret)
            if line is not None:
                return f"{chapter}:{cell['metadata']['spinbook']['line'] + line - 1}"
    except (ValueError, KeyError, TypeError):
        pass
    return ""


def _readable(name: str, content: bytes) -> str:
    """A file's text; a notebook's texts, one after the other, as they are shown."""
    text = content.decode("utf-8", errors="replace")
    if name.endswith((".ipynb", ".json")):
        try:
            return "\n".join(_texts(json.loads(text)))
        except ValueError:
            pass
    return text


def _texts(value: object) -> Iterator[str]:
    if isinstance(value, str):
        yield value
    elif isinstance(value, list):
        for item in value:
            yield from _texts(item)
    elif isinstance(value, dict):
        for key, item in value.items():
            yield str(key)
            yield from _texts(item)
