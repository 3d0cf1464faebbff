"""Notebooks are run with real nodes, in parallel, and whatever a cell does, the run ends and leaves nothing behind."""

from __future__ import annotations

import os
import re
import signal
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import nbformat
import pytest
from course_folder import CourseFolder
from nbformat.sign import NotebookNotary
from process_mark import ProcessMark

from spinbook.build import execution
from spinbook.build.execution import ExecutionResult, NotebookJob

TALKER = """```python title="talker.py" seconds=60 until=talking
import rclpy
from rclpy.executors import ExternalShutdownException
from std_msgs.msg import String

rclpy.init()
node = rclpy.create_node("talker")
publisher = node.create_publisher(String, "/chatter", 10)
node.create_timer(0.1, lambda: publisher.publish(String(data="from WHO")))
node.get_logger().info("talking")
try:
    rclpy.spin(node)
except (KeyboardInterrupt, ExternalShutdownException):
    pass
```
"""
#: Ends by itself once it has received enough, so that no cell depends on how busy the machine is.
LISTENER = """```python title="listener.py" seconds=200
import rclpy
from std_msgs.msg import String

rclpy.init()
node = rclpy.create_node("listener")
heard = []
node.create_subscription(String, "/chatter", lambda m: heard.append(m.data) or print("heard", m.data), 10)
while len(heard) < 20:
    rclpy.spin_once(node)
```
"""


#: Cells that fail, and others that are meant to; with and without a node.
BAD = """# Bad

```python title="crash.py"
import rclpy
rclpy.init()
print("so far so good")
rclpy.spin(1 / 0)
```

```python
a = 1
undefined = a.b
```

```python raises
1 / 0
```

```python raises
'fine'
```

```python title="place.py" raises
import rclpy, os
rclpy.spin(os.getcwd() / 2)
```

```python
import os
os.getcwd() + '/x'
```
"""
ONE = (
    f"# One\n\n{TALKER}\n```bash seconds=60 until='window: 2'\nros2 topic hz /chatter\n```\n\n"
    f"{TALKER.replace('talker', 'walker').replace('until=talking', 'until=walking').replace('seconds=60', 'seconds=1')}"
    "\n```python\n6 * 7\n```\n"
)
KILLED = f"# One\n\n{TALKER}\n```python\nimport os, signal\nos.kill(os.getpid(), signal.SIGKILL)\n```\n"
TINY = "# Tiny\n\nProse.\n\n```python\nimport uuid\nuuid.uuid4()\n```\n"
#: Two names with a dot, which must not be taken for one with a suffix.
CHAPTERS = {"1.one": ONE, "1.tiny": TINY, "bad": BAD, "killed": KILLED}


@dataclass(frozen=True)
class BuiltCourse:
    """A course after `build --execute`, what that said, and the mark of its processes."""

    folder: CourseFolder
    said: subprocess.CompletedProcess[str]
    processes: ProcessMark


@pytest.fixture(scope="module")
def built(tmp_path_factory: pytest.TempPathFactory) -> BuiltCourse:
    folder = CourseFolder(tmp_path_factory.mktemp("course")).write(**CHAPTERS)
    with pytest.MonkeyPatch.context() as patch:
        processes = ProcessMark(patch)
        return BuiltCourse(folder, folder.spinbook("build", "--execute"), processes)


def test_cells_run_and_their_outputs_are_kept(built: BuiltCourse) -> None:
    outputs = built.folder.outputs("1.one")
    assert "1.one: ran in" in built.said.stdout, "though others failed"
    assert "[INFO] [talker]: talking" in outputs["node-talker"]
    assert "continues in the background" in outputs["node-talker"]
    assert re.search(r"average rate: \d+\.\d{3}\n\tmin: ", outputs["ros2-topic-hz-chatter"])
    assert built.folder.notebook("1.one", "executed").cells[-1].outputs[0].data["text/plain"] == "42"


def test_jupyterlab_trusts_notebooks_that_ran_here_so_that_it_shows_their_pictures(built: BuiltCourse) -> None:
    with NotebookNotary() as notary:
        assert notary.check_signature(built.folder.notebook("1.one", "executed"))
        assert not notary.check_signature(built.folder.notebook("1.one"))


