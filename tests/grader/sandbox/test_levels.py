"""The strongest level that works is chosen, and if none does, the reasons are given."""

from __future__ import annotations

import errno
import os
import resource
import subprocess
import sys
import tempfile
from collections.abc import Callable
from pathlib import Path

import pytest
from sandbox_runner import reason_against

from grader.sandbox import (
    ForkServer,
    Isolation,
    ProgramSpec,
    SandboxError,
    SandboxUnavailable,
    available,
    choose,
    filesystem,
    isolation,
    landlock,
    trial,
)

NOTHING_WORKS = {
    Isolation.BUBBLEWRAP: "bubblewrap (bwrap) is not installed",
    Isolation.NAMESPACES: "this machine allows no user namespaces",
    Isolation.LANDLOCK: "the kernel has no Landlock",
}


@pytest.fixture
def reasons(monkeypatch: pytest.MonkeyPatch) -> dict[Isolation, str]:
    """The reasons against each level, for a test to set: the trials themselves are tested below."""
    found: dict[Isolation, str] = {}
    monkeypatch.setattr(isolation, "_reason_against", found.get)
    return found


def test_the_strongest_that_works_is_chosen(reasons: dict[Isolation, str]) -> None:
    assert choose() is Isolation.BUBBLEWRAP
    for best, following in zip(list(Isolation), list(Isolation)[1:3], strict=False):
        reasons[best] = NOTHING_WORKS[best]
        assert choose() is following


def test_where_nothing_works_it_is_refused_with_every_reason(reasons: dict[Isolation, str]) -> None:
    reasons.update(NOTHING_WORKS)

    with pytest.raises(SandboxUnavailable) as refusal:
        choose()

    for reason in NOTHING_WORKS.values():
        assert reason in str(refusal.value)
    assert "--isolation none" in str(refusal.value)


