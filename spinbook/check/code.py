"""The code that `%check` checks: what the student ran last, else what the notebook's file holds."""

from __future__ import annotations

from dataclasses import dataclass
from datetime import datetime
from pathlib import Path

from grader.exercise import Exercise
from grader.submission.notebook import NoCell, cell_of
from spinbook.runtime.failure import CellFailed
from spinbook.runtime.session import Session


@dataclass(frozen=True)
class Code:
    """The exercise's code, its lines numbered as in the cell, and where it is from.

    `origin` completes "Checked: …". `warning` says that the cell's text is another one now; empty if that is not known.
    """

    text: str
    origin: str
    warning: str = ""

    def note(self, what: str, command: str) -> str:
        """Return what to tell the student: `what` is "Checked" or "Handed in", `command` what to run again."""
        told = f"{what}: {self.origin}."
        return f"{told}\nWARNING: {self.warning.format(command=command)}" if self.warning else told


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
        return Code(text, _as_run(node, session.ran_at[node]), _edited(node) if edited else "")
    if saved and notebook:
        not_run = f"it has not been run since the kernel started, so this is how it was last saved in {notebook.name}"
        return Code(saved, f"the cell %%node {node}; {not_run}")
    raise CellFailed(f"Run the cell that begins with %%node {node} first. Then run this one again.")


def _as_run(node: str, moment: float) -> str:
    at = datetime.fromtimestamp(moment).strftime("%H:%M:%S")
    return f"the cell %%node {node} as you ran it at {at}, without any change that you made after that"


def _edited(node: str) -> str:
    return (
        f"You have changed the cell %%node {node} since you ran it, and the change is not in this result. "
        "Run that cell again, then {command}."
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
