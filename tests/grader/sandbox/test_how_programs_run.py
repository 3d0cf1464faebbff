"""A student's program runs in a sandbox as `python student.py` would run it."""

from __future__ import annotations

import signal

import pytest
from sandbox_runner import Runner

from grader.sandbox import ForkServer, Isolation, ProcessExit, ProgramSpec

#: Prints the modules of ROS that are there, and those that their packages have as attributes.
SHOW = """
import sys
def show():
    there = lambda name: name.startswith('rclpy') or name.count('.') == 1 and name.endswith(('.msg', '.srv', '.action'))
    names = [name for name in sys.modules if there(name) and 'pybind11' not in name]
    print(sorted(names))
    for name in sorted(names):
        print(name, sorted(key for key, value in vars(sys.modules[name]).items() if type(value) is type(sys)))
"""

PROGRAMS = {
    "says who it is": "import sys\nprint(__name__, __file__, sys.argv, sys.path[0], __spec__, __builtins__)",
    "prints to both": "import sys\nprint('out')\nprint('err', file=sys.stderr)\nprint('out again')",
    "ends with a code": "import sys\nsys.exit(3)",
    "ends with words": "import sys\nsys.exit('what went wrong')",
    "ends at once": "import os\nprint('before', flush=True)\nos._exit(7)",
    "raises": "def callback():\n    raise RuntimeError('message 37')\n\ncallback()",
    "raises from": "try:\n    1 / 0\nexcept ZeroDivisionError as e:\n    raise ValueError('x') from e",
    "has a syntax error": "def broken(:\n    pass\n",
    "does not import": "import a_library_that_does_not_exist",
    "cleans up": "import atexit\natexit.register(print, 'cleaned up')\nraise SystemExit(2)",
    "waits for threads": (
        "import threading, time\nthreading.Thread(target=lambda: (time.sleep(0.1), print('thread'))).start()"
    ),
    "kills itself": "import os, signal\nos.kill(os.getpid(), signal.SIGTERM)",
    "has a hook": "import sys\nsys.excepthook = lambda *_: print('hooked')\n1 / 0",
    "has no errors' stream": "import sys\nsys.stderr = None\n1 / 0",
    "has an errors' stream of its own": "import sys\nsys.stderr = sys.stdout\n1 / 0",
    "raises several": "raise ExceptionGroup('both', [ValueError(1), KeyError(2)])",
    "raises what can't be shown": "class A(Exception):\n    def __str__(self): 1 / 0\nraise A()",
    "is a dataclass": "from dataclasses import dataclass\n@dataclass\nclass A:\n    x: 'int' = 1\nprint(A())",
    "pickles itself": "import pickle\nclass A: pass\nprint(type(pickle.loads(pickle.dumps(A()))).__module__)",
    "reads its input": "import sys\nprint(repr(sys.stdin.read()))",
    "imports rclpy alone": SHOW + "import rclpy\nshow()\nprint(rclpy.node)",
    "imports a package of messages alone": "import rclpy\nimport sensor_msgs\nprint(sensor_msgs.msg.JointState)",
    "imports what it uses": SHOW
    + "import rclpy\nfrom rclpy.node import Node\nshow()\n"
    + "import sensor_msgs.msg\nfrom geometry_msgs.msg import Twist\nshow()\n"
    + "print(sensor_msgs.msg.JointState(), Twist())\nshow()\n"
    + "import rclpy.action\nfrom rclpy import executors, qos\nfrom std_srvs import srv\nshow()\n"
    + "print(srv.Trigger.Request(), rclpy.action.ActionClient, executors, qos.QoSProfile(depth=3))\n"
    + "print(rclpy.__spec__.name, rclpy.action.__spec__.loader.path, sensor_msgs.msg.__spec__.origin)",
    "starts a node": SHOW + "import rclpy\nrclpy.init()\nnode = rclpy.create_node('n')\nshow()\nprint(node.get_name())",
    "logs from several lines": (
        "import os\n"
        "os.environ['RCUTILS_CONSOLE_OUTPUT_FORMAT'] = '{file_name}:{line_number} {function_name} {message}'\n"
        "from rclpy.logging import get_logger\n"
        "log = get_logger('n')\n"
        "def tell(text, **filters):\n"
        "    log.info(text, **filters)\n"
        "for i in range(3):\n"
        "    log.info(f'first {i}', once=True)\n"
        "    log.info(f'second {i}', skip_first=True)\n"
        "    tell(f'third {i}', once=True); tell(f'fourth {i}', once=True)\n"
        "exec(compile('log.info(\"from a file that does not exist\")', 'nowhere.py', 'exec'))\n"
    ),
}


@pytest.mark.parametrize("name", PROGRAMS)
def test_a_warm_start_behaves_as_a_new_python(strongest_runner: Runner, name: str) -> None:
    assert strongest_runner.run(PROGRAMS[name]) == strongest_runner.run(PROGRAMS[name], preloaded=False)


#: While its main thread ends with a long traceback, another one prints all the time.
PRINTS_MEANWHILE = """
import sys, threading
started = threading.Event()
def prints():
    while threading.main_thread().is_alive():
        print('meanwhile', file=sys.stderr)
        started.set()
def falls(depth):
    if depth:
        return falls(depth - 1) if depth % 2 else rises(depth - 1)
    raise RuntimeError('in the depth')
def rises(depth):
    return falls(depth)
threading.Thread(target=prints).start()
started.wait()
falls(100)
"""


def test_the_traceback_that_ends_a_program_is_not_mixed_with_what_other_threads_print(either_runner: Runner) -> None:
    run = either_runner.run(PRINTS_MEANWHILE)

    traceback = run.text[run.text.index("Traceback") : run.text.index("in the depth")]
    assert run.exit == ProcessExit(1, None, None)
    assert traceback.count('  File "') > 100
    assert "meanwhile" not in traceback


