"""Odd machines: what `doctor`, a grade, a class of two, a handout's check and `%check` come to on each.

    python benchmarks/machines/table.py                           every condition
    python benchmarks/machines/table.py "PYTHONPATH polluted"     some of them
    python benchmarks/machines/table.py --root /srv/bookworm      a bare root folder, as debootstrap makes it

A row is a condition; a field says `right`, or `refused` with the sentence that names the cause, or `WRONG` with what
came instead: another grade, a traceback, a process that does not end. Ends with 1 if anything is wrong. In a root
folder, the project is copied and set up first, as on a new machine.
"""

from __future__ import annotations

import argparse
import csv
import os
import re
import shutil
import subprocess
import sys
import tempfile
import zipfile
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path

import nbformat
from conditions import Condition, conditions

ROOT = Path(__file__).parents[2]
EXERCISE = "heartbeat"
SOLUTION = f"solutions/{EXERCISE}/solution.py"
#: How long one command may take (s), on a busy machine too.
LONGEST_S = 300
#: What a refusal reads like: a sentence that does not come from Python.
TRACEBACK = "Traceback (most recent call last)"
#: What ends a command before a line of Spinbook runs, and who prints it: IPython only imports what is on PYTHONPATH.
NOT_OURS = {"Fatal Python error": "Python", "IPython/__init__.py": "IPython"}


@dataclass(frozen=True)
class Ended:
    """A command that has ended: its exit code, and all that it printed."""

    code: int
    text: str


@dataclass(frozen=True)
class Place:
    """Where commands run: the folders of the course, the handout and the class, and a way to run `spinbook` there."""

    course: Path
    handout: Path
    submissions: Path
    results: Path
    python: str

    @property
    def spinbook(self) -> str:
        """The command, of this Python."""
        return os.fspath(Path(self.python).with_name("spinbook"))


#: What a command must come to: the sentence that is wrong about it, or nothing.
Judgement = Callable[[Ended, Place], str | None]


@dataclass(frozen=True)
class Job:
    """Something that a user does: a title, the command, the folder, and what it must come to."""

    title: str
    command: Callable[[Place], tuple[str, ...]]
    folder: Callable[[Place], Path]
    wrong: Judgement


def full_marks(ended: Ended, _: Place) -> str | None:
    """Say what is wrong if the output is not that of full marks."""
    if ended.code == 0 and re.search(r"\b(\d+) of \1 (public )?(checks|points)", ended.text):
        return None
    return _last_line(ended.text)


def grades_of_the_class(ended: Ended, place: Place) -> str | None:
    """Say what is wrong if the class of two did not get its 50 and 0 points."""
    table = place.results / "grades.csv"
    if not table.is_file():
        return _last_line(ended.text)
    with table.open(encoding="utf-8-sig", newline="") as rows:
        scores = {row["student"]: float(row["points"] or -1) for row in csv.DictReader(rows)}
    return None if scores == {"right": 50, "starter": 0} else f"grades.csv says {scores}"


def diagnosis(ended: Ended, _: Place) -> str | None:
    """Say what is wrong if the doctor ended without its list."""
    return None if ended.code in (0, 1) and "sandbox" in ended.text.lower() else _last_line(ended.text)


#: How a check begins that could not be made here.
FAULT_OF_OURS = "The machine or the grader is at fault, not your code"

JOBS = (
    Job("doctor", lambda place: (place.spinbook, "doctor"), lambda place: place.course, diagnosis),
    Job(
        "one grade", lambda place: (place.spinbook, "grade", EXERCISE, SOLUTION), lambda place: place.course, full_marks
    ),
    Job(
        "class of two",
        lambda place: (place.spinbook, "grade", EXERCISE, f"{place.submissions}", "--out", f"{place.results}"),
        lambda place: place.course,
        grades_of_the_class,
    ),
    Job(
        "handout's check",
        lambda place: (place.spinbook, "check", EXERCISE, "answer.py"),
        lambda place: place.handout,
        full_marks,
    ),
    # IPython runs a notebook's cells in one process, without Jupyter, which reads a terminal's variables itself.
    Job(
        "%check",
        lambda place: (place.python, "-m", "IPython", "--no-banner", "answer.ipynb"),
        lambda place: place.handout,
        full_marks,
    ),
)


