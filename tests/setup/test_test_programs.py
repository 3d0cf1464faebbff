"""`make test` installs Chromium and bubblewrap if it can, and otherwise says what to install."""

from __future__ import annotations

import os
import shutil
import subprocess
from pathlib import Path

import pytest

SCRIPT = Path(__file__).parents[2] / "test-programs.sh"
APT = """echo "apt-get $*" >>"$STAGE/calls"
case "$*" in
    *update*) touch "$STAGE/listed" ;;
    *install*) [ -e "$STAGE/listed" ] || { echo "E: Unable to locate package chromium" >&2; exit 100; }
        for name in chromium bwrap; do printf '#!/bin/sh\\n' >"$STAGE/bin/$name"; chmod +x "$STAGE/bin/$name"; done ;;
esac
"""


class Machine:
    """A machine with nothing on its PATH but a shell, what the test puts there, and what that installs."""

    def __init__(self, stage: Path) -> None:
        self.stage = stage
        (stage / "bin").mkdir()
        for name in ("sh", "tail", "cut", "touch", "chmod"):
            real = shutil.which(name)
            assert real
            (stage / "bin" / name).symlink_to(real)

    def program(self, name: str, text: str = "") -> None:
        file = self.stage / "bin" / name
        file.write_text(f"#!/bin/sh\n{text}\n")
        file.chmod(0o755)

    def run(self) -> str:
        """Run the script, which never ends the tests by an exit code; return its output."""
        environment = {"PATH": os.fspath(self.stage / "bin"), "STAGE": os.fspath(self.stage)}
        done = subprocess.run(["sh", SCRIPT], env=environment, capture_output=True, text=True, check=True, timeout=60)
        assert done.stdout == ""
        return done.stderr

    @property
    def calls(self) -> list[str]:
        notes = self.stage / "calls"
        return notes.read_text().splitlines() if notes.exists() else []


@pytest.fixture
def machine(tmp_path: Path) -> Machine:
    """Root's, with apt-get and neither program."""
    machine = Machine(tmp_path)
    machine.program("apt-get", APT)
    machine.program("id", "echo 0")
    return machine


@pytest.mark.parametrize("browser", ["chromium", "chromium-browser", "google-chrome"])
def test_nothing_is_said_or_done_where_both_are_there(machine: Machine, browser: str) -> None:
    machine.program(browser)
    machine.program("bwrap")
    assert machine.run() == ""
    assert machine.calls == []


def test_root_gets_both_with_the_list_of_packages_fetched_first(machine: Machine) -> None:
    assert machine.run() == "Installing what the tests need, as system packages: chromium bubblewrap ...\n"
    update, install = machine.calls
    assert update.endswith(" update")
    assert install.endswith(" install -y --no-install-recommends chromium bubblewrap")
    assert machine.run() == ""
    assert len(machine.calls) == 2


def test_only_what_is_missing_is_installed(machine: Machine) -> None:
    machine.program("chromium")
    machine.run()
    assert machine.calls[-1].endswith("--no-install-recommends bubblewrap")


def test_a_user_with_the_right_to_it_installs_by_sudo(machine: Machine) -> None:
    machine.program("id", "echo 1000")
    machine.program("sudo", 'echo "sudo $*" >>"$STAGE/calls"; shift; "$@"')
    machine.program("true")
    machine.run()
    assert [call for call in machine.calls if call.startswith("sudo -n apt-get")]
    assert machine.run() == ""


@pytest.mark.parametrize("where", ["no right", "no apt-get", "no network"])
def test_where_they_can_not_be_installed_it_says_what_to_install(machine: Machine, where: str) -> None:
    if where == "no right":
        machine.program("id", "echo 1000")
        machine.program("sudo", 'echo "a password is required" >&2; exit 1')
    elif where == "no apt-get":
        (machine.stage / "bin" / "apt-get").unlink()
    else:
        machine.program("apt-get", 'echo "E: Could not resolve the host" >&2; exit 100')
    said = machine.run()
    assert "sudo apt-get install chromium bubblewrap\n" in said
    assert "Without Chromium the tests of pages fail" in said
    assert ("E: Could not resolve" in said) is (where == "no network")
    assert "a password is required" not in said
