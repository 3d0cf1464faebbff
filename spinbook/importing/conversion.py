"""Converts a book's notebooks and reStructuredText to Markdown chapters, next to the originals."""

from __future__ import annotations

import base64
import importlib.util
import re
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

import jupytext
import nbformat

from groundwork.files import write_if_changed
from groundwork.problem import Problem
from spinbook.problem import SpinbookError

#: Suffix -> the package that reads such files.
_NEEDS = {".ipynb": "jupytext", ".rst": "docutils"}
_COMMAND = re.compile(r"^\s*!\s*(?=(?:ros2|colcon|rqt_plot|rqt_graph)\b)", re.MULTILINE)
#: An opening and closing fence with only commands that begin with `!`.
_COMMANDS_ONLY = re.compile(r"^```python[^\n]*\n((?:\s*(?:!|#)[^\n]*\n|\s*\n)+)```$", re.MULTILINE)


def as_markdown(file: Path) -> Path:
    """Write the chapter that a notebook or a reStructuredText file becomes, if it is not there; return its path.

    Raises SpinbookError if a package is missing, or if the file can't be read.
    """
    target = file.with_suffix(".md")
    if target.exists():
        return target
    package = _NEEDS[file.suffix]
    if importlib.util.find_spec(package) is None:
        problem = f"a {file.suffix} file is read with {package}, which is not installed."
        raise SpinbookError(Problem(file, None, problem, f"Install it: pip install {package}"))
    try:
        text = _CONVERTERS[file.suffix](file)
    except Exception as error:  # what the libraries raise for broken files is not documented
        words = str(error).strip().split("\n")[0].rstrip(".") or type(error).__name__
        raise SpinbookError(Problem(file, None, f"it can't be read: {words}.", "Repair it, or move it away.")) from None
    write_if_changed(target, text)
    return target


def _from_notebook(file: Path) -> str:
    """Return a notebook's text and code; its outputs come from running it. Attached pictures become files."""
    notebook = nbformat.read(file, as_version=4)
    notebook.metadata = {"kernelspec": notebook.metadata.get("kernelspec", {})}
    for number, cell in enumerate(notebook.cells):
        for name, content in cell.get("attachments", {}).items():
            picture = f"{file.stem}_files/{number}-{Path(name).name}"
            cell.source = cell.source.replace(f"attachment:{name}", picture)
            _write_picture(file.with_name(file.stem + "_files") / Path(picture).name, content)
        cell.pop("attachments", None)
        cell.metadata = {key: value for key, value in cell.metadata.items() if key == "tags" and value}
    filters = {"notebook_metadata_filter": "-all", "cell_metadata_filter": "tags"}
    notebook.metadata["jupytext"] = filters
    text: str = jupytext.writes(notebook, fmt={"extension": ".md", "format_name": "markdown"})
    return _COMMANDS_ONLY.sub(_as_shell, text.lstrip("\n"))


def _as_shell(match: re.Match[str]) -> str:
    """Return a cell with nothing but `!ros2 …` as a fence for a terminal."""
    return f"```bash\n{_COMMAND.sub('', match[1])}```" if _COMMAND.search(match[1]) else match[0]


def _write_picture(file: Path, content: Mapping[str, Any]) -> None:
    for kind, data in content.items():
        if kind.startswith("image/"):
            file.parent.mkdir(exist_ok=True)
            text = "".join(data)
            file.write_bytes(text.encode() if kind == "image/svg+xml" else base64.b64decode(text))


def _from_rst(file: Path) -> str:
    # docutils comes with the site's packages, and takes a while to import.
    from spinbook.importing.rst import markdown_of

    return markdown_of(file.read_text(encoding="utf-8"), file)


_CONVERTERS: dict[str, Callable[[Path], str]] = {".ipynb": _from_notebook, ".rst": _from_rst}
