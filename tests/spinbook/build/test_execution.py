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
from pathlib import Path

import pytest
from course_folder import CourseFolder
from process_mark import ProcessMark

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


def test_cells_run_and_their_outputs_are_kept(course: CourseFolder, process_mark: ProcessMark) -> None:
    course.write(
        one=f"# One\n\n{TALKER}\n```bash seconds=60 until='window: 2'\nros2 topic hz /chatter\n```\n\n"
        "```python\n6 * 7\n```\n"
    )

    said = course.spinbook("build", "--execute")

    outputs = course.outputs("one")
    assert said.returncode == 0, said.stdout
    assert "[INFO] [talker]: talking" in outputs["node-talker"]
    assert "continues in the background" in outputs["node-talker"]
    assert re.search(r"average rate: \d+\.\d{3}\n\tmin: ", outputs["ros2-topic-hz-chatter"])
    assert course.notebook("one", "executed").cells[-1].outputs[0].data["text/plain"] == "42"
    process_mark.wait_until_none()


def test_what_has_not_changed_is_not_run_again(course: CourseFolder) -> None:
    chapter = "# One\n\nProse.\n\n```python\nimport uuid\nuuid.uuid4()\n```\n"
    course.write(one=chapter).spinbook("build", "--execute")
    first = course.notebook("one", "executed").cells[-1].outputs

    said = course.write(one=chapter.replace("Prose.", "Other prose.")).spinbook("build", "--execute")
    assert "unchanged since its last run" in said.stdout
    assert course.notebook("one", "executed").cells[-1].outputs == first
    assert "Other prose." in course.notebook("one", "executed").cells[0].source, "prose is new, outputs are kept"

    said = course.write(one=chapter.replace("uuid4()", "uuid4().hex")).spinbook("build", "--execute")
    assert "ran in" in said.stdout
    assert course.spinbook("build", "--execute", "--again").stdout.count("ran in") == 1


def test_a_failing_cell_is_reported_by_chapter_and_line_with_its_log_and_the_rest_is_run(
    course: CourseFolder,
) -> None:
    crash = '```python title="crash.py"\nimport rclpy\nrclpy.init()\nprint("so far so good")\nrclpy.spin(1 / 0)\n```\n'
    course.write(
        bad=f"# Bad\n\n{crash}\n```python\na = 1\nundefined = a.b\n```\n\n```python\n'still here'\n```\n",
        good="# Good\n\n```python\n'all right'\n```\n",
    )

    said = course.spinbook("build", "--execute")

    assert said.returncode == 1
    assert "chapters/bad.md:7: crash ended with exit code 1." in said.stdout
    assert "    | so far so good" in said.stdout
    assert "    | ZeroDivisionError: division by zero" in said.stdout
    assert "chapters/bad.md:12: AttributeError: 'int' object has no attribute 'b'" in said.stdout
    assert "still here" in str(course.notebook("bad", "executed").cells[-1].outputs)
    assert "good: ran in" in said.stdout
    assert "bad: 2 cells failed" in course.spinbook("build", "--execute").stdout, "a failed run is not remembered"


def test_a_text_that_was_waited_for_in_vain_is_reported_by_chapter_and_line(course: CourseFolder) -> None:
    course.write(one=f"# One\n\n{TALKER.replace('until=talking', 'until=walking').replace('seconds=60', 'seconds=1')}")

    first, again = course.spinbook("build", "--execute"), course.spinbook("build", "--execute")

    for said in (first, again):
        assert said.returncode == 0, said.stdout
        assert "chapters/one.md:4: `until` failed: 'walking' was not printed within 1 s." in said.stdout
    assert "unchanged since its last run" in again.stdout
    assert "— the text 'walking' did not appear within 1 s —" in course.outputs("one")["node-talker"]


def test_failing_can_be_the_lesson(course: CourseFolder) -> None:
    course.write(one="# One\n\n```python raises\n1 / 0\n```\n\n```python raises\n'fine'\n```\n")

    said = course.spinbook("build", "--execute")

    assert "1 cell failed" in said.stdout
    assert "chapters/one.md:8: this cell says `raises`, but it did not fail." in said.stdout


def test_no_folder_of_the_machine_gets_into_the_outputs(course: CourseFolder) -> None:
    crash = '```python title="crash.py" raises\nimport rclpy, os\nrclpy.spin(os.getcwd() / 2)\n```\n'
    course.write(one=f"# One\n\n{crash}\n```python\nimport os\nos.getcwd() + '/x'\n```\n").spinbook(
        "build", "--execute"
    )

    assert "robot_ws/src/robot/robot/crash.py" in course.outputs("one")["node-crash"]
    assert str(course.root) not in (course.root / "build/executed/one.ipynb").read_text()


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
for i in range(100_000): print(i, line)
print("that was 100 MB")
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
    assert flood.rstrip().endswith("that was 100 MB\n— flood has ended (exit code 0) —")
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


def test_a_killed_kernel_is_reported_and_takes_its_nodes_along(course: CourseFolder, process_mark: ProcessMark) -> None:
    course.write(one=f"# One\n\n{TALKER}\n```python\nimport os, signal\nos.kill(os.getpid(), signal.SIGKILL)\n```\n")

    said = course.spinbook("build", "--execute")

    assert said.returncode == 1
    assert "chapters/one.md:20: the kernel died in this cell" in said.stdout
    process_mark.wait_until_none()


@pytest.mark.parametrize("count", [2, pytest.param(20, marks=pytest.mark.soak)])
def test_notebooks_that_run_at_once_do_not_hear_each_other(course: CourseFolder, count: int) -> None:
    names = [f"c{number:02}" for number in range(count)]
    course.write(**{name: f"# C\n\n{TALKER.replace('WHO', name)}\n{LISTENER}" for name in names})

    said = course.spinbook("build", "--execute", "--jobs", str(count))

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
