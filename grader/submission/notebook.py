"""Reads the code cells of a notebook's file, in any version of the format."""

from __future__ import annotations

import json
import re
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import Any

from grader.submission.magics import Magic, cell_magic, without_commands
from grader.submission.problems import Unreadable, merge_conflict
from grader.submission.script_notebook import SAVED_AS_PYTHON, cells_in

#: The key in the metadata of `%check`'s output: {"exercise": NAME, "code": DIGEST}.
RECORD = "spinbook"

#: Magics whose cells are Python that runs in the notebook itself.
_IN_THE_NOTEBOOK = ("", "time", "capture", "prun")


@dataclass(frozen=True, eq=False)
class NotebookCell:
    """One code cell. `number` counts code cells from 1; `exercise` is the exercise that the cell is for, or "".

    `ran` is the execution count of its outputs. `checked` has the digests of the code that `%check` judged in this
    cell, by exercise.
    """

    number: int
    source: str
    exercise: str = ""
    ran: int | None = None
    checked: Mapping[str, str] | None = None

    @cached_property
    def magic(self) -> Magic:
        """The cell's magic, and its code as typed."""
        return cell_magic(self.source)

    @cached_property
    def code(self) -> str:
        """The cell's Python code with the notebook's commands blanked out; "" if it is in another language."""
        if not self.is_python:
            return ""
        code = without_commands(self.magic.code)
        return code if parses(code) else without_commands(self.magic.code, automagic=True)

    @property
    def is_plain(self) -> bool:
        """Whether it runs in the notebook itself."""
        return self.magic.name in _IN_THE_NOTEBOOK

    @property
    def is_python(self) -> bool:
        """Whether the cell contains Python at all."""
        if self.magic.name in ("script", "file", "writefile"):
            return "python" in self.magic.line or self.magic.line.rstrip().endswith(".py")
        return self.is_plain or self.magic.name in ("node", "part", "python", "python3")

    @property
    def name(self) -> str:
        """The name of the module or part, from the magic: NAME of `%%node NAME`; "" for other cells."""
        if self.magic.name not in ("node", "part", "file", "writefile"):
            return ""
        words = [word for word in self.magic.line.split() if not word.startswith("-")]
        return words[0].rpartition("/")[2].removesuffix(".py") if words else ""

    @property
    def title(self) -> str:
        """The cell's number and first line, for people."""
        first = next((line.strip() for line in self.source.split("\n") if line.strip()), "")
        return f'code cell {self.number} ("{first[:40]}")'


@dataclass(frozen=True)
class Notebook:
    """A notebook: its code cells in their order, its language, and the version of Python that saved it, if known.

    `text` is that of its other cells; `note` says how it was read, if that is unusual.
    """

    cells: tuple[NotebookCell, ...]
    python: str = ""
    language: str = ""
    text: str = ""
    note: str = ""


def read_notebook(content: bytes) -> Notebook:
    """Read a notebook's file, or one that was saved as Python. Raises `Unreadable`."""
    if SAVED_AS_PYTHON.search(content):
        sources = cells_in(content.decode("utf-8-sig", errors="replace").replace("\r\n", "\n"))
        note = (
            f"Your file is a notebook that was saved as Python. It was read as its code cells, {len(sources)} in all."
        )
        return Notebook(tuple(NotebookCell(number, one) for number, one in enumerate(sources, start=1)), note=note)
    data = _json(content)
    cells = _cells(data)
    version, language = (_of_language(data.get("metadata"), key) for key in ("version", "name"))
    return Notebook(
        tuple(_cell(number, cell) for number, cell in enumerate(cells, start=1)),
        version if re.fullmatch(r"3\.\d{1,2}(\.\w{1,8})?", version) else "",
        language[:20],
        "\n".join(_text(cell.get("source")) for cell in _cells(data, code=False)),
    )


def _of_language(metadata: Any, key: str) -> str:
    info = metadata.get("language_info") if isinstance(metadata, dict) else None
    value = info.get(key) if isinstance(info, dict) else ""
    return value if isinstance(value, str) else ""


