"""A check may crash, hang or print too much: the doctor continues, reports it, and leaves no process behind."""

from __future__ import annotations

import os
from pathlib import Path

import pytest
from process_tree import runs

from spinbook.doctor.diagnosis import MachineCheck, MachineFinding, State, diagnose, examine

_HEAD = "import os, pathlib, signal, subprocess, sys, time\nfrom spinbook.doctor.diagnosis import missing, ok\n"
_EXAMINE = "def examine():\n    {}\n"


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A folder for checks of the test's own."""
    monkeypatch.setenv("PYTHONPATH", f"{tmp_path}{os.pathsep}{os.environ.get('PYTHONPATH', '')}".rstrip(os.pathsep))
    return tmp_path


def check(folder: Path, word: str, does: str, seconds: float = 60.0, needs: tuple[str, ...] = ()) -> MachineCheck:
    """Return a check that does this."""
    (folder / f"{word}_check.py").write_text(_HEAD + _EXAMINE.format(does))
    return MachineCheck(word, word.capitalize(), f"{word}_check:examine", seconds, needs)


@pytest.mark.parametrize(
    ("does", "message"),
    [
        ("sys.stderr.write('no such rmw\\n'); os._exit(102)", "the check ended with exit code 102: no such rmw"),
        ("os.kill(os.getpid(), signal.SIGSEGV)", "the check ended with signal 11"),
        ("raise OSError('the disk is on fire')", "the check ended with exit code 1: OSError: the disk is on fire"),
    ],
    ids=["exits", "crashes", "raises"],
)
def test_a_check_that_ends_its_process_is_reported(folder: Path, does: str, message: str) -> None:
    finding = examine(check(folder, "broken", does))
    assert (finding.name, finding.state, finding.found) == ("Broken", State.MISSING, message)
    assert finding.fix


def test_a_check_that_hangs_is_ended_with_all_that_it_started(folder: Path) -> None:
    does = (
        "child = subprocess.Popen(['sleep', '1000'], start_new_session=True)\n"
        f"    pathlib.Path({os.fspath(folder / 'pid')!r}).write_text(str(child.pid)); child.wait()"
    )
    finding = examine(check(folder, "hanging", does, seconds=3))
    assert finding.state is State.MISSING
    assert finding.found == "the check did not finish within 3 s"
    assert not runs(int((folder / "pid").read_text()))


def test_what_libraries_print_is_not_taken_for_the_finding(folder: Path) -> None:
    does = "print('Welcome to ROS!'); os.system('echo from C'); return ok('works')"
    assert examine(check(folder, "chatty", does)) == MachineFinding("Chatty", State.OK, "works")


def test_the_others_are_reported_in_their_order(folder: Path) -> None:
    checks = [
        check(folder, "slow", "time.sleep(0.5); return ok('works')"),
        check(folder, "broken", "os.abort()"),
        check(folder, "good", "return ok('works')"),
    ]
    seen: list[str] = []
    findings = diagnose(checks, lambda finding: seen.append(finding.name))
    assert [(finding.name, finding.state.value) for finding in findings] == [
        ("Slow", "ok"),
        ("Broken", "missing"),
        ("Good", "ok"),
    ]
    assert sorted(seen) == ["Broken", "Good", "Slow"]


def test_what_can_only_fail_is_not_tried_so_a_cause_is_reported_once(folder: Path) -> None:
    checks = [
        check(folder, "cause", "return missing('is gone', 'get it')"),
        check(folder, "effect", f"open({os.fspath(folder / 'tried')!r}, 'w')", needs=("cause",)),
    ]
    _, effect = diagnose(checks, lambda finding: None)
    assert effect == MachineFinding("Effect", State.MISSING, "not checked, because this failed: Cause", "")
    assert not (folder / "tried").exists()


def test_alone_it_is_tried_without_what_it_needs(folder: Path) -> None:
    (finding,) = diagnose([check(folder, "effect", "return ok('works')", needs=("cause",))], lambda _: None)
    assert finding.state is State.OK
