"""Looks through a handout for what must not be in it, whatever way it may have got there."""

from __future__ import annotations

import io
import json
import zipfile
from collections.abc import Iterator, Mapping

from spinbook.handout.secrets import Secret, bare


def leaks(files: Mapping[str, bytes], known: list[Secret]) -> Iterator[tuple[str, str]]:
    """(file, what it is) for each file and each thing that is secret in it. Looks into notebooks, wheels and zips, too.

    Of a notebook everything counts: cells, outputs, attachments, and metadata of the whole and of each cell.
    """
    for name, content in files.items():
        text = bare(f"{name}\n{_readable(name, content)}")
        for what in dict.fromkeys(secret.what for secret in known if secret.text in text):
            yield name, what
        if name.endswith((".whl", ".zip")):
            with zipfile.ZipFile(io.BytesIO(content)) as archive:
                inner = {f"{name}/{entry}": archive.read(entry) for entry in archive.namelist()}
            yield from leaks(inner, known)


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
