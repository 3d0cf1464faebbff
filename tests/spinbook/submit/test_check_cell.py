"""`%check` in a notebook shows the public checks' results for the exercise's cell, and never blocks the kernel.

What is shown of different mistakes is in test_shown_results.py.
"""

from __future__ import annotations

import os
import re
import signal
import threading
import time
from pathlib import Path

import psutil
import pytest
from notebook_kernel import Kernel, Shown
from process_tree import beneath, command_of
from small_class import wait_until

from grader.exercise import load
from grader.submission.code import Code
from spinbook.kernel import check_cell
from spinbook.kernel.process import KeptProcess, Status
from spinbook.package.cell_line import CellFailed
from submit.conftest import COUNTED, node_cell, solution

#: Longer than by default: whatever the check says, a busy machine must not end it first.
CHECK = "%check joint_velocity --seconds 200"


def shown_of(kernel: Kernel, code: str, check: str = CHECK) -> Shown:
    kernel.run(node_cell(code))
    return kernel.run(check)


def texts(shown: Shown) -> tuple[str, str]:
    """Return (plain text with single spaces, HTML) of a check."""
    assert not shown.error, shown.error
    assert len(shown.pictures) == 1
    return " ".join(shown.pictures[0]["text/plain"].split()), shown.pictures[0]["text/html"]


@pytest.mark.parametrize("verb", ["check", "submit", "try"])
def test_a_cell_that_was_not_run_is_asked_for(kernel: Kernel, verb: str) -> None:
    shown = kernel.run(f"%{verb} joint_velocity")

    assert shown.error == "Run the cell that begins with %%node joint_velocity first. Then run this one again."
    assert not list(kernel.folder.glob("*.zip"))


def test_a_program_that_can_not_start_is_reported_with_its_line(kernel: Kernel) -> None:
    broken = solution().replace("def main", "def main(:\n    pass\n\n\ndef other", 1)

    kernel.run(node_cell(broken))
    kernel.run(f"%%nod joint_velocity\n{solution()}")
    shown = kernel.run(CHECK)
    text, html = texts(shown)

    assert "WARNING: The cell that you ran last with this program does not begin with `%%node joint_vel" in shown.text
    line = 1 + next(i for i, line in enumerate(broken.split("\n"), start=1) if "def main(:" in line)
    for message in (text, html):
        assert "Your program did not start: SyntaxError" in message
        assert f"line {line}" in message, "lines are counted as in the cell, the one with %%node included"


def test_lines_are_those_of_the_cell_files_have_their_own_names_and_what_was_printed_is_shown(kernel: Kernel) -> None:
    broken = solution().replace("def main():\n", "def main():\n    print('one two three')\n    1 / 0\n", 1)

    log = kernel.run(node_cell(broken)).text
    text, html = texts(kernel.run(CHECK))

    line = 1 + next(i for i, line in enumerate(broken.split("\n"), start=1) if "1 / 0" in line)
    assert f'joint_velocity.py", line {line}, in main' in log, "the node's own log counts in the same way"
    for message in (text, html.replace("&#34;", '"')):
        assert "What your program printed" in message
        assert "one two three" in message
        assert f'File "joint_velocity.py", line {line}, in main' in message
        assert "/submission" not in message


@pytest.mark.soak
@pytest.mark.parametrize(
    ("before", "message"),
    [
        ("    rclpy.spin(node)", "Your program created its node, then computed for 6 s and did not spin it."),
        ("    rclpy.init()", "Your program computed for 6 s and created no node. Is there an endless loop before it?"),
    ],
)
def test_a_loop_before_the_spin_is_named_as_such(kernel: Kernel, before: str, message: str) -> None:
    line = next(line for line in solution().split("\n") if line.strip() == before.strip())
    looping = solution().replace(line, line.replace(before.strip(), f"while True: pass\n{line}"), 1)

    text, _ = texts(shown_of(kernel, looping))

    assert message in text


@pytest.mark.soak
def test_a_loop_without_end_is_reported_and_the_kernel_goes_on(kernel: Kernel) -> None:
    looping = solution().replace("answer = JointState()", "while True: pass")
    assert looping != solution()

    text, html = texts(shown_of(kernel, looping))

    for message in (text, html):
        assert "Is there an endless loop?" in message
    assert kernel.run("print(6 * 7)").text == "42\n"


def checks_of(kernel: Kernel) -> list[psutil.Process]:
    """Return the check processes that run in this kernel."""
    return [
        one
        for one in beneath(psutil.Process(kernel.process_id))
        if "spinbook.submit.program" in " ".join(command_of(one))
    ]


#: In the kernel alone, no middleware is there, and what compiles it is this.
NO_MIDDLEWARE = """
from pathlib import Path
from rmw_lockstep import build, library
there, roots, compiling = library.library(), build.library_folders, build.compile_into
library.library_folders = build.library_folders = lambda: iter([Path({folder!r})])

def compile_into(folder, ros):
    import shutil, time
    {compiling}
    shutil.copytree(there.folder, folder, symlinks=True, dirs_exist_ok=True)

build.compile_into = compile_into
"""
AS_BEFORE = "library.library_folders = build.library_folders = roots; build.compile_into = compiling"


