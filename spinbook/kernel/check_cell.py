"""`%check` and `%submit`: find the student's code, and let another process check it or hand it in."""

from __future__ import annotations

import contextlib
import json
import os
import re
import tempfile
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from datetime import datetime
from pathlib import Path
from typing import Any

from IPython.display import display

from grader.exercise.exercise import Exercise, ExerciseError
from grader.exercise.loading import NoExercise, find, load
from grader.report import hint_steps
from grader.sandbox.middleware import MiddlewareUnavailable, require_middleware
from grader.submission.code import Code, as_text, code_of_notebook
from grader.submission.notebook import RECORD, Notebook, NotebookCell, read_notebook
from grader.submission.problems import AmbiguousProgram, Unreadable
from grader.submission.program_choice import digest_of
from grader.submission.python_code import definitions
from groundwork.clean_environment import module_command
from spinbook.kernel.cell_output import DisplayLimit
from spinbook.kernel.process import KeptProcess, Status
from spinbook.kernel.session import Session
from spinbook.package.cell_line import CellFailed


@dataclass(frozen=True)
class CheckedCode:
    """The exercise's code, and its origin, which completes "Checked: …". `warning` says that the cell's text has
    changed; it is empty if that is not known.
    """

    code: Code
    origin: str
    warning: str = ""

    def note(self, what: str, command: str) -> str:
        """Return the message for the student: `what` is "Checked" or "Handing in", `command` the command to run
        again."""
        text = f"{what}: {self.origin}."
        return f"{text}\nWARNING: {self.warning.format(command=command)}" if self.warning else text


def code_of(exercise: Exercise, session: Session, shell: Any, notebook: Path | None) -> CheckedCode:
    """Return the exercise's code as the session last ran it: its cell, and what it needs of other cells.

    Raises CellFailed, with what to do, if the cell has not been run and the notebook's file is not known.
    """
    node = exercise.file_name.removesuffix(".py")
    saved = _saved(exercise, notebook)
    try:
        if node in session.ran:
            code = code_of_notebook(Notebook(cells_as_run(session, shell)), exercise)
            edited = saved and digest_of(saved.source) != digest_of(code.source)
            edited = edited and _saved_after(notebook, session.ran_at[node])
            warning = _edited(node) if edited else _elsewhere(node, code, shell)
            return CheckedCode(code, _as_run(node, session.ran_at[node]), warning)
        if saved and notebook:
            not_run = (
                f"it has not been run since the kernel started, so this is how it was last saved in {notebook.name}"
            )
            return CheckedCode(saved, f"the cell %%node {node}; {not_run}", _elsewhere(node, saved, shell))
        with contextlib.suppress(Unreadable):
            code = code_of_notebook(Notebook(cells_as_run(session, shell)), exercise)
            return CheckedCode(code, "the cells as you ran them last, without any change that you made after that")
    except (Unreadable, AmbiguousProgram) as error:
        raise CellFailed(str(error)) from None
    raise CellFailed(f"Run the cell that begins with %%node {node} first. Then run this one again.")


def cells_as_run(session: Session, shell: Any) -> tuple[NotebookCell, ...]:
    """Return the cells that the kernel has run, each as it last ran, without those that later ones replace in full."""
    history = enumerate(shell.history_manager.input_hist_raw)
    cells = [NotebookCell(number, source) for number, source in history if source.strip()]
    ran = {cell.name: cell for cell in cells if cell.name}
    # Code that was not run from a cell, but by a test or an extension, is not in the history.
    cells += [
        NotebookCell(len(cells) + 1, f"%%node {name}\n{code}")
        for name, code in session.ran.items()
        if name not in ran or ran[name].magic.code.strip() != code.strip()
    ]
    return tuple(reversed(list(_not_replaced(cells))))


def _not_replaced(cells: Sequence[NotebookCell]) -> Iterator[NotebookCell]:
    names, defined = set[str](), set[str]()
    for cell in reversed(cells):
        own = definitions(cell.code) if cell.is_plain else set()
        if cell.name not in names and not (own and own <= defined):
            yield cell
        names |= {cell.name} - {""}
        defined |= own


def _as_run(node: str, moment: float) -> str:
    at = datetime.fromtimestamp(moment).strftime("%H:%M:%S")
    return f"the cell %%node {node} as you ran it at {at}, without any change that you made after that"


def _edited(node: str) -> str:
    return (
        f"You have changed the cell %%node {node} since you ran it, and the change is not in this result. "
        "Run that cell again, then {command}."
    )


