"""The command `spinbook classroom50`."""

from __future__ import annotations

from pathlib import Path

import click

from grader.exercise.exercise import Exercise
from grader.exercise.loading import find, load
from grader.gradescope.command import author_errors, autograder_files, isolation_option
from grader.sandbox.program import Isolation

#: For a repository without Classroom 50. The folder that this command writes must then be a private repository.
WORKFLOW = """\
# Put this into .github/workflows/ of the repository to grade. The folder with autograder.py must be a private
# repository of yours, read with a token (Settings > Secrets > Actions): students must not be able to read it.
name: Grade @EXERCISE@
on: [push, workflow_dispatch]
permissions:
  contents: read
jobs:
  grade:
    runs-on: ubuntu-latest
    steps:
      - uses: actions/checkout@v4
      - uses: actions/checkout@v4
        with:
          repository: ${{ vars.SPINBOOK_GRADER }}
          token: ${{ secrets.SPINBOOK_GRADER_TOKEN }}
          path: .spinbook-grader
      - run: mv .spinbook-grader "$RUNNER_TEMP/grader"
      - uses: actions/setup-python@v5
        with:
          python-version: "3.12"
      - run: python "$RUNNER_TEMP/grader/autograder.py"
      - uses: actions/upload-artifact@v4
        with:
          name: result
          path: result.json
"""


@click.command(context_settings={"help_option_names": ["-h", "--help"]})
@click.argument("exercise")
@click.option("--out", type=click.Path(path_type=Path), help="The folder to write.  [default: EXERCISE-classroom50]")
@isolation_option
def classroom50(exercise: str, out: Path | None, isolation: Isolation | None) -> None:
    """Write the autograder of an EXERCISE for Classroom 50, or for GitHub Actions in any repository.

    Classroom 50: copy the contents of the folder to CLASSROOM/autograders/ASSIGNMENT/ of your organization's repository
    classroom50. Its runner starts autograder.py for each submission, which writes result.json (classroom50/result/v1).

    GitHub Actions alone: make the folder a private repository, and put its github-workflow.yml into each student's.

    The folder holds the solution and the hidden checks. Classroom 50 publishes it with GitHub Pages, where anybody who
    finds the address can read it.

    Exit codes: 0 written, 2 wrong usage, 3 the exercise is at fault.
    """
    with author_errors():
        loaded = load(find(exercise, Path.cwd()))
        files = _files(loaded, isolation)
    folder = out or Path(f"{loaded.name}-classroom50")
    for name, content in files.items():
        (folder / name).parent.mkdir(parents=True, exist_ok=True)
        (folder / name).write_bytes(content)
    click.echo(f"{folder}: copy its contents to CLASSROOM/autograders/ASSIGNMENT/ of your classroom50 repository.")
    click.echo("It contains the solution; --help says who can read it there.")


def _files(exercise: Exercise, isolation: Isolation | None) -> dict[str, bytes]:
    script = Path(__file__).with_name("autograder.py").read_text(encoding="utf-8")
    script = script.replace("@EXERCISE@", exercise.name).replace("@ISOLATION@", isolation.value if isolation else "")
    files = {name: content for name, (content, _) in autograder_files(exercise, isolation).items()}
    del files["run_autograder"]
    workflow = WORKFLOW.replace("@EXERCISE@", exercise.name)
    return {**files, "autograder.py": script.encode(), "github-workflow.yml": workflow.encode()}