def test_a_right_cell_passes_every_public_check_once_a_missing_middleware_is_compiled(
    kernel: Kernel, tmp_path: Path
) -> None:
    begun, go_on = tmp_path / "begun", tmp_path / "go-on"
    waits = f"Path({str(begun)!r}).touch()\n    while not Path({str(go_on)!r}).exists(): time.sleep(0.05)"
    kernel.run(NO_MIDDLEWARE.format(folder=str(tmp_path / "empty"), compiling=waits))
    shown: list[Shown] = []
    check = threading.Thread(target=lambda: shown.append(shown_of(kernel, solution())))
    check.start()
    wait_until(begun.exists)

    assert checks_of(kernel) == []

    go_on.touch()
    check.join()
    kernel.run(AS_BEFORE)
    assert "Compiling the grader's middleware, once: about 20 s ...\n" in shown[0].text
    text, html = texts(shown[0])
    assert re.search(rf"\b{COUNTED} of {COUNTED} public checks, (\d+) of \1 points\.", text)
    assert html.count('class="sb-passed"') == COUNTED
    assert "Not tested here: the stamp is also the time at which the message arrives" in text
    assert "data:image/svg+xml;base64," in html
    assert "Next: hand in. Type %submit joint_velocity into a new cell" in text


def test_a_middleware_that_can_not_be_compiled_is_one_sentence_and_no_verdict(kernel: Kernel, tmp_path: Path) -> None:
    fails = 'raise build.BuildError("g++ ended with 1:\\nIn file a.cpp:\\na.cpp:7: error: no such thing\\nand so on")'
    kernel.run(NO_MIDDLEWARE.format(folder=str(tmp_path / "empty"), compiling=fails))

    shown = shown_of(kernel, solution())

    kernel.run(AS_BEFORE)
    assert shown.error.startswith(
        "This computer can't check programs, which is not your fault. The grader's middleware could not be compiled: "
        "a.cpp:7: error: no such thing. For the compiler's full output, run "
    )
    assert "\n" not in shown.error
    assert shown.pictures == []


def test_a_check_ends_with_its_bound_and_leaves_nothing_behind(kernel: Kernel) -> None:
    shown = shown_of(kernel, solution(), "%check joint_velocity --seconds 0.05")

    assert "did not finish within 0.05 s and was stopped" in shown.error
    assert checks_of(kernel) == []


def test_stop_ends_a_check_in_the_midst_and_leaves_nothing_behind(kernel: Kernel) -> None:
    kernel.run(node_cell(solution().replace("answer = JointState()", "while True: pass")))
    started: list[psutil.Process] = []

    def press() -> None:
        deadline = time.monotonic() + 60
        while time.monotonic() < deadline:
            found = [child for check in checks_of(kernel) for child in [check, *beneath(check)]]
            if any("grader.sandbox.zygote" in " ".join(command_of(child)) for child in found):
                started.extend(found)
                break
            time.sleep(0.01)
        os.kill(kernel.process_id, signal.SIGINT)

    pressing = threading.Thread(target=press)
    pressing.start()
    shown = kernel.run(CHECK)
    pressing.join()

    assert "The check was interrupted" in shown.error
    assert len(started) > 1, "it was stopped while it had processes of its own"
    assert psutil.wait_procs(started, timeout=60)[1] == []
    assert checks_of(kernel) == []
    assert kernel.run("print(6 * 7)").text == "42\n"


def test_a_check_that_has_no_time_to_end_leaves_no_temporary_file(
    handed_out: Path, temporary_files: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def until_it_runs(process: KeptProcess, timeout_s: float) -> Status:
        wait_until(lambda: any("spinbook-" in folder for folder, _, _ in os.walk(temporary_files)))
        return process.status

    monkeypatch.setattr(KeptProcess, "wait", until_it_runs)
    monkeypatch.setattr(check_cell, "_GRACE", (0.0, 0.0))
    endless = solution().replace("answer = JointState()", "while True: pass")
    code = Code({"joint_velocity.py": endless.encode()}, "joint_velocity.py", endless)
    with pytest.raises(CellFailed, match="did not finish within 1 s"):
        check_cell.checked(handed_out / "exercises" / "joint_velocity", code, 1)
    assert list(temporary_files.iterdir()) == []


@pytest.mark.parametrize(
    ("line", "message"),
    [
        ("%check", "the following arguments are required: exercise"),
        ("%check no_such", "There is no exercise 'no_such' here. There are: joint_velocity."),
        ("%check joint_velocity --seconds soon", "invalid float value: 'soon'"),
    ],
)
def test_bad_usage_is_reported_in_words(kernel: Kernel, line: str, message: str) -> None:
    assert message in kernel.run(line).error


def test_a_folder_that_is_the_notebooks_and_the_kernels_is_named_once() -> None:
    with pytest.raises(CellFailed) as failed:
        check_cell.exercise_of("no_such", "", Path.cwd() / "mine.ipynb")
    assert str(failed.value).count(f"{Path.cwd()} ") == 1


def test_an_exercise_that_is_damaged_is_reported_as_such(kernel: Kernel, handed_out: Path) -> None:
    public = load(handed_out / "exercises" / "joint_velocity").public_file
    content = public.read_bytes()
    try:
        public.write_bytes(content[:1000])
        error = shown_of(kernel, solution()).error
    finally:
        public.write_bytes(content)

    assert "The exercise is at fault, not your code." in error
    assert "Take it from the course's handout again." in error
