"""Determines what a file is from its name and its first bytes: Python, a notebook, an archive, or another language."""

from __future__ import annotations

import re
from collections.abc import Mapping
from typing import Literal

from grader.submission.script_notebook import SAVED_AS_PYTHON

Kind = Literal["python", "notebook", "archive", "launch file", "other language", "other"]

_SUFFIXES: dict[str, Kind] = {
    ".py": "python",
    ".pyw": "python",
    ".ipynb": "notebook",
    ".zip": "archive",
    ".tar": "archive",
    ".tgz": "archive",
    ".tar.gz": "archive",
    ".tar.bz2": "archive",
    ".tar.xz": "archive",
    ".txz": "archive",
    **dict.fromkeys(("launch.xml", "launch.yaml", "launch.yml", ".launch"), "launch file"),
}
_LANGUAGES = {
    **dict.fromkeys((".cpp", ".cc", ".cxx", ".c++", ".hpp", ".hh", ".hxx", ".ino"), "C++"),
    **{".c": "C", ".h": "C", ".rs": "Rust", ".java": "Java", ".js": "JavaScript", ".m": "MATLAB", ".jl": "Julia"},
}

#: What browsers, mail programs, file managers and editors append to a file's name, and what they put before it.
_ADDED = re.compile(
    r"(?:\.(?:txt|text|json|download|bin|bak|old|orig|part|\d{1,2})?|~| ?\(\d{1,3}\)| - [^\W\d]+| copy| kopie)$", re.I
)
_BEFORE = re.compile(r"^(?:copy of|copy \(\d+\) of|kopie von|copie de|copia de|copia di) ", re.IGNORECASE)

#: The largest submission of each kind (bytes).
MOST_BYTES_OF: dict[Kind, int] = {
    "python": 1_000_000,
    "notebook": 30_000_000,
    "archive": 30_000_000,
    "launch file": 1_000_000,
    "other language": 1_000_000,
    "other": 1_000_000,
}

_ARCHIVES = (b"PK\x03\x04", b"PK\x05\x06", b"\x1f\x8b", b"BZh", b"\xfd7zXZ\x00")
#: RAR, 7z and Zstandard, which Python can't unpack.
OTHER_ARCHIVES = (b"Rar!\x1a\x07", b"7z\xbc\xaf\x27\x1c", b"\x28\xb5\x2f\xfd")
NOT_UNPACKED = "an archive that can't be read here"

#: A launch file in XML or YAML; one in Python is Python.
_IS_LAUNCH_FILE = re.compile(
    rb"\A(?:\xef\xbb\xbf)?(?:\s*<[?!][^>]*>)*\s*<launch\b|^launch[ \t]*:[ \t]*(?:#.*|\[.*)?$", re.MULTILINE
)
_IS_PYTHON = re.compile(rb"\A#!.*python|^(?:import|from)[ \t]+rclpy\b", re.MULTILINE)
#: A web page, rich text or Markdown may quote a program, but is not one.
_IS_DOCUMENT = re.compile(rb"\A\s*(?:<|\{\\rtf)|^[ \t]*```", re.MULTILINE)

NEITHER = "neither Python, nor a notebook, nor an archive"


def kind_of(name: str) -> Kind:
    """Return the kind of a file by its name, ignoring case and what a browser appended: `node.py.txt`."""
    lower = without_additions(name).lower()
    for suffix, kind in _SUFFIXES.items():
        if lower.endswith(suffix):
            return kind
    return "other language" if language_of(name) else "other"


def language_of(name: str) -> str:
    """Return the programming language of a file by its name; "" for Python, and if it is not known."""
    lower = without_additions(name).lower()
    return next((language for suffix, language in _LANGUAGES.items() if lower.endswith(suffix)), "")


def not_graded(language: str) -> str:
    """Return what a student reads who handed in a program in another language than Python."""
    return f"{language} is not graded yet: hand in Python."


def without_additions(name: str) -> str:
    """Return a file's name without its folders and what a browser or file manager added: `node.py` for `node.py (1)`.

    A number or the like before the suffix stays: see `original_name`.
    """
    name = name.rpartition("/")[2].strip()
    while not name.lower().endswith((*_SUFFIXES, *_LANGUAGES)) and (match := _ADDED.search(name)):
        name = name[: match.start()]
    return name


def original_name(name: str) -> str:
    """Return the name of the file of which this is a copy: `node.py` for `node (1).py` and `Kopie von node.py`."""
    stem, dot, suffix = without_additions(name).rpartition(".")
    return _BEFORE.sub("", _ADDED.sub("", stem)) + dot + suffix


def can_be_read(name: str) -> bool:
    """Return whether a file with this name is a submission, even one that is refused for its language."""
    return kind_of(name) != "other"


def kind_of_content(content: bytes, kind: Kind) -> Kind:
    """Return the kind by a file's content, such as a notebook that was saved as .py, or a zip as .ipynb."""
    if content.startswith(_ARCHIVES):
        return "archive"
    if kind == "other" and _IS_LAUNCH_FILE.search(content):
        return "launch file"
    is_json = content.lstrip(b"\xef\xbb\xbf \t\r\n").startswith(b"{")
    if kind in ("python", "other") and is_json and re.search(rb'"(?:cells|worksheets)"\s*:', content):
        return "notebook"
    if (
        kind in ("notebook", "other")
        and not is_json
        and _IS_PYTHON.search(content)
        and not _IS_DOCUMENT.search(content)
    ):
        kind = "python"
    return "notebook" if kind == "python" and SAVED_AS_PYTHON.search(content) else kind


def named_by_content(files: Mapping[str, bytes]) -> dict[str, bytes]:
    """Return the files of a submission under names that say what they are, as a lone file is read by its content.

    A program without a suffix counts, one in a text file only if there is nothing else.
    """
    has_work = any(
        kind_of(name) in ("notebook", "other language") or (kind_of(name) == "python" and b"rclpy" in content)
        for name, content in files.items()
    )
    named = dict(files)
    for name, content in files.items():
        before = kind_of(name)
        kind = kind_of_content(content, before)
        is_meant = before != "other" or "." not in name.rpartition("/")[2] or not has_work
        if kind not in ("python", "notebook") or not is_meant:
            continue
        bare = name if kind != before else name.rpartition("/")[0] + "/" * ("/" in name) + without_additions(name)
        new = bare if bare.endswith(_SUFFIX_OF[kind]) else re.sub(r"(?i)\.(?:py|ipynb)$", "", bare) + _SUFFIX_OF[kind]
        if new != name:
            del named[name]
            named[new if new not in files else f"{bare}-1{_SUFFIX_OF[kind]}"] = content
    return named


_SUFFIX_OF = {"python": ".py", "notebook": ".ipynb"}
