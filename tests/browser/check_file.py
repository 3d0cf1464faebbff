"""Checks a file as a page does, over rcl_python: `check_file.py PUBLIC FILE RESULT`.

PUBLIC is a student's copy of the exercise. RESULT gets recordings and verdicts, as JSON.
"""

import json
import sys
from pathlib import Path

import rcl_python
from spinbook.browser.in_page import threads

threads.replace_threading()
rcl_python.install()

from grader.exercise import load  # noqa: E402
from grader.recording.store import plain  # noqa: E402
from spinbook.browser.in_page import check  # noqa: E402
from spinbook.browser.in_page.rig import Program  # noqa: E402

exercise = load(Path(sys.argv[1])).public()
source = Path(sys.argv[2]).read_text(encoding="utf-8")
scenarios, references, hidden = check.public_part(exercise)
recordings = check.record(exercise, scenarios, Program(exercise.file_name, source))
found = check.verdicts(exercise, scenarios, recordings, references)
statuses = {verdict.name: [verdict.status, verdict.finding.text if verdict.finding else ""] for verdict in found}
result = {"hindrance": check.hindrance_of(source), "recordings": plain(recordings), "verdicts": statuses}
Path(sys.argv[3]).write_text(json.dumps(result), encoding="utf-8")
