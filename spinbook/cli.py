"""The `spinbook` command. Each verb has its own folder."""

from __future__ import annotations

import atexit
import errno
import gc
import importlib
import importlib.util
import sys
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import click

from groundwork.problem import AuthorError
from spinbook import __version__
from spinbook.problem import SpinbookError


@dataclass(frozen=True)
class Verb:
    """A verb: its click command as `module:name`, and one line for `spinbook --help`. Without the module `needs`, the
    verb can only show its help. If it `runs` exercises, it needs rclpy, and the course's interfaces that they use are
    compiled first.
    """

    command: str
    summary: str
    needs: str = ""
    runs: bool = False


AUTHORS = {
    "new": Verb("spinbook.new.command:new", "Make a new course or exercise that works at once."),
    "import": Verb(
        "spinbook.importing.command:import_book", "Make a course from an existing book (MkDocs, Docusaurus …)."
    ),
    "lint": Verb("spinbook.lint:lint", "Check the chapters: what is wrong, and what will not run."),
    "build": Verb(
        "spinbook.build.command:build", "Build notebooks from chapters; --execute runs them with real nodes."
    ),
    "interfaces": Verb(
        "spinbook.interfaces.command:interfaces", "List, compile and add messages, services and actions."
    ),
    "package": Verb("spinbook.package.command:package", "Write the chapters' nodes as a ROS 2 package."),
    "site": Verb("spinbook.site.command:site", "Build the course's website from the notebooks as they ran."),
    "handout": Verb(
        "spinbook.handout.contents:command", "Write what students get: no solutions, no hidden checks.", needs="rclpy"
    ),
}
INSTRUCTORS = {
    "grade": Verb("grader.command:grade", "Grade one submission, or a whole class.", runs=True),
    "trace": Verb("grader.report.trace:trace", "Show what happens in one scenario of an exercise.", runs=True),
    "audit": Verb("grader.audit.command:audit", "Show whether an exercise's checks catch what is wrong.", runs=True),
    "replay": Verb(
        "grader.classroom.replay:replay", "Show what a student's program did, as plots and bags.", runs=True
    ),
    "gradebook": Verb("spinbook.gradebook:gradebook", "Write one page and one table for all exercises."),
    "gradescope": Verb(
        "grader.gradescope.command:gradescope", "Write an autograder to upload to Gradescope.", runs=True
    ),
    "classroom50": Verb(
        "grader.classroom50.command:classroom50", "Write an autograder for Classroom 50 and GitHub Actions.", runs=True
    ),
}
STUDENTS = {
    "check": Verb("spinbook.submit.command:check", "Say what the public checks say of your node.", runs=True),
    "try": Verb(
        "spinbook.submit.trying:try_out", "Play what surrounds your node in an exercise, in real time.", runs=True
    ),
    "hint": Verb(
        "spinbook.submit.command:hint", "Show the next hint about the first check that failed.", needs="rclpy"
    ),
    "submit": Verb("spinbook.submit.command:submit", "Run the public checks, and write one file to upload.", runs=True),
    "update": Verb("spinbook.update.command:update", "Update your folder to a newer handout; your work stays."),
}
EVERYBODY = {
    "ros2": Verb("ros_in_python.ros2.command:ros2", "The ros2 command, without a ROS 2 installation."),
    "turtle": Verb("ros_in_python.turtlesim.command:turtle", "Draw the running turtlesim.", needs="rclpy"),
    "doctor": Verb("spinbook.doctor.command:doctor", "Say what works on this machine, and how to fix what does not."),
}
SECTIONS = {"Authors": AUTHORS, "Instructors": INSTRUCTORS, "Students": STUDENTS, "Everybody": EVERYBODY}
VERBS = {name: verb for section in SECTIONS.values() for name, verb in section.items()}

#: Module -> the extra of `pip install spinbook[…]` that installs it.
EXTRAS = {
    "libcst": "audit",
    "distributed": "cluster",
    "rosbags": "bag",
    "rclpy": "ros",
    "Fast DDS": "ros",
    **dict.fromkeys(("IPython", "ipykernel", "jupytext", "nbclient", "nbformat"), "notebooks"),
    "matplotlib": "plots",
    **dict.fromkeys(
        ("PIL", "sphinx", "myst_nb", "myst_parser", "latex2mathml", "livereload", "sphinx_book_theme"), "site"
    ),
}


