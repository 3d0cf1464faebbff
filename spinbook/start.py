"""Starts the `spinbook` command with this installation's modules, whatever the terminal's variables name."""

from __future__ import annotations

from groundwork.clean_environment import restart_if_polluted


def main() -> None:
    """Run `spinbook`. Nothing else may be imported before another installation's modules are out of the way."""
    restart_if_polluted("spinbook.start")
    from groundwork.plain_text import print_in_any_encoding

    print_in_any_encoding()
    from spinbook.cli import main as run

    run()
