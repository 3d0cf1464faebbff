"""`spinbook update`: a newer handout, with the student's work kept."""

from __future__ import annotations

import zipfile
from pathlib import Path

import click

from groundwork.problem import Problem
from spinbook.problem import SpinbookError
from spinbook.update.handout import BASE, read_handout, refuse_another_course
from spinbook.update.merge import MergeReport
from spinbook.update.plan import UpdatePlan, carry_out, plan

#: Files that say what to install.
_INSTALLS = {"requirements.txt", "environment.yml"}


@click.command(context_settings={"help_option_names": ["-h", "--help"]})
@click.argument("new_handout", required=False, type=click.Path(path_type=Path))
@click.option("--dry-run", is_flag=True, help="Only show what would change; change nothing.")
def update(new_handout: Path | None, dry_run: bool) -> None:
    """Update your folder to a newer handout, and keep what you wrote.

    \b
      spinbook update ../course-handout.zip            the zip or folder that you were given
      spinbook update ../course-handout.zip --dry-run  only say what would be done

    Start it in your folder of the course. Save and close your notebooks first. You may leave out NEW_HANDOUT if there
    is just one handout's zip in this folder or next to it.

    The update keeps a cell that you changed or added, and replaces a cell that only the course changed. If both changed
    a cell, it keeps yours and shows the new one below it, marked CHANGED IN THE NEW HANDOUT. A cell whose code stays
    keeps its outputs. Before the update changes a file, it copies the file into backups/.

    Exit codes: 0 done (or nothing to do), 1 failed, 2 wrong usage.
    """
    folder = _folder(Path.cwd())
    source = new_handout or _only_handout(folder)
    if source.resolve() == folder:
        raise click.UsageError(f"{source} is your own folder. Name the new handout.")
    new = read_handout(source)
    refuse_another_course(source, new, folder)
    made = plan(folder, new)
    _print_plan(made)
    if not made.writes:
        if not dry_run and (made.base or made.forgotten):
            carry_out(made, folder)
        click.echo("Nothing else to do." if made.report else "Nothing to do: you have all of this handout.")
        return
    if dry_run:
        click.echo("Nothing was changed: this was a dry run.")
        return
    try:
        backup = carry_out(made, folder)
    except OSError as error:
        path = Path(error.filename) if error.filename else folder
        fix = "Fix that, then start the same update again: nothing is lost."
        raise SpinbookError(Problem(path, None, f"it can't be written: {error.strerror}.", fix)) from None
    if backup:
        click.echo(f"What was there before is in {backup.relative_to(folder)}/.")
    if _INSTALLS & {path.name for path in made.writes}:
        click.echo("What to install has changed, too: follow the first step of README.md again.")
    for wheel in (path for path in made.writes if path.suffix == ".whl"):
        click.echo(f"Spinbook itself has changed, too: pip install --force-reinstall --no-deps {wheel}")


def _folder(start: Path) -> Path:
    for folder in (start, *start.parents):
        if (folder / BASE).is_dir():
            return folder.resolve()
    if any(start.glob("*.ipynb")):
        return start.resolve()
    problem = "this is not a course's folder: there is no notebook in it."
    raise SpinbookError(Problem(start, None, problem, "Go to the folder of your notebooks, then start it again."))


def _only_handout(folder: Path) -> Path:
    found = [file for path in (folder, folder.parent) for file in sorted(path.glob("*.zip")) if _is_handout(file)]
    if len(found) == 1:
        return found[0]
    text = f"There are {', '.join(str(file) for file in found)}." if found else "No zip of a handout was found here."
    raise click.UsageError(f"Which handout? {text} Name it: spinbook update NEW_HANDOUT")


def _is_handout(file: Path) -> bool:
    try:
        with zipfile.ZipFile(file) as archive:
            return any(str(BASE) in name for name in archive.namelist())
    except (OSError, zipfile.BadZipFile, ValueError, NotImplementedError):
        return False


def _print_plan(made: UpdatePlan) -> None:
    for path, lines in sorted(made.report.items()):
        for line in lines:
            click.echo(f"{path}: {line}")
        if path in made.notebooks:
            click.echo(f"{path}:")
            for line in _lines(made.notebooks[path]):
                click.echo(f"  {line}")


def _lines(text: MergeReport) -> list[str]:
    """Return what happened to a notebook's cells, in words."""
    lines = [f"CONFLICT: you and the course changed this cell; yours is kept: {name}" for name in text.conflicts]
    lines += [
        f"the course has removed this cell; yours is kept, because you changed it: {n}"
        for n in text.kept_though_removed
    ]
    lines += [f"you had deleted this cell, and the course has changed it: it is back: {name}" for name in text.back]
    lines += [f"you deleted this cell, and it stays deleted, but an exercise needs it: {name}" for name in text.missing]
    if text.order_kept:
        lines.append("you and the course moved cells: yours are in your order")
    counted = (("changed", text.taken), ("new", text.added), ("taken out", text.removed))
    counts = [f"{len(names)} {verb}" for verb, names in counted if names]
    return [*lines, f"other cells: {', '.join(counts) or 'none changed'}. Yours are as they were."]
