"""`ros2 doctor`: whether ROS 2 works here, by the checks of `spinbook doctor` that concern it."""

from __future__ import annotations

import click

from spinbook.ros2.cli import CONTEXT, CommandError

#: The checks of `spinbook doctor` that are about ROS 2, and not about courses.
CHECKS = ("python", "libraries", "ros", "middleware", "logs", "message", "environment", "memory")


@click.command(context_settings=CONTEXT)
@click.option("-r", "--report", is_flag=True, help="Also print what was found.")
@click.option("-iw", "--include-warnings", is_flag=True, help="Count warnings as failures.")
def doctor(report: bool, include_warnings: bool) -> None:
    """Check whether ROS 2 works here: libraries, middleware, a message from one process to another.

    \b
      ros2 doctor
      ros2 doctor --report
    """
    from spinbook.doctor.diagnosis import CHECKS as ALL
    from spinbook.doctor.diagnosis import diagnose
    from spinbook.doctor.finding import State

    findings = diagnose([check for check in ALL if check.word in CHECKS], lambda finding: None)
    if report:
        for finding in findings:
            click.echo(f"{finding.name:<24}: {finding.found}")
    for finding in findings:
        if finding.state is not State.OK:
            click.echo(f"UserWarning: {finding.name}: {finding.found} {finding.fix}", err=True)
    bad = (State.MISSING, State.WARNING) if include_warnings else (State.MISSING,)
    failed = [finding.name for finding in findings if finding.state in bad]
    if failed:
        raise CommandError(f"{len(failed)}/{len(findings)} check(s) failed", "", f"Failed modules: {' '.join(failed)}")
    click.echo(f"\nAll {len(findings)} checks passed\n")
