"""`spinbook` itself: its help, and what it says when a part of the installation is missing."""

from __future__ import annotations

import subprocess
import sys

import click
import pytest
from click.testing import CliRunner

from spinbook import cli

#: Modules that take long to import; the help of `spinbook` needs none of them.
SLOW = ("rclpy", "matplotlib", "IPython", "nbclient", "sphinx", "pytest", "grader.exercise", "jinja2")


def test_help_imports_no_verb() -> None:
    program = (
        "import sys; from click.testing import CliRunner; from spinbook.cli import spinbook\n"
        "assert CliRunner().invoke(spinbook, ['--help']).exit_code == 0\n"
        f"print([name for name in {SLOW!r} if name in sys.modules])"
    )
    done = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, timeout=120, check=True)

    assert done.stdout == "[]\n"


def test_help_names_every_verb_once() -> None:
    shown = CliRunner().invoke(cli.spinbook, ["--help"]).output

    listed = [line.split()[0] for line in shown.splitlines() if line.startswith("  ") and line[2:3].isalpha()]
    assert [name for name in listed if name in cli.VERBS] == list(cli.VERBS)


@pytest.mark.parametrize("name", cli.VERBS)
def test_every_verb_is_a_command_with_help_of_its_own(name: str) -> None:
    command = cli.spinbook.get_command(click.Context(cli.spinbook), name)

    assert command is not None
    assert command.help


def test_a_missing_extra_is_one_sentence_with_the_pip_command(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "libcst", None)
    for module in [name for name in sys.modules if name.startswith("grader.audit")]:
        monkeypatch.delitem(sys.modules, module)

    done = CliRunner().invoke(cli.spinbook, ["audit"])

    assert done.exit_code == 2
    assert "pip install 'spinbook[audit]'" in done.output
    assert "Traceback" not in done.output