def _elsewhere(node: str, code: Code, shell: Any) -> str:
    """Return what to say if a later version of this program was run in a cell without its magic; "" otherwise."""
    classes = "|".join(re.findall(r"^class (\w+)", code.source, re.MULTILINE)) or "$"
    program = re.compile(rf"^class (?:{classes})\b.*\bspin", re.MULTILINE | re.DOTALL)
    last = next(filter(program.search, reversed(shell.history_manager.input_hist_raw)), None)
    if last is None or NotebookCell(0, last).magic.code.strip() in code.source:
        return ""
    return (
        f"The cell that you ran last with this program does not begin with `%%node {node}`, so it is not in this "
        "result. Make that the first line of the cell, with nothing before it, run it, then {command}."
    )


def _saved_after(notebook: Path | None, moment: float) -> bool:
    """Return whether the notebook was saved after this moment (s since the epoch); if not, its file is out of date."""
    try:
        return notebook is not None and notebook.stat().st_mtime > moment
    except OSError:
        return False


def _saved(exercise: Exercise, notebook: Path | None) -> Code | None:
    try:
        return code_of_notebook(read_notebook(notebook.read_bytes()), exercise) if notebook else None
    except (OSError, Unreadable, AmbiguousProgram):
        return None


#: Set in the kernel's environment by Jupyter's server: the notebook's path.
JUPYTER = "JPY_SESSION_NAME"
#: Set among the kernel's variables by VS Code: the notebook's path.
VS_CODE = "__vsc_ipynb_file__"


def notebook_file(shell: Any) -> Path | None:
    """Return the notebook's file as last saved, or None if that is unknown (Colab, a plain terminal)."""
    for path in (shell.user_ns.get(VS_CODE), os.environ.get(JUPYTER)):
        if isinstance(path, str) and path.endswith(".ipynb"):
            file = Path(path).resolve()
            return file if file.is_file() else _renamed(file.parent, shell)
    return None


def _renamed(folder: Path, shell: Any) -> Path | None:
    """Return the only notebook that has the cell that runs now; None if a copy has it, too. JupyterLab does not tell a
    kernel that its notebook was renamed, but the cell's id."""
    request: dict[str, Any] = getattr(shell, "get_parent", dict)()
    cell = request.get("metadata", {}).get("cellId")
    with contextlib.suppress(OSError):
        readable = (file for file in folder.glob("*.ipynb") if cell and file.is_file() and os.access(file, os.R_OK))
        holding = [file for file in readable if json.dumps(cell) in file.read_text("utf-8", "replace")]
        return holding[0] if len(holding) == 1 else None
    return None


#: The time that the process has to end after SIGINT, and then after SIGTERM (s).
_GRACE = (0.5, 0.5)


def checked(exercise: Path, code: Code, seconds: float) -> dict[str, Any]:
    """Return the result for `code`: by media type (text/html and text/plain) in `shown`, and further `hints`.

    Raises CellFailed if there is none: after `seconds`, or because of a fault of ours.
    """
    # A stopped check leaves temporary files there. A program that runs as another user must be able to enter it.
    with tempfile.TemporaryDirectory(prefix="spinbook-", ignore_cleanup_errors=True) as temporary:
        folder = Path(temporary)
        folder.chmod(0o711)
        (folder / "code").write_text(as_text(code), encoding="utf-8", errors="replace")
        argv = module_command("spinbook.submit.program", os.fspath(exercise), "code", "result")
        process = KeptProcess(argv, {**os.environ, "TMPDIR": temporary}, folder)
        try:
            status = process.wait(seconds)
            if status.running:
                raise CellFailed(
                    f"The check did not finish within {seconds:g} s and was stopped. Does your program do something "
                    "for a long time before it spins its node? If not, this machine may be very busy: try again, or "
                    f"allow more time, as in %check {exercise.name} --seconds {2 * seconds:g}"
                )
            output = process.read_all()[0].decode(errors="replace")
        finally:
            if process.status.running:
                process.stop(_GRACE)
            process.close()
        return _result(folder / "result", output)


def _result(file: Path, output: str) -> dict[str, Any]:
    try:
        result: dict[str, Any] = json.loads(file.read_text(encoding="utf-8"))
    except (OSError, ValueError):
        last = "\n".join(output.strip().splitlines()[-3:])
        raise CellFailed(f"The check itself failed, which is not your fault:\n{last}") from None
    if "problem" in result:
        raise CellFailed(result["problem"])
    return result


@contextlib.contextmanager
def _when_stopped(text: str) -> Iterator[None]:
    """Make a press of Stop, wherever it comes in, a CellFailed with this text."""
    try:
        yield
    except KeyboardInterrupt:
        raise CellFailed(text) from None