def main() -> int:
    """Try each condition, print a row for it, and return 1 if anything is wrong."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("names", nargs="*", help="the conditions to try; all where none is named")
    parser.add_argument("--root", type=Path, help="a bare root folder to set the project up in (needs root)")
    options = parser.parse_args()
    with tempfile.TemporaryDirectory(prefix="spinbook-machines-") as scratch:
        os.chmod(scratch, 0o755)  # noqa: PTH101  # another user's commands read it
        if options.root:
            return table_of_a_root(options.root, options.names)
        known = conditions(Path(scratch))
        if unknown := set(options.names) - {condition.name for condition in known}:
            parser.error(f"no such condition: {', '.join(unknown)}. There are: {', '.join(c.name for c in known)}")
        place = prepared(Path(scratch))
        chosen = [condition for condition in known if not options.names or condition.name in options.names]
        return table(place, chosen)


def table(place: Place, chosen: list[Condition]) -> int:
    """Print a row per condition; return 1 if anything is wrong."""
    print("| machine | " + " | ".join(job.title for job in JOBS) + " |\n| --- |" + " --- |" * len(JOBS))
    wrong = 0
    for condition in chosen:
        fields = (
            [absent] * len(JOBS)
            if (absent := condition.missing())
            else [outcome(condition, job, place) for job in JOBS]
        )
        wrong += sum(field.startswith("WRONG") for field in fields)
        print(f"| {condition.name} | " + " | ".join(fields) + " |", flush=True)
    print(f"\n{len(chosen)} machines, {wrong} fields wrong.")
    return 1 if wrong else 0


def outcome(condition: Condition, job: Job, place: Place) -> str:
    """Run a job under a condition; return its field of the table."""
    shutil.rmtree(place.results, ignore_errors=True)
    command = [*condition.prefix, *job.command(place)]
    ended = run(command, job.folder(place), condition.environment())
    if by := next((name for text, name in NOT_OURS.items() if text in ended.text), None):
        return f"refused by {by}: {_last_line(ended.text)}"
    if TRACEBACK in ended.text:
        return f"WRONG: a traceback that ends with {_last_line(ended.text)}"
    wrong = job.wrong(ended, place)
    if wrong is None:
        return "right"
    refused = ended.code not in (0, 1) and not (place.results / "grades.csv").exists()
    refused |= FAULT_OF_OURS in ended.text  # a notebook's cell ends without an exit code
    return f"{'refused' if refused else 'WRONG'}: {wrong}"


def run(command: list[str], folder: Path, environment: Mapping[str, str]) -> Ended:
    """Run a command to its end, at most `LONGEST_S`."""
    try:
        done = subprocess.run(
            command,
            cwd=folder,
            env=environment,
            capture_output=True,
            timeout=LONGEST_S,
            check=False,
            stdin=subprocess.DEVNULL,
        )
    except subprocess.TimeoutExpired:
        return Ended(1, f"it did not end within {LONGEST_S} s")
    return Ended(done.returncode, (done.stdout + done.stderr).decode("utf-8", "replace"))


def prepared(scratch: Path) -> Place:
    """Make the course, its handout and a class of two in a folder that every user can read and write."""
    place = Place(
        scratch / "course",
        scratch / "student",
        scratch / "submissions",
        scratch / "results",
        sys.executable,
    )
    tracked = ("course.toml", "chapters", "exercises", "solutions", "interfaces")
    place.course.mkdir()
    for name in tracked:
        source = ROOT / name
        if source.is_dir():
            shutil.copytree(source, place.course / name, ignore=shutil.ignore_patterns("__pycache__"))
        elif source.exists():
            shutil.copy(source, place.course)
    unpack_handout(place)
    write_class(place)
    for path in (place.course, place.handout, scratch):
        subprocess.run(["chmod", "-R", "a+rwX", path], check=True)
    return place


def unpack_handout(place: Place) -> None:
    """Make the handout, unpack it, and put the right answer into it."""
    made = run([place.spinbook, "handout"], place.course, os.environ)
    if made.code:
        sys.exit(f"The handout could not be made:\n{made.text}")
    [archive] = (place.course / "build" / "handout").glob("*.zip")
    with zipfile.ZipFile(archive) as files:
        files.extractall(place.handout)
    [folder] = place.handout.iterdir()
    for file in folder.iterdir():
        file.rename(place.handout / file.name)
    shutil.copy(place.course / SOLUTION, place.handout / "answer.py")
    solution = (place.course / SOLUTION).read_text("utf-8")
    cells = ("%load_ext spinbook", f"%%node {EXERCISE}\n{solution}", f"%check {EXERCISE}")
    notebook = nbformat.v4.new_notebook(cells=[nbformat.v4.new_code_cell(cell) for cell in cells])
    nbformat.write(notebook, place.handout / "answer.ipynb")


def write_class(place: Place) -> None:
    """Write the class: a student with the solution, and one with a program that does nothing."""
    for student, text in (("right", (place.course / SOLUTION).read_text("utf-8")), ("starter", "import rclpy\n")):
        (place.submissions / student).mkdir(parents=True)
        (place.submissions / student / f"{EXERCISE}.py").write_text(text, encoding="utf-8")


def table_of_a_root(root: Path, names: list[str]) -> int:
    """Copy the project into a bare root folder, set it up there, and print the table of that machine."""
    archive = subprocess.run(["git", "archive", "HEAD"], cwd=ROOT, capture_output=True, check=True).stdout
    (root / "spinbook").mkdir(exist_ok=True)
    subprocess.run(["tar", "-x", "-C", root / "spinbook"], input=archive, check=True)
    with mounted(root):
        inside = 'cd /spinbook && make setup && exec .venv/bin/python benchmarks/machines/table.py "$@"'
        return subprocess.run(["chroot", root, "sh", "-c", inside, "sh", *names], check=False).returncode


@contextmanager
def mounted(root: Path) -> Iterator[None]:
    """Give a root folder its /proc and /dev, and take them away again; and this network's names and certificates."""
    for name in ("etc/resolv.conf", "etc/ssl/certs/ca-certificates.crt"):
        if Path("/", name).exists() and (root / name).parent.is_dir():
            shutil.copy(Path("/", name), root / name)
    for name in ("proc", "dev"):
        subprocess.run(["mount", "--rbind", f"/{name}", root / name], check=True)
    try:
        yield
    finally:
        for name in ("proc", "dev"):
            subprocess.run(["umount", "--recursive", "--lazy", root / name], check=False)


def _last_line(text: str) -> str:
    lines = [line.strip() for line in text.splitlines() if line.strip()]
    return lines[-1][:160] if lines else "nothing was printed"


if __name__ == "__main__":
    sys.exit(main())
