"""The cell `%submit joint_velocity`: hands in what the student ran last, in a process of its own."""

from __future__ import annotations

import os
import sys
import tempfile
from pathlib import Path
from typing import Any

from spinbook.check.cell import exercise_of
from spinbook.check.code import code_of
from spinbook.check.notebook import notebook_file
from spinbook.runtime.session import Session
from spinbook.runtime.showing import Bound


def run(session: Session, shell: Any, name: str, course: str, student: str | None, seconds: float) -> None:
    """Write the upload for the exercise `name`. Raises CellFailed where there is nothing to hand in, or it fails."""
    notebook = notebook_file(shell.user_ns, os.environ)
    exercise = exercise_of(name, course, notebook)
    code = code_of(exercise, session, notebook)
    print(code.note("Handed in", f"%submit {exercise.name}"))
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder, exercise.file_name)
        file.write_text(code.text, encoding="utf-8")
        command = [sys.executable, "-u", "-m", "spinbook", "submit", os.fspath(exercise.folder)]
        command += [os.fspath(notebook)] if notebook else []
        command += ["--code", os.fspath(file)]
        command += ["--student", student] if student is not None else []
        session.run_command(command, {}, Path.cwd(), Bound(seconds), f"%submit {name}")
