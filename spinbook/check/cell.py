"""The cell `%check joint_velocity`: finds the code, has it checked in another process, and shows what came of it."""

from __future__ import annotations

import os
from pathlib import Path
from typing import Any

from IPython.display import display

from grader.exercise import Exercise, ExerciseError, load
from grader.exercise.finding import NoExercise, find
from spinbook.check.code import code_of
from spinbook.check.notebook import notebook_file
from spinbook.check.process import checked
from spinbook.runtime.failure import CellFailed
from spinbook.runtime.session import Session


def run(session: Session, shell: Any, name: str, course: str, seconds: float) -> None:
    """Check the cell of the exercise `name` and show the result. Raises CellFailed where it can't be checked.

    `course` is the folder that has the exercises, where it is neither this one nor one above it or the notebook's.
    """
    notebook = notebook_file(shell.user_ns, os.environ)
    exercise = exercise_of(name, course, notebook)
    code = code_of(exercise, session, notebook)
    print(code.note("Checked", f"%check {exercise.name}"))
    display(checked(exercise.folder, code.text, seconds), raw=True)


def exercise_of(name: str, course: str, notebook: Path | None) -> Exercise:
    """The exercise `name`, in the folder `course`, else in this one, the notebook's, or above. Raises CellFailed."""
    places = [Path(course)] if course else [Path.cwd(), *([notebook.parent] if notebook else [])]
    told = ""
    for place in places:
        try:
            return load(find(name, place.resolve()))
        except NoExercise as error:
            told = told or str(error)
        except ExerciseError as error:
            raise CellFailed(f"The exercise is at fault, not your code.\n{error}") from None
    where = " and ".join(str(place.resolve()) for place in places)
    raise CellFailed(
        f"{told}\nI looked in {where} and above. A notebook from the course's website: run its first code cells. "
        f"One from a handout: keep the notebook in the folder of the handout, or name it: %check {name} --course FOLDER"
    )