@_when_stopped("The check was interrupted, so there is no result.")
def check_cell(session: Session, shell: Any, name: str, course: str, seconds: float) -> None:
    """Check the cell of the exercise `name` and show the result. Raises CellFailed if it can't be checked.

    `course` is the folder with the exercises, if it is neither this one, nor one above it, nor the notebook's.
    """
    notebook = notebook_file(shell)
    exercise = exercise_of(name, course, notebook)
    result = code_of(exercise, session, shell, notebook)
    print(result.note("Checked", f"%check {exercise.name}"))
    _prepare()
    # Saved with the notebook: the record says which of several cells counts.
    record = {RECORD: {"exercise": exercise.name, "code": digest_of(result.code.source)}}
    answer = checked(exercise.folder, result.code, seconds)
    with contextlib.suppress(OSError):  # a folder that can't be written: then there is no %hint
        hint_steps.remember(exercise, answer["hints"], Path.cwd())
    display(answer["shown"], metadata=record, raw=True)


def show_hint(shell: Any, name: str, course: str) -> None:
    """Print the next hint of the last check of the exercise `name`."""
    exercise = exercise_of(name, course, notebook_file(shell))
    print(hint_steps.next_hint(exercise, Path.cwd()))


def _prepare() -> None:
    """Compile the grader's middleware if this machine has none: not while the check's time runs. Raises CellFailed."""
    try:
        require_middleware(print)
    except MiddlewareUnavailable as error:
        raise CellFailed(f"This computer can't check programs, which is not your fault. {error}") from None


def exercise_of(name: str, course: str, notebook: Path | None) -> Exercise:
    """Return the exercise `name`, in `course`, otherwise in this folder, the notebook's, or above. Raises
    CellFailed."""
    places = [Path(course)] if course else [Path.cwd(), *([notebook.parent] if notebook else [])]
    text = ""
    for place in places:
        try:
            return load(find(name, place.resolve()))
        except NoExercise as error:
            text = text or str(error)
        except ExerciseError as error:
            raise CellFailed(f"The exercise is at fault, not your code.\n{error}") from None
    where = " and ".join(dict.fromkeys(str(place.resolve()) for place in places))
    raise CellFailed(
        f"{text}\nI looked in {where} and above. A notebook from the course's website: run its first code cells. "
        f"One from a handout: keep the notebook in the folder of the handout, or name it: %check {name} --course FOLDER"
    )


#: The time that the hand-in has to write its file after its self-check was stopped, and then after SIGTERM (s).
_HAND_IN_GRACE = (60.0, 5.0)


def submit_cell(session: Session, shell: Any, name: str, course: str, student: str | None, seconds: float) -> None:
    """Write the upload for the exercise `name`. Raises CellFailed if there is nothing to hand in, or if it fails."""
    shown_as = f"%submit {name}"
    not_handed_in = f"Nothing was handed in: it was stopped before the file was written. Run {shown_as} again."
    with _when_stopped(not_handed_in):
        status = _hand_in(session, shell, name, course, student, seconds)
    if status.ended_by and status.exit != 0:
        raise CellFailed(not_handed_in)
    if status.ended_by:
        print(
            f"The self-check was stopped, by you or because it took longer than {seconds:g} s; the file to upload has "
            f"none. To wait longer: {shown_as} --seconds {2 * seconds:g}"
        )


def _hand_in(session: Session, shell: Any, name: str, course: str, student: str | None, seconds: float) -> Status:
    notebook = notebook_file(shell)
    exercise = exercise_of(name, course, notebook)
    result = code_of(exercise, session, shell, notebook)
    print(result.note("Handing in", f"%submit {exercise.name}"))
    with contextlib.suppress(MiddlewareUnavailable):  # the upload is then written without a self-check
        require_middleware(print)
    with tempfile.TemporaryDirectory() as folder:
        for inside, content in result.code.files.items():
            file = Path(folder, exercise.name, inside)
            file.parent.mkdir(parents=True, exist_ok=True)
            file.write_bytes(content)
        is_single = len(result.code.files) == 1
        command = module_command("spinbook.start", "submit", os.fspath(exercise.folder), flags=("-u",))
        command += [os.fspath(notebook)] if notebook else []
        command += ["--code", os.fspath(file if is_single else Path(folder, exercise.name))]
        command += ["--student", student] if student is not None else []
        return session.run_command(command, {}, Path.cwd(), DisplayLimit(seconds), f"%submit {name}", _HAND_IN_GRACE)
