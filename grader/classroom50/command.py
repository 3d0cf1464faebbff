"""The command `spinbook classroom50`."""

from __future__ import annotations

from pathlib import Path

import click

from grader.exercise.exercise import Exercise
from grader.exercise.loading import find, load
from grader.gradescope.command import author_errors, autograder_files, isolation_option
from grader.sandbox.program import Isolation

#: The level on GitHub's machines: without bubblewrap, which would have to be installed for each run.
ON_GITHUB = Isolation.NAMESPACES


@click.command(context_settings={"help_option_names": ["-h", "--help"]})
@click.argument("exercise")
@click.option("--out", type=click.Path(path_type=Path), help="The folder to write.  [default: EXERCISE-classroom50]")
@isolation_option
def classroom50(exercise: str, out: Path | None, isolation: Isolation | None) -> None:
    """Write the autograder of an EXERCISE for Classroom 50, or for GitHub Actions in any repository.

    Classroom 50: copy the contents of the folder to CLASSROOM/autograders/ASSIGNMENT/ of your organization's repository
    classroom50. Its runner starts autograder.py for each submission, which writes result.json (classroom50/result/v1).

    GitHub Actions alone: make the folder a private repository of yours. Its workflow, .github/workflows/grade.yml,
    fetches the students' repositories and grades them as a class; that file says what to set.

    The folder holds the solution and the hidden checks, so students must not be able to read it or to write to it.
    Classroom 50 publishes it with GitHub Pages, where anybody who finds the address can read it: solutions there are
    not secret.

    Exit codes: 0 written, 2 wrong usage, 3 the exercise is at fault.
    """
    with author_errors():
        loaded = load(find(exercise, Path.cwd()))
        files = _files(loaded, isolation)
    folder = out or Path(f"{loaded.name}-classroom50")
    for name, content in files.items():
        (folder / name).parent.mkdir(parents=True, exist_ok=True)
        (folder / name).write_bytes(content)
    click.echo(f"{folder}: copy its contents to CLASSROOM/autograders/ASSIGNMENT/ of your classroom50 repository,")
    click.echo(
        "or make it a private repository for GitHub Actions. It contains the solution; --help says who can read it."
    )


def _files(exercise: Exercise, isolation: Isolation | None) -> dict[str, bytes]:
    files = autograder_files(exercise, isolation)
    del files["run_autograder"]
    files["autograder.py"] = _filled("autograder.py", exercise, isolation)
    files["fetch_repositories.py"] = _filled("fetch_repositories.py", exercise, isolation)
    files[".github/workflows/grade.yml"] = _filled("grade.yml", exercise, isolation or ON_GITHUB)
    return files


def _filled(name: str, exercise: Exercise, isolation: Isolation | None) -> bytes:
    text = Path(__file__).with_name(name).read_text(encoding="utf-8")
    level = isolation.value if isolation else ""
    return text.replace("@EXERCISE@", exercise.name).replace("@ISOLATION@", level).encode()
