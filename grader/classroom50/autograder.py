"""Grades the repository in the current folder with Spinbook. Classroom 50's runner starts this once per submission.

It needs only Python's standard library: setup.sh installs everything else next to this file. It exits with 0 once
result.json is written, whatever the score, and with 1 if a fault that is not the student's prevented grading.
"""

import subprocess
import sys
from pathlib import Path

EXERCISE, ISOLATION = "@EXERCISE@", "@ISOLATION@"
HERE = Path(__file__).resolve().parent


def main() -> int:
    """Install what is missing, then grade."""
    # The student may have written them, and they must not count if nothing can be graded.
    subprocess.run(["rm", "-rf", "result.json", "release-body.md"], check=True)
    python = HERE / "venv" / "bin" / "python"
    # The installer prints on standard error: standard output is the runner's.
    set_up = ["bash", str(HERE / "setup.sh")]
    if not python.exists() and subprocess.run([*set_up, "without-trial"], stdout=sys.stderr, check=False).returncode:
        return 1
    # Few programs draw, and what they need for it is a third of everything.
    draws = subprocess.run(["grep", "-rqs", "--include=*.py", "--include=*.ipynb", "matplotlib", "."], check=False)
    if draws.returncode == 0 and not list(HERE.glob("venv/lib/*/site-packages/matplotlib")):
        subprocess.run([*set_up, "plots"], stdout=sys.stderr, check=False)
    exercise = HERE / "course" / "exercises" / EXERCISE
    # -I: the current folder is the student's, whose json.py must not run in the grader.
    words = [str(python), "-I", "-m", "grader.classroom50.run", str(exercise), ".", *filter(None, [ISOLATION])]
    return subprocess.run(words, check=False).returncode


if __name__ == "__main__":
    sys.exit(main())