def test_the_source_may_declare_its_encoding(either_runner: Runner) -> None:
    run = either_runner.run("# -*- coding: latin-1 -*-\nprint('größer')".encode("latin-1"))

    assert run.text == "größer\n"


def test_source_that_is_not_utf8_is_a_syntax_error_of_the_student(either_runner: Runner) -> None:
    run = either_runner.run("print('größer')".encode("latin-1"))

    assert run.exit == ProcessExit(1, None, None)
    assert "SyntaxError" in run.text
    assert "grader" not in run.text


@pytest.mark.parametrize("name", ["a file.py", "größe.py", "-c.py", "'; rm -rf ~ #.py", "\n.py", "a" * 200 + ".py"])
def test_odd_file_names_are_run(either_runner: Runner, name: str) -> None:
    run = either_runner.run("print('ran')", name=name)

    assert run.text == "ran\n"


@pytest.mark.parametrize("name", ["../x.py", "/etc/x.py", "", "..", "a/../../x.py", "a//b.py", "x\0.py"])
def test_a_file_name_that_leaves_the_folder_is_refused(name: str) -> None:
    with pytest.raises(ValueError, match="not a path inside the submission"):
        ProgramSpec("main.py", {"main.py": b"", name: b""})


def test_only_the_environment_that_was_passed_arrives(any_runner: Runner, monkeypatch: pytest.MonkeyPatch) -> None:
    code = "import os\nprint(sorted(os.environ))\nprint(os.environ['GIVEN'])"

    names, given = any_runner.run(code, environment={"GIVEN": "this"}).text.splitlines()

    assert given == "this"
    assert not {"PYTEST_CURRENT_TEST", "SSH_AUTH_SOCK", "PIP_CERT", "TERM", "SHELL", "PWD"} & set(eval(names))


def test_the_fork_server_is_not_to_be_seen_in_the_program(either_runner: Runner) -> None:
    code = "import sys\nprint([name for name in sys.modules if name.split('.')[0] in ('grader', 'spinbook')])"

    assert either_runner.run(code).text == "[]\n"


def start_with_preloaded(fork_server: ForkServer, level: Isolation, modules: list[str], code: str) -> str:
    for module in modules:
        fork_server.preload(module)
    with fork_server.start(ProgramSpec("n.py", {"n.py": code.encode()}), level) as student:
        student.wait(60.0)
        return student.output()


def test_types_of_an_exercise_are_loaded_already_and_hidden(either_runner: Runner) -> None:
    code = (
        "import sys\nprint([name for name in ('std_srvs.srv._trigger', 'std_srvs.srv') if name in sys.modules])\n"
        "from std_srvs.srv import Trigger\nprint(Trigger.Request())"
    )

    text = either_runner.do(start_with_preloaded, ["std_srvs.srv"], code)

    assert text.splitlines() == ["['std_srvs.srv._trigger']", "std_srvs.srv.Trigger_Request()"]


def test_a_module_that_can_not_be_preloaded_is_the_programs_own_business(either_runner: Runner) -> None:
    text = either_runner.do(start_with_preloaded, ["there_is_none.msg", "a" * 900], "import there_is_none.msg")

    assert text.splitlines()[-1] == "ModuleNotFoundError: No module named 'there_is_none'"


def interrupt_a_spinning_node(fork_server: ForkServer, level: Isolation) -> tuple[ProcessExit | None, str]:
    code = "import time\ntry:\n    print('ready')\n    while True: time.sleep(0.01)\nfinally:\n    print('finally')\n"
    with fork_server.start(ProgramSpec("n.py", {"n.py": code.encode()}), level) as student:
        while "ready" not in student.output():
            assert student.wait(0.001) is None
        student.interrupt()
        return student.wait(30.0), student.output()


def test_an_interrupt_is_what_ctrl_c_is(any_runner: Runner) -> None:
    end, text = any_runner.do(interrupt_a_spinning_node)

    assert end == ProcessExit(None, signal.SIGINT, None)
    assert "finally" in text
    assert text.rstrip().endswith("KeyboardInterrupt")


def watch_cpu(fork_server: ForkServer, level: Isolation) -> tuple[float, float, int, int]:
    busy = ProgramSpec("n.py", {"n.py": b"import time\nwhile time.process_time() < 0.25: pass"})
    with fork_server.start(busy, level, core=0) as student:
        while student.cpu_seconds() < 0.15:
            assert student.wait(0.001) is None
        running, processes = student.cpu_seconds(), len(student.members())
        student.wait(60.0)
        return running, student.cpu_seconds(), processes, student.pid


def test_the_rig_sees_what_the_program_uses(any_runner: Runner) -> None:
    running_s, ended_s, processes, pid = any_runner.do(watch_cpu)

    assert running_s >= 0.15
    assert 0.25 <= ended_s < 0.48, "not twice what it used"
    assert processes == 1
    assert pid > 1


def test_a_program_stays_on_its_core(confined_runner: Runner) -> None:
    assert confined_runner.do(escape_the_core) == "1\n"


def escape_the_core(fork_server: ForkServer, level: Isolation) -> str:
    # Python reports more cores to a program than it has, so the test asks the C library.
    code = (
        "import ctypes, os\nos.sched_setaffinity(0, range(os.cpu_count()))\nmask = ctypes.create_string_buffer(128)\n"
        "ctypes.CDLL(None).sched_getaffinity(0, 128, mask)\nprint(int.from_bytes(mask.raw, 'little'))"
    )
    with fork_server.start(ProgramSpec("n.py", {"n.py": code.encode()}), level, core=0) as student:
        student.wait(30.0)
    return student.output()
