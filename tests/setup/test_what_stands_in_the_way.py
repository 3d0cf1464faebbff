"""If set-up can't do something, it says what to do about it."""

from __future__ import annotations

from pathlib import Path

import pytest
from setup_stage import Checkout, make_checkout

NO_NETWORK = """WARNING: Retrying (Retry(total=4, connect=None)) after connection broken by 'NewConnectionError'
ERROR: Could not find a version that satisfies the requirement click==8 (from versions: none)
ERROR: No matching distribution found for click==8
"""
UNTRUSTED = "WARNING: Retrying after 'SSLError(1, '[SSL: CERTIFICATE_VERIFY_FAILED] self-signed')'\n"
ALTERED = """ERROR: THESE PACKAGES DO NOT MATCH THE HASHES FROM THE REQUIREMENTS FILE. If you have updated the package …
    click==8 from https://example.org/click-8.whl:
"""
FULL = "ERROR: Could not install packages due to an OSError: [Errno 28] No space left on device\n"


@pytest.mark.parametrize(
    ("pip_says", "message"),
    [
        (NO_NETWORK, "PyPI can't be reached. Is there a network?"),
        (UNTRUSTED + NO_NETWORK, "does not trust the certificate of this network"),
        (ALTERED, "not the file that was pinned"),
        (FULL, "The disk is full"),
        ("Exception: something else\nin two lines\n", "in two lines"),
    ],
    ids=["no network", "unknown certificate", "altered download", "full disk", "anything else"],
)
def test_a_failing_pip_is_explained(checkout: Checkout, pip_says: str, message: str) -> None:
    checkout.tell("pip-fails", pip_says)
    code, said = checkout.set_up()
    assert code == 1
    assert message in said
    assert "The whole log: .venv/setup.log" in said
    assert pip_says in (checkout.folder / ".venv" / "setup.log").read_text()


def test_pips_retries_are_kept_out_of_sight(checkout: Checkout) -> None:
    checkout.tell("pip-fails", NO_NETWORK)
    _, said = checkout.set_up()
    assert "ERROR: No matching distribution found" in said
    assert "Retrying" not in said


@pytest.mark.parametrize("folder", ["My Courses", "a:b"])
def test_a_path_that_colcon_falls_apart_at_is_refused(tmp_path: Path, folder: str) -> None:
    checkout = make_checkout(tmp_path / folder)
    code, said = checkout.set_up()
    assert code == 1
    assert "a space or a colon" in said
    assert f"{folder}/spinbook" in said
    assert not (checkout.folder / ".venv").exists()


def test_so_is_an_environment_in_one(checkout: Checkout, tmp_path: Path) -> None:
    code, said = checkout.set_up(VENV=f"{tmp_path}/my environment")
    assert code == 1
    assert "my environment" in said


def no_venv_module(checkout: Checkout, user: int, apt: str) -> None:
    """Simulate a Debian without python3-venv, where this user's apt-get ends as `apt` says."""
    checkout.tell("no-ensurepip")
    checkout.program("id", f"#!/bin/sh\necho {user}\n")
    checkout.program("apt-get", f'#!/bin/sh\necho "apt-get $*" >>"$STAGE/calls"\n{apt}\n')
    checkout.program("sudo", '#!/bin/sh\necho "sudo $*" >>"$STAGE/calls"\necho "a password is required" >&2; exit 1\n')


def test_root_gets_the_venv_module_from_the_system(checkout: Checkout) -> None:
    no_venv_module(checkout, user=0, apt='rm -f "$STAGE/no-ensurepip"')
    code, said = checkout.set_up()
    assert code == 0
    assert "installing the system package python3." in said
    update, install, *_ = checkout.calls
    assert update.startswith("apt-get update")
    assert install.startswith("apt-get install")
    assert install.endswith("-venv")


@pytest.mark.parametrize("user", [0, 1000], ids=["root, no network", "no root"])
def test_what_can_not_be_installed_is_named(checkout: Checkout, user: int) -> None:
    no_venv_module(checkout, user, apt="exit 100")
    code, said = checkout.set_up()
    assert code == 1
    assert "sudo apt-get install python3." in said
    assert "a password is required" not in said
    assert any(call.startswith("sudo -n apt-get") for call in checkout.calls) is (user != 0)
    assert not (checkout.folder / ".venv").exists()
