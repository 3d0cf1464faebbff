"""The `spinbook` command: one name for every verb, each of which lives in a folder of its own."""

from __future__ import annotations

import importlib
import sys

import click

from spinbook import __version__
from spinbook.problem import SpinbookError

#: Verb -> where its click command is. Loaded when it is called, so that no verb waits for another's imports.
VERBS = {
    "build": "spinbook.build.command:build",
    "lint": "spinbook.lint.command:lint",
    "package": "spinbook.package.command:package",
    "site": "spinbook.site.command:site",
    "interfaces": "spinbook.interfaces.command:interfaces",
    "ros2": "spinbook.ros2.command:ros2",
    "turtle": "spinbook.turtlesim.command:turtle",
    "grade": "grader.command:grade",
    "gradebook": "spinbook.gradebook.command:gradebook",
    "gradescope": "grader.gradescope.command:gradescope",
    "classroom50": "grader.classroom50.command:classroom50",
    "audit": "grader.audit.command:audit",
    "handout": "spinbook.handout.command:command",
    "check": "spinbook.submit.check_command:check",
    "submit": "spinbook.submit.command:submit",
    "update": "spinbook.update.command:update",
    "new": "spinbook.new.command:new",
    "import": "spinbook.importing.command:import_book",
    "doctor": "spinbook.doctor.command:doctor",
}


class Verbs(click.Group):
    """A click group that imports a verb only when it is used."""

    def list_commands(self, ctx: click.Context) -> list[str]:
        return list(VERBS)

    def get_command(self, ctx: click.Context, cmd_name: str) -> click.Command | None:
        if cmd_name not in VERBS:
            return None
        module, _, name = VERBS[cmd_name].partition(":")
        command = getattr(importlib.import_module(module), name)
        assert isinstance(command, click.Command)
        return command


@click.group(cls=Verbs, context_settings={"help_option_names": ["-h", "--help"]})
@click.version_option(__version__, prog_name="spinbook")
def spinbook() -> None:
    """Chapters about ROS 2 become notebooks that really run; students' nodes are graded by spinning them.

    Start in a course's folder (the one with course.toml):

    \b
      spinbook lint               what will not run in the chapters, and why
      spinbook build --execute    chapters -> notebooks, run with real nodes
      spinbook site               the course's website, from the notebooks as they ran
      spinbook interfaces list    the messages, services and actions that it defines
      spinbook package            the chapters' nodes as a ROS 2 package
      spinbook grade EXERCISE F   what is right and wrong in a student's node
      spinbook new COURSE         a small course of your own that works at once, to go on from
      spinbook import BOOK        a course from a book that exists (MkDocs, Docusaurus, Jupyter Book …)
      spinbook gradebook RESULTS  one page for all exercises of a class
      spinbook gradescope E       an autograder to upload to Gradescope
      spinbook classroom50 E      an autograder for Classroom 50 and GitHub Actions
      spinbook handout            what students get: no solutions, no hidden checks
      spinbook audit              whether the exercises' checks catch what is wrong

    In a student's folder of a course:

    \b
      spinbook check EXERCISE     what the public checks say of your node
      spinbook submit EXERCISE    one file to upload, with what the public checks say
      spinbook package            your notebooks' nodes as a ROS 2 package
      spinbook update NEW.zip     a newer handout, with your work kept
    """


def main() -> None:
    """Run `spinbook` as a program; bad input is told in words and exits with 1, bad usage with 2."""
    try:
        spinbook()
    except SpinbookError as error:
        click.echo(str(error), err=True)
        sys.exit(1)
