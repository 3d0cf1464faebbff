"""`spinbook doctor` and `ros2 doctor`: what works on this machine, and how to fix what does not."""

from __future__ import annotations

import dataclasses
import json
import sys
from pathlib import Path

import click
from rich.console import Console
from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn

from ros_in_python.ros2.cli import CONTEXT, CommandError
from ros_in_python.ros2.hello import hello
from spinbook.doctor.copies import link_copies
from spinbook.doctor.diagnosis import (
    CHECKS,
    OF_GRADING,
    OF_STUDENTS,
    MachineCheck,
    MachineFinding,
    State,
    diagnose,
    in_handout,
    is_able,
    only_grades,
    show,
)


@click.command()
@click.argument("checks", nargs=-1, type=click.Choice([check.word for check in CHECKS]), metavar="[CHECK]...")
@click.option("--json", "as_json", is_flag=True, help="Print the findings as JSON, for programs and bug reports.")
@click.option("--save-space", is_flag=True, help="Make identical copies of files in the environment one file each.")
def doctor(checks: tuple[str, ...], as_json: bool, save_space: bool) -> None:
    """Say what works on this machine, and how to fix what does not.

    Each CHECK really tries it: a message goes from one process to another, a kernel starts, colcon builds a package, a
    program runs in each sandbox. Nothing is changed, except by --save-space. Without CHECK, all checks run, in a few
    seconds; in a handout's folder, those that notebooks and self-checks need; with the extra `grade`, those that
    grading needs:

    \b
      python       folder       libraries    ros
      middleware   logs         message      environment
      memory       kernel       colcon       compiler
      namespaces   sandbox      bubblewrap   lockstep
      ros2         browser

    \b
      ✓  works
      !  courses are built and graded, but something is weaker or surprising
      ✗  courses can't be built or graded until this is fixed

    Exit code: 0 everything needed works (there may be warnings), 1 something needed does not work.
    """
    if save_space and (checks or as_json):
        raise click.UsageError("--save-space checks nothing: run it by itself.")
    if save_space:
        return _save_space()
    words = checks or (OF_GRADING if only_grades() else OF_STUDENTS if in_handout() else ())
    chosen = [check for check in CHECKS if not words or check.word in words]
    findings = _with_progress(chosen)
    if as_json:
        rows = [dataclasses.asdict(finding) for finding in findings]
        click.echo(json.dumps({"able": is_able(findings), "findings": rows}, indent=2, ensure_ascii=False))
    else:
        show(Console(highlight=False), findings)
    sys.exit(0 if is_able(findings) else 1)


def _save_space() -> None:
    try:
        saved = link_copies(Path(sys.prefix))
    except OSError as error:
        raise click.ClickException(f"{error.filename}: {error.strerror}. Every file is there, as before.") from None
    click.echo(f"{saved / 1e6:.0f} MB saved in {sys.prefix}: identical copies of a file are one file now.")


def _with_progress(chosen: list[MachineCheck]) -> list[MachineFinding]:
    """Run the checks, with a progress bar on stderr that disappears at the end."""
    columns = (TextColumn("Checking"), BarColumn(), MofNCompleteColumn(), TextColumn("{task.description}"))
    console = Console(stderr=True)
    with Progress(*columns, console=console, transient=True, disable=not console.is_terminal) as bar:
        task = bar.add_task("", total=len(chosen))
        return diagnose(chosen, lambda finding: bar.update(task, advance=1, description=finding.name))


#: The checks of `spinbook doctor` that are about ROS 2, and not about courses.
OF_ROS = ("python", "libraries", "ros", "middleware", "logs", "message", "environment", "memory")


@click.group(name="doctor", context_settings=CONTEXT, invoke_without_command=True)
@click.pass_context
@click.option("-r", "--report", is_flag=True, help="Also print what was found.")
@click.option("-rf", "--report-failed", is_flag=True, help="Also print what was found, of what failed.")
@click.option("-iw", "--include-warnings", is_flag=True, help="Count warnings as failures.")
def ros2_doctor(context: click.Context, report: bool, report_failed: bool, include_warnings: bool) -> None:
    """Check whether ROS 2 works here: libraries, middleware, a message from one process to another.

    \b
      ros2 doctor
      ros2 doctor --report
      ros2 doctor hello       on each of several computers: whether they hear each other
    """
    if context.invoked_subcommand:
        return
    findings = diagnose([check for check in CHECKS if check.word in OF_ROS], lambda finding: None)
    for finding in findings:
        if report or (report_failed and finding.state is not State.OK):
            click.echo(f"{finding.name:<24}: {finding.found}")
    for finding in findings:
        if finding.state is not State.OK:
            click.echo(f"UserWarning: {finding.name}: {finding.found} {finding.fix}", err=True)
    bad = (State.MISSING, State.WARNING) if include_warnings else (State.MISSING,)
    failed = [finding.name for finding in findings if finding.state in bad]
    if failed:
        raise CommandError(f"{len(failed)}/{len(findings)} check(s) failed", "", f"Failed modules: {' '.join(failed)}")
    click.echo(f"\nAll {len(findings)} checks passed\n")


ros2_doctor.add_command(hello)
