"""The code that `%check` checks: what the student ran last, else what the notebook's file holds."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

from grader.exercise import Exercise
from grader.submission.notebook import NoCell, cell_of
from spinbook.runtime.failure import CellFailed
from spinbook.runtime.session import Session


@dataclass(frozen=True)
class Code:
    """The exercise's code, its lines numbered as in the cell. `note` tells where it is from, if that may surprise."""

    text: str
    note: str = ""


def code_of(exercise: Exercise, session: Session, notebook: Path | None) -> Code:
    """The code of the exercise's cell, as the session ran it last.

    Raises CellFailed, with what to do, where the cell has not been run and the notebook's file is not known.
    """
    node = exercise.file_name.removesuffix(".py")
    saved = _saved(exercise, notebook)
    if node in session.ran:
        # The line with %%node is the cell's first.
        text = "\n" + session.ran[node]
        edited = saved and saved.strip() != text.strip() and _saved_after(notebook, session.ran_at[node])
        return Code(text, _edited(node, exercise) if edited else "")
    if saved and notebook:
        told = f"The cell %%node {node} has not been run since the kernel started."
        return Code(saved, f"{told} This checks it as it was last saved in {notebook.name}.")
    raise CellFailed(f"Run the cell that begins with %%node {node} first. Then run this one again.")


def _edited(node: str, exercise: Exercise) -> str:
    return (
        f"This checks the cell %%node {node} as you ran it last. You have changed it since: run that cell again, then "
        f"%check {exercise.name}, to check what stands there now."
    )


def _saved_after(notebook: Path | None, moment: float) -> bool:
    """Whether the notebook was saved after this moment (s since the epoch): what was saved before is out of date."""
    try:
        return notebook is not None and notebook.stat().st_mtime > moment
    except OSError:
        return False


def _saved(exercise: Exercise, notebook: Path | None) -> str:
    try:
        return cell_of(notebook.read_bytes(), exercise) if notebook else ""
    except (OSError, NoCell):
        return ""
