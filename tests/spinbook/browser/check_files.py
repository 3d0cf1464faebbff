"""Checks files as a page does, over rcl_python and one after another in one interpreter: `check_files.py PUBLIC`.

PUBLIC is a student's copy of the exercise. Each line that is read is the path of a file; the answer to it is a line of
JSON: recordings and verdicts.
"""

import json
import os
import sys
from pathlib import Path
from typing import Any

import rcl_python
from spinbook.browser.in_page import program_imports, threads

threads.replace_threading()
rcl_python.install()
program_imports.watch()

from grader.exercise import load  # noqa: E402
from grader.recording.recording import RecordingEncoder  # noqa: E402
from spinbook.browser.in_page import check  # noqa: E402
from spinbook.browser.in_page.runner import ProgramText  # noqa: E402


def found(folder: Path, file: Path) -> dict[str, Any]:
    """What the check of one file comes to."""
    source = file.read_text(encoding="utf-8")
    if hindrance := check.hindrance_of(source):
        return {"hindrance": hindrance}
    exercise = load(folder).public()
    scenarios, references, _hidden = check.public_part(exercise)
    recordings = check.record(exercise, scenarios, ProgramText(exercise.file_name, source))
    verdicts = check.verdicts(exercise, scenarios, recordings, references)
    statuses = {verdict.name: [verdict.status, verdict.finding.text if verdict.finding else ""] for verdict in verdicts}
    return {"hindrance": "", "recordings": recordings, "verdicts": statuses}


# What programs print must not get among the answers.
with os.fdopen(os.dup(1), "w", encoding="utf-8") as answers:
    os.dup2(2, 1)
    for line in sys.stdin:
        checked = found(Path(sys.argv[1]), Path(line.rstrip("\n")))
        print(json.dumps(checked, cls=RecordingEncoder), file=answers, flush=True)
# A program's thread that does not end keeps nobody waiting.
os._exit(0)
