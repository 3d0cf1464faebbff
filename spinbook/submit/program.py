"""Checks one cell's code: `python -m spinbook.submit.program EXERCISE CODE RESULT`, the last two being files.

RESULT is JSON: the result by media type in `shown`, and further `hints`; or {"problem": TEXT} where there is none.
"""

from __future__ import annotations

import importlib
import json
import sys
import threading
from pathlib import Path
from typing import Any

from grader.exercise.exercise import ExerciseError
from grader.exercise.loading import load
from grader.grading.grade import Grade
from grader.grading.grading import grade_submission
from grader.report.hint_steps import last_hints
from grader.sandbox.program import SandboxUnavailable
from grader.submission.code import from_text
from grader.submission.reader import of_code
from grader.workers.pool import HostFault
from groundwork.files import write_if_changed


def main() -> None:
    """Check the code that the command line names."""
    folder, code, result = Path(sys.argv[1]), Path(sys.argv[2]), Path(sys.argv[3])
    # The modules that draw the result take long to import, so this happens while the node runs.
    threading.Thread(target=importlib.import_module, args=["spinbook.submit.self_check_view"], daemon=True).start()
    write_if_changed(result, json.dumps(_checked(folder, code.read_text(encoding="utf-8"))))


def _checked(folder: Path, code: str) -> dict[str, Any]:
    try:
        exercise = load(folder).public()
        grade: Grade = grade_submission(exercise, of_code("your cell", from_text(code), exercise))
    except ExerciseError as error:
        return {"problem": f"The exercise is at fault, not your code.\n{error}"}
    except (HostFault, SandboxUnavailable) as error:
        return {"problem": f"The machine or the grader is at fault, not your code: {error}"}
    from spinbook.submit.self_check_view import as_html, as_text

    shown = {"text/html": as_html(grade, exercise), "text/plain": as_text(grade, exercise)}
    return {"shown": shown, "hints": last_hints(grade)}


if __name__ == "__main__":
    main()