def test_a_notebook_runs_where_jupyter_can_not_note_that_it_is_trusted(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    monkeypatch.setenv("JUPYTER_DATA_DIR", str(tmp_path))
    notary: Any = NotebookNotary()
    with notary:
        notary.store.db.execute(
            "CREATE TRIGGER full BEFORE INSERT ON nbsignatures BEGIN SELECT RAISE(ABORT, 'readonly'); END"
        )
    nbformat.write(nbformat.v4.new_notebook(), tmp_path / "one.ipynb")
    job = NotebookJob(Path("one.md"), tmp_path / "one.ipynb", tmp_path)
    ran = ExecutionResult(job.chapter, job.notebook, (), 0.0, cached=True)
    monkeypatch.setattr(execution, "_execute_one", lambda *_: ran)
    assert list(execution.execute([job], 1, lambda progress: None)) == [ran]


def test_chapters_with_dots_in_their_names_keep_their_own_outputs(built: BuiltCourse) -> None:
    assert "UUID" in built.folder.notebook("1.tiny", "executed").cells[-1].outputs[0].data["text/plain"]
    assert (built.folder.root / "build/executed/1.one.graph.json").exists()


def test_a_failing_cell_is_reported_by_chapter_and_line_with_its_log_and_the_rest_is_run(built: BuiltCourse) -> None:
    said = built.said.stdout

    assert built.said.returncode == 1
    assert "chapters/bad.md:7: crash ended with exit code 1." in said
    assert "    | so far so good" in said
    assert "    | ZeroDivisionError: division by zero" in said
    assert "chapters/bad.md:12: AttributeError: 'int' object has no attribute 'b'" in said
    assert "/x'" in str(built.folder.notebook("bad", "executed").cells[-1].outputs)


def test_failing_can_be_the_lesson(built: BuiltCourse) -> None:
    assert "bad: 3 cells failed" in built.said.stdout
    assert "chapters/bad.md:20: this cell says `raises`, but it did not fail." in built.said.stdout


def test_no_folder_of_the_machine_gets_into_the_outputs(built: BuiltCourse) -> None:
    assert "robot_ws/src/robot/robot/place.py" in built.folder.outputs("bad")["node-place"]
    assert str(built.folder.root) not in (built.folder.root / "build/executed/bad.ipynb").read_text()


def test_a_text_that_was_waited_for_in_vain_is_reported_by_chapter_and_line(built: BuiltCourse) -> None:
    assert IN_VAIN in built.said.stdout
    assert "— the text 'walking' did not appear within 1 s —" in built.folder.outputs("1.one")["node-walker"]


IN_VAIN = "chapters/1.one.md:24: `until` failed: 'walking' was not printed within 1 s."


def test_a_killed_kernel_is_reported_and_no_node_is_left(built: BuiltCourse) -> None:
    assert "chapters/killed.md:20: the kernel died in this cell" in built.said.stdout
    built.processes.wait_until_none()


def test_what_has_not_changed_is_not_run_again_unless_it_failed_or_somebody_asks(built: BuiltCourse) -> None:
    course, first = built.folder, built.folder.notebook("1.tiny", "executed").cells[-1].outputs

    course.write(**{"1.tiny": TINY.replace("Prose.", "Other prose.")})
    said = course.spinbook("build", "--execute", "1.tiny", "1.one", "bad").stdout
    assert "tiny: unchanged since its last run" in said
    assert course.notebook("1.tiny", "executed").cells[-1].outputs == first
    assert "Other prose." in course.notebook("1.tiny", "executed").cells[0].source, "prose is new, outputs are kept"
    assert "one: unchanged since its last run" in said
    assert IN_VAIN in said
    assert "bad: 3 cells failed" in said, "a failed run is not remembered"

    course.write(**{"1.tiny": TINY.replace("uuid4()", "uuid4().hex")})
    assert "tiny: ran in" in course.spinbook("build", "--execute", "1.tiny").stdout
    assert "tiny: ran in" in course.spinbook("build", "--execute", "--again", "1.tiny").stdout


HOSTILE = """# Nodes that misbehave

```python title="crasher.py" raises
import rclpy
rclpy.init()
rclpy.spin(undefined)
```

```python title="stubborn.py" seconds=60 until=stop
import rclpy, signal
signal.signal(signal.SIGINT, signal.SIG_IGN)
signal.signal(signal.SIGTERM, signal.SIG_IGN)
rclpy.init(signal_handler_options=rclpy.signals.SignalHandlerOptions.NO)
print("try and stop me", flush=True)
node = rclpy.create_node("stubborn")
while True:
    rclpy.spin_once(node, timeout_sec=1)
```

```python
%stop stubborn
```

```python title="flood.py" seconds=120
import rclpy
line = "x" * 999
for i in range(20_000): print(i, line)
print("that was 20 MB")
if not rclpy: rclpy.init(); rclpy.spin(None)
```

```python title="endless.py" seconds=60 until=spinning
import rclpy
print("spinning forever")
while rclpy: pass
rclpy.init()
rclpy.spin(None)
```

```python title="daemon.py" seconds=60 until=forked
import os, rclpy, time
if os.fork() == 0:
    os.setsid()
    if os.fork() == 0:
        time.sleep(1000)
    os._exit(0)
print("forked away")
if not rclpy: rclpy.init(); rclpy.spin(None)
time.sleep(1000)
```

```python
"reached the end"
```
"""


def test_misbehaving_nodes_are_reported_in_their_cells_and_nothing_is_left_behind(
    course: CourseFolder, process_mark: ProcessMark
) -> None:
    course.write(one=HOSTILE)

    said = course.spinbook("build", "--execute", "--deadline", "200")

    assert said.returncode == 0, said.stdout
    outputs = course.outputs("one")
    assert "spinning forever" in outputs["node-endless"]
    assert "endless continues in the background" in outputs["node-endless"]
    assert "NameError: name 'undefined' is not defined" in outputs["node-crasher"]
    assert "crasher ended with exit code 1." in outputs["node-crasher"]
    assert "stubborn ignored Ctrl-C and SIGTERM" in outputs["code-nodes-that-misbehave"]
    flood = outputs["node-flood"]
    assert flood.startswith("0 xxx")
    assert "more lines" in flood
    assert flood.rstrip().endswith("that was 20 MB\n— flood has ended (exit code 0) —")
    assert len(flood) < 100_000
    assert "forked away" in outputs["node-daemon"]
    assert "reached the end" in str(course.notebook("one", "executed").cells[-1].outputs)
    process_mark.wait_until_none()


def test_the_deadline_ends_a_notebook_and_its_nodes_and_says_where(
    course: CourseFolder, process_mark: ProcessMark
) -> None:
    course.write(one=f"# One\n\n{TALKER}\n```python\nimport time\ntime.sleep(1000)\n```\n\n```python\n'never'\n```\n")

    said = course.spinbook("build", "--execute", "--deadline", "10")

    assert said.returncode == 1
    assert "chapters/one.md:20: the notebook's time limit passed in this cell" in said.stdout
    assert "talking" in course.outputs("one")["node-talker"], "what ran before is kept"
    assert "time limit passed in this cell" in course.outputs("one")["code-one"], "the cell says it too"
    process_mark.wait_until_none()


@pytest.mark.soak  # two that do not are in kernel/test_nodes.py
def test_notebooks_that_run_at_once_do_not_hear_each_other(course: CourseFolder) -> None:
    names = [f"c{number:02}" for number in range(20)]
    course.write(**{name: f"# C\n\n{TALKER.replace('WHO', name)}\n{LISTENER}" for name in names})

    said = course.spinbook("build", "--execute", "--jobs", "20")

    assert said.returncode == 0, said.stdout
    for name in names:
        assert set(re.findall(r"heard from (\w+)", course.outputs(name)["node-listener"])) == {name}


#: All notebooks of a machine share these, so they stay.
SHARED = ("spinbook-domains", f"spinbook-ros-log-{os.getuid()}")


@pytest.fixture
def empty_tmp() -> Iterator[Path]:
    """A folder for temporary files, with a path that is short enough for sockets."""
    with tempfile.TemporaryDirectory(prefix="t-") as folder:
        yield Path(folder)


def test_ctrl_c_ends_the_build_and_every_notebook_and_node_and_no_temporary_file_is_left(
    course: CourseFolder, process_mark: ProcessMark, empty_tmp: Path
) -> None:
    sleeper = "```python\nopen('../reached', 'w').close()\nimport time\ntime.sleep(1000)\n```\n"
    course.write(one=f"# One\n\n{TALKER}\n{sleeper}")
    command = [sys.executable, "-m", "spinbook", "build", "--execute"]
    environment = {**os.environ, "TMPDIR": os.fspath(empty_tmp)}
    build = subprocess.Popen(command, cwd=course.root, env=environment, stdout=subprocess.PIPE, text=True)
    reached = course.root / "build/run/reached"
    deadline = time.monotonic() + 60
    while not reached.exists():
        assert time.monotonic() < deadline
        time.sleep(0.05)

    build.send_signal(signal.SIGINT)

    assert "Interrupted" in build.communicate(timeout=60)[0]
    assert build.returncode == 130
    process_mark.wait_until_none()
    assert [left.name for left in empty_tmp.iterdir() if left.name not in SHARED] == []