#: Faults of a place, not of Spinbook: it is read-only, somebody else's or full.
NOT_WRITABLE = (errno.EROFS, errno.EACCES, errno.EPERM, errno.ENOSPC, errno.EDQUOT)


class Verbs(click.Group):
    """A click group that imports a verb only when it is used."""

    def list_commands(self, ctx: click.Context) -> list[str]:
        return list(VERBS)

    def get_command(self, ctx: click.Context, cmd_name: str) -> click.Command | None:
        return _load(cmd_name, VERBS[cmd_name]) if cmd_name in VERBS else None

    def resolve_command(
        self, ctx: click.Context, args: list[str]
    ) -> tuple[str | None, click.Command | None, list[str]]:
        """Refuse a verb whose `needs` is missing, unless only its help was requested."""
        name, command, rest = super().resolve_command(ctx, args)
        if name is None or name not in VERBS or set(rest) & {"-h", "--help"}:
            return name, command, rest
        needed = "rclpy" if VERBS[name].runs else VERBS[name].needs
        if needed and importlib.util.find_spec(needed) is None:
            raise _missing(name, needed)
        if VERBS[name].runs:
            _compile_interfaces(rest)
        return name, command, rest

    def invoke(self, ctx: click.Context) -> Any:
        """Run a verb. Raises UsageError if a module of an extra is missing, or Fast DDS."""
        try:
            return super().invoke(ctx)
        except ImportError as missing:
            raise _in_words(ctx.invoked_subcommand or "", missing) from None

    def format_commands(self, ctx: click.Context, formatter: click.HelpFormatter) -> None:
        """List the verbs by who uses them, without importing any."""
        for section, verbs in SECTIONS.items():
            with formatter.section(section):
                formatter.write_dl([(name, verb.summary) for name, verb in verbs.items()])


#: The exit code for a fault of the exercise or of this machine, of every verb that runs exercises.
_OUR_FAULT = 3


def _compile_interfaces(words: list[str]) -> None:
    from spinbook.interfaces.for_exercises import compile_for

    try:
        compile_for(words)
    except SpinbookError as error:
        click.echo(str(error), err=True)
        sys.exit(_OUR_FAULT)


def _load(name: str, verb: Verb) -> click.Command:
    """Return a verb's command. Raises UsageError if a module of an extra is missing."""
    module, _, attribute = verb.command.partition(":")
    try:
        command = getattr(importlib.import_module(module), attribute)
    except ImportError as missing:
        raise _in_words(name, missing) from None
    assert isinstance(command, click.Command)
    return command


def _in_words(verb: str, missing: ImportError) -> Exception:
    """Return the error that says what to install; the same error if no extra has the module."""
    package = "Fast DDS" if "librmw_fastrtps_cpp" in str(missing) else (missing.name or "").partition(".")[0]
    return _missing(verb, package) if package in EXTRAS else missing


def _missing(verb: str, package: str) -> click.UsageError:
    return click.UsageError(
        f"`spinbook {verb}` needs {package}, which is not installed. "
        f"Install it with: pip install 'spinbook[{EXTRAS[package]}]'"
    )


@click.group(cls=Verbs, context_settings={"help_option_names": ["-h", "--help"]})
@click.version_option(__version__, prog_name="spinbook")
def spinbook() -> None:
    """Turn Markdown chapters about ROS 2 into notebooks that really run, and grade students' ROS 2 nodes.

    Start in a course's folder, the one with course.toml. `spinbook VERB --help` explains a verb.
    """


def main() -> None:
    """Run `spinbook` as a program; invalid input prints a message and exits with 1, wrong usage with 2, a place
    that can't be written with 3."""
    try:
        Path.cwd()
    except FileNotFoundError:
        click.echo("The folder that this terminal is in has been removed. Go to another one with cd.", err=True)
        sys.exit(2)
    atexit.register(gc.freeze)  # runs last: the system frees the memory anyway, so there is nothing to collect
    try:
        spinbook(prog_name="spinbook")
    except AuthorError as error:
        click.echo("\n".join(map(str, error.problems)), err=True)
        sys.exit(1)
    except OSError as error:
        if error.errno not in NOT_WRITABLE or not error.filename:
            raise
        click.echo(
            f"{error.filename}: error: {error.strerror}.\n    Make room, or work in a folder that you can write to.",
            err=True,
        )
        sys.exit(3)