def test_a_session_in_which_too_few_files_may_be_open_is_named_before_anything_runs(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(resource, "getrlimit", lambda _: (64, 128))
    with pytest.raises(SandboxUnavailable, match="may open 128 files at once, and a student's needs 1024"):
        choose(Isolation.NONE)
    monkeypatch.setattr(resource, "getrlimit", lambda which: (-1, 30 if which == resource.RLIMIT_CPU else -1))
    with pytest.raises(SandboxUnavailable, match=r"may compute for 30 s, .* `ulimit -Ht` shows it"):
        choose(Isolation.NONE)


def test_a_full_dev_shm_and_a_dev_null_that_is_a_file_are_named_before_they_end_programs(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    def full(*_: int) -> None:
        raise OSError(errno.ENOSPC, "No space left on device")

    with monkeypatch.context() as patched:
        patched.setattr(os, "posix_fallocate", full)
        with pytest.raises(SandboxUnavailable, match="/dev/shm is full"):
            choose(Isolation.NONE)
    (tmp_path / "null").touch()
    monkeypatch.setattr(os, "devnull", str(tmp_path / "null"))
    with pytest.raises(SandboxUnavailable, match="/dev/null is a file here"):
        choose(Isolation.NONE)


def test_no_sandbox_is_used_only_where_it_is_asked_for(reasons: dict[Isolation, str]) -> None:
    reasons.update(NOTHING_WORKS)

    assert choose(Isolation.NONE) is Isolation.NONE


def test_a_level_that_was_asked_for_is_not_replaced_by_another(reasons: dict[Isolation, str]) -> None:
    reasons[Isolation.LANDLOCK] = NOTHING_WORKS[Isolation.LANDLOCK]

    with pytest.raises(SandboxUnavailable, match=r"'landlock' does not work .* the kernel has no Landlock"):
        choose(Isolation.LANDLOCK)


def test_each_level_has_really_been_tried() -> None:
    found = available()

    assert set(found) == set(Isolation)
    assert found[Isolation.NONE] is None
    assert all(reason is None or len(reason) > 10 for reason in found.values())


@pytest.fixture
def tried(monkeypatch: pytest.MonkeyPatch, tmp_path: Path, reasons_of_trials: dict[Isolation, str]) -> list[Isolation]:
    """The levels that have been tried, in order; no earlier results are stored."""
    found: list[Isolation] = []
    monkeypatch.setenv("SPINBOOK_CACHE", str(tmp_path))

    def trial(level: Isolation) -> str | None:
        found.append(level)
        return reasons_of_trials.get(level)

    monkeypatch.setattr(isolation, "_tried", trial)
    return found


@pytest.fixture
def reasons_of_trials() -> dict[Isolation, str]:
    """The reasons against a level when it is tried."""
    return {}


def test_a_level_that_has_worked_is_not_tried_again_until_something_changes(
    tried: list[Isolation], monkeypatch: pytest.MonkeyPatch
) -> None:
    assert [choose(), choose()] == [Isolation.BUBBLEWRAP] * 2
    assert tried == [Isolation.BUBBLEWRAP]

    monkeypatch.setenv("LANG", "xx_XX.UTF-8")
    choose()
    assert tried == [Isolation.BUBBLEWRAP] * 2


@pytest.mark.parametrize(
    "change",
    [
        lambda patch: patch.setattr(os, "geteuid", lambda: 4711),
        lambda patch: patch.setattr(os, "uname", lambda: ("Linux", "node", "99.0", "#1", "x86_64")),
        lambda patch: patch.setattr(sys, "executable", "/bin/sh"),
        lambda patch: patch.setattr(resource, "getrlimit", lambda which: (7, 7)),
    ],
    ids=["user", "kernel", "program", "limits"],
)
def test_an_answer_of_another_user_kernel_or_program_is_not_taken_over(
    tried: list[Isolation], monkeypatch: pytest.MonkeyPatch, change: Callable[[pytest.MonkeyPatch], None]
) -> None:
    choose()
    change(monkeypatch)

    assert not any(isolation.has_worked(level) for level in Isolation)


def test_an_answer_is_for_its_level_only(tried: list[Isolation]) -> None:
    choose()
    assert [level for level in Isolation if isolation.has_worked(level)] == [Isolation.BUBBLEWRAP]


def test_a_level_that_did_not_work_is_tried_each_time(
    tried: list[Isolation], reasons_of_trials: dict[Isolation, str]
) -> None:
    reasons_of_trials[Isolation.BUBBLEWRAP] = NOTHING_WORKS[Isolation.BUBBLEWRAP]

    assert [choose(), choose()] == [Isolation.NAMESPACES] * 2
    assert tried == [Isolation.BUBBLEWRAP, Isolation.NAMESPACES, Isolation.BUBBLEWRAP]


def test_a_sandbox_that_could_not_be_made_has_its_level_tried_again(tried: list[Isolation], tmp_path: Path) -> None:
    choose()

    program = ProgramSpec("node.py", {"node.py": b"print('never')", "node.py/in_a_file.py": b""})
    with ForkServer(preload=()) as fork_server, pytest.raises(SandboxError):
        fork_server.start(program, Isolation.NONE)

    assert not isolation.has_worked(Isolation.BUBBLEWRAP)


def test_without_bubblewrap_that_level_is_told_to_be_absent(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("PATH", "/nowhere")
    isolation._tried.cache_clear()
    try:
        assert "not installed" in str(available()[Isolation.BUBBLEWRAP])
        with pytest.raises(SandboxUnavailable, match="bwrap"):
            choose(Isolation.BUBBLEWRAP)
    finally:
        isolation._tried.cache_clear()


def test_where_a_machine_refuses_user_namespaces_landlock_is_what_is_left() -> None:
    if reason := reason_against(Isolation.LANDLOCK, rootless=os.geteuid() == 0):
        pytest.skip(f"landlock: {reason}")
    code = f"""
import os, sys
sys.path[:0] = {[str(Path(__file__).parent), str(Path(__file__).parents[3])]!r}
from grader.sandbox import SandboxUnavailable, available, choose, seccomp, syscalls
from sandbox_runner import become_nobody
if os.geteuid() == 0:
    become_nobody(sys.argv[1])
# What containers do by default: unshare(2) is refused, and nothing else that matters here.
for name in set(seccomp._FORBIDDEN) - {{'unshare'}}:
    del seccomp._FORBIDDEN[name]
del seccomp._ABSENT['memfd_create']
syscalls.prctl(syscalls.PR_SET_NO_NEW_PRIVS, 1)
seccomp.install(seccomp.program())
print(choose())
print(*available().values(), sep='\\n')
"""
    with tempfile.TemporaryDirectory(prefix="nobody-") as home:
        said = subprocess.run([sys.executable, "-c", code, home], capture_output=True, text=True, check=False)

    chosen, bubblewrap, namespaces, landlock, none = said.stdout.splitlines() or [said.stderr] * 5
    assert chosen == "landlock", said.stderr
    assert "allows no user namespaces" in bubblewrap
    assert "allows no user namespaces" in namespaces
    assert landlock == none == "None"


def test_the_names_are_those_of_the_command_line() -> None:
    assert [str(one) for one in Isolation] == ["bubblewrap", "namespaces", "landlock", "none"]
    assert f"{Isolation.NONE}" == "none"


def test_as_root_landlock_names_the_folder_that_hides_python_or_interfaces_from_others(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    closed = tmp_path / "root"
    closed.mkdir(mode=0o700)
    monkeypatch.setattr(os, "geteuid", lambda: 0)
    monkeypatch.setattr(filesystem, "interpreter", lambda: (closed / "bin", closed / "interfaces"))
    monkeypatch.setattr(filesystem, "python_folders", lambda: [closed / "bin"])
    with pytest.raises(OSError, match=r"Python that other users can read, .* VENV=/opt/spinbook setup"):
        landlock.student_user()
    monkeypatch.setattr(filesystem, "python_folders", lambda: [])
    monkeypatch.setattr(filesystem, "interpreter", lambda: (closed / "interfaces",))
    with pytest.raises(OSError, match=rf"they need {closed}/interfaces\. Move the course .* chmod o\+x /"):
        landlock.student_user()


def test_as_root_what_other_users_can_not_read_is_named_before_a_student_misses_it(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path, tried: list[Isolation]
) -> None:
    (tmp_path / "modules" / "numpy").mkdir(parents=True)
    (tmp_path / "modules" / "numpy").chmod(0o700)
    (tmp_path / "modules" / "__pycache__").mkdir(mode=0o700)
    monkeypatch.setattr(filesystem, "interpreter", lambda: (tmp_path / "modules",))
    monkeypatch.setattr(filesystem, "own_path", lambda path: [])

    monkeypatch.setattr(os, "geteuid", lambda: 1000)
    assert choose() is Isolation.BUBBLEWRAP
    monkeypatch.setattr(os, "geteuid", lambda: 0)
    with pytest.raises(SandboxUnavailable, match=rf"chmod -R a\+rX {tmp_path}/modules/numpy$"):
        choose()
    assert choose(Isolation.NONE) is Isolation.NONE


def test_as_root_interfaces_in_a_folder_that_others_can_not_enter_refuse_landlock(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path, tried: list[Isolation]
) -> None:
    """A student's import of such a module failed, as if there were none."""
    (tmp_path / "closed").mkdir(mode=0o700)
    monkeypatch.setattr(os, "geteuid", lambda: 0)
    monkeypatch.setattr(filesystem, "interpreter", lambda: (tmp_path / "closed" / "interfaces",))
    with pytest.raises(SandboxUnavailable, match=r"they need .*closed/interfaces"):
        choose(Isolation.LANDLOCK)
    assert Isolation.LANDLOCK not in tried


def test_a_python_that_prints_something_at_each_start_has_its_sandboxes(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(trial, "_PROGRAM", f"print('from a .pth file')\n{trial._PROGRAM}")
    assert trial.reason_against(Isolation.NONE) is None