def _json(content: bytes) -> dict[str, Any]:
    if not content.strip():
        raise Unreadable("Your notebook's file is empty. Open the notebook, save it, and hand it in again.")
    if line := merge_conflict(content):
        raise Unreadable(
            f"Line {line} of the notebook's file holds a mark of a merge conflict from git, so it is not a valid "
            "notebook. Choose one version, such as with `git checkout --ours FILE` or `--theirs`, open it in Jupyter, "
            "and hand it in again."
        )
    try:
        data = json.loads(content)
    except json.JSONDecodeError as error:
        raise Unreadable(_not_json(content, error)) from None
    except RecursionError:
        raise Unreadable("It is not a valid notebook: its file is nested too deeply. Save it in Jupyter.") from None
    except UnicodeDecodeError as error:
        line = content.count(b"\n", 0, error.start) + 1
        raise Unreadable(
            f"It is not a valid notebook: line {line} of the file is not UTF-8. An editor has saved it in another "
            "encoding: save it as UTF-8, or open your own copy in Jupyter, save it, and hand it in again."
        ) from None
    if not isinstance(data, dict):
        raise Unreadable("It is not a valid notebook: its file holds no cells. Hand in the .ipynb that Jupyter saves.")
    return data


def _not_json(content: bytes, error: json.JSONDecodeError) -> str:
    content = content.removeprefix(b"\xef\xbb\xbf").lstrip()
    if content.startswith(b"<"):
        return "It is not a valid notebook but a web page. Download the notebook's own file, which ends with .ipynb."
    if not content.startswith(b"{"):
        return "It is not a valid notebook. Open it in Jupyter, save it, and hand it in again."
    if error.pos >= len(error.doc.rstrip()) or "Unterminated" in error.msg:
        return (
            f"It is not a valid notebook: the file ends in line {error.lineno}, in the middle. Was the download or the "
            "upload cut off? Open it in Jupyter, save it, and hand it in again."
        )
    return (
        f"It is not a valid notebook: line {error.lineno} of the file can't be read ({error.msg}). Open it in Jupyter, "
        "save it, and hand it in again."
    )


def _cells(data: Mapping[str, Any], code: bool = True) -> list[dict[str, Any]]:
    cells = data.get("cells")
    if cells is None and isinstance(data.get("worksheets"), list):  # nbformat 3
        sheets = [sheet.get("cells") for sheet in data["worksheets"] if isinstance(sheet, dict)]
        cells = [cell for sheet in sheets if isinstance(sheet, list) for cell in sheet]
    if not isinstance(cells, list):
        raise Unreadable("It is not a valid notebook: its file holds no cells. Hand in the .ipynb that Jupyter saves.")
    return [cell for cell in cells if isinstance(cell, dict) and (cell.get("cell_type") == "code") == code]


def _cell(number: int, cell: dict[str, Any]) -> NotebookCell:
    ran = cell.get("execution_count", cell.get("prompt_number"))
    return NotebookCell(
        number,
        _text(next((cell[key] for key in ("source", "input", "code") if key in cell), "")),
        _exercise(cell.get("metadata")),
        ran if isinstance(ran, int) else None,
        dict(_checked(cell.get("outputs"))),
    )


def _text(source: Any) -> str:
    lines = [line for line in (source if isinstance(source, list) else [source]) if isinstance(line, str)]
    # Some programs write a cell's lines without their ends.
    between = "" if any("\n" in line for line in lines) else "\n"
    return between.join(lines).replace("\r\n", "\n").replace("\r", "\n")


def _exercise(metadata: Any) -> str:
    spinbook = metadata.get(RECORD) if isinstance(metadata, dict) else None
    name = spinbook.get("exercise") if isinstance(spinbook, dict) else ""
    return name if isinstance(name, str) else ""


def _checked(outputs: Any) -> Iterator[tuple[str, str]]:
    """Yield what the cell's `%check` judged: (exercise, digest)."""
    for output in outputs if isinstance(outputs, list) else ():
        metadata = output.get("metadata") if isinstance(output, dict) else None
        record = metadata.get(RECORD) if isinstance(metadata, dict) else None
        if isinstance(record, dict) and all(isinstance(record.get(key), str) for key in ("exercise", "code")):
            yield record["exercise"], record["code"]


def parses(code: str) -> bool:
    """Return whether this is valid Python in the grader's version."""
    from grader.submission.python_code import tree_of

    return tree_of(code) is not None
