"""A node cell is a process: started, shown, replaced, stopped, and never left behind."""

from __future__ import annotations

import re
import subprocess
import sys
from collections.abc import Callable

import psutil
import pytest
from notebook_kernel import Kernel
from process_mark import ProcessMark
from process_tree import beneath, command_of

TALKER = """import sys
import rclpy
from rclpy.executors import ExternalShutdownException
from std_msgs.msg import String


def main():
    rclpy.init()
    node = rclpy.create_node("talker")
    publisher = node.create_publisher(String, "/chatter", 10)
    node.create_timer(0.05, lambda: publisher.publish(String(data="from WHO")))
    node.get_logger().info("talking")
    try:
        rclpy.spin(node)
    except (KeyboardInterrupt, ExternalShutdownException):
        print("bye")


if __name__ == "__main__":
    main()
"""


def test_a_node_runs_unmodified_and_goes_on_behind_the_cell(kernel: Kernel) -> None:
    shown = kernel.run(f"%%node talker --seconds 60 --until talking\n{TALKER}")

    assert shown.error == ""
    assert "[INFO] [talker]: talking" in shown.text
    assert "talker continues in the background" in shown.text
    assert re.search(r"^talker +running", kernel.run("%nodes").text)
    assert (kernel.folder / "robot_ws/src/robot/robot/talker.py").read_text() == f"# %%node talker\n{TALKER}"


def test_running_a_cell_again_restarts_its_node(kernel: Kernel) -> None:
    kernel.run(f"%%node talker --seconds 60 --until talking\n{TALKER}")
    shown = kernel.run(f"%%node talker --seconds 60 --until talking\n{TALKER.replace('talking', 'talking anew')}")

    assert "(restarting talker with its new version)" in shown.text
    assert "talking anew" in shown.text
    assert sum("talker.py" in line and "supervisor" not in line for line in kernel_processes(kernel)) == 1


def kernel_processes(kernel: Kernel) -> list[str]:
    return [" ".join(command_of(process)) for process in beneath(psutil.Process(kernel.process_id))]


def test_stop_ends_a_node_as_ctrl_c_does(kernel: Kernel) -> None:
    kernel.run(f"%%node talker --seconds 60 --until talking\n{TALKER}")

    assert kernel.run("%stop talker").text == "talker stopped.\n"
    assert kernel.run("%nodes").text.startswith("No nodes.")
    assert "not started a node `talker`" in kernel.run("%stop talker").error
    assert "Which one?" in kernel.run("%stop").error


def test_a_node_that_ends_badly_on_ctrl_c_shows_its_words(kernel: Kernel) -> None:
    bad = TALKER.replace('print("bye")', 'raise RuntimeError("clumsy")')
    kernel.run(f"%%node talker --seconds 60 --until talking\n{bad}")

    shown = kernel.run("%stop --all")

    assert "talker stopped with exit code 1; a node that ends normally has 0." in shown.text
    assert "RuntimeError: clumsy" in shown.text


def test_a_node_that_crashes_fails_its_cell_with_its_own_words(kernel: Kernel) -> None:
    shown = kernel.run("\n%%node crash\nimport rclpy\nprint('hello')\nrclpy.no_such_thing()\n")

    assert shown.text.startswith("hello\nTraceback")
    assert 'robot_ws/src/robot/robot/crash.py", line 5' in shown.text, "as in the cell, its empty first line included"
    said, _, advice = shown.error.partition(" above. ")
    assert said == "crash ended with exit code 1. Its last output is"
    assert advice.startswith("Is the name spelled right?")


def test_a_node_that_ends_by_itself_is_said_to(kernel: Kernel) -> None:
    assert kernel.run("%%node short --seconds 60\nprint('done')\n").text == "done\n— short has ended (exit code 0) —\n"


def test_logs_come_in_order_and_whole(kernel: Kernel) -> None:
    kernel.run(
        "%%node chatty --seconds 60\nimport sys\n"
        "for i in range(3000):\n    print('line', i, file=(sys.stdout, sys.stderr)[i % 2])\n"
    )

    lines = kernel.run("%log chatty --all").text.split("\n")

    assert lines[:3000] == [f"line {i}" for i in range(3000)]


def test_long_logs_are_cut_in_the_cell_and_said_to_be(kernel: Kernel) -> None:
    text = kernel.run("%%node chatty --seconds 60\nfor i in range(500): print('line', i)\n").text

    assert text.startswith("line 0\n")
    assert "… 430 more lines: %log chatty shows them …" in text
    assert "line 499\n— chatty has ended" in text


def test_the_stop_button_ends_the_node_that_is_being_shown(kernel: Kernel) -> None:
    stop = kernel.pressing_stop(lambda shown: "talking" in shown.text)
    shown = kernel.run(f"%%node talker --seconds 80\n{TALKER}", stop)

    assert "talker stopped." in shown.text
    assert kernel.run("1 + 1").error == ""


def test_the_stop_button_hurts_no_node_in_the_background(kernel: Kernel) -> None:
    kernel.run(f"%%node talker --seconds 60 --until talking\n{TALKER}")

    stop = kernel.pressing_stop(lambda shown: "waiting" in shown.text)
    kernel.run("import time\nprint('waiting', flush=True)\ntime.sleep(60)", stop)

    assert re.search(r"^talker +running", kernel.run("%nodes").text)


def test_a_class_without_a_main_is_spun(kernel: Kernel) -> None:
    code = (
        "from rclpy.node import Node\nclass Quiet(Node):\n    def __init__(self):\n        super().__init__('quiet')\n"
    )
    shown = kernel.run(
        f"%%node quiet --seconds 60 --until here --class Quiet\n{code}        self.get_logger().info('here')\n"
    )

    assert "[INFO] [quiet]: here" in shown.text
    assert kernel.run("%stop quiet").text == "quiet stopped.\n"


#: Prints which modules of ROS are there already.
IMPORTED = """import sys
print([name for name in sys.modules if re.match(r"rclpy|.*\\.(msg|srv|action)$", name)])
"""


def test_a_class_that_forgets_an_import_fails_as_in_a_new_python(kernel: Kernel) -> None:
    code = f"import re\n{IMPORTED}import rclpy\nclass Quiet(rclpy.node.Node):\n    pass\n"

    shown = kernel.run(f"%%node quiet --seconds 60 --class Quiet\n{code}")

    file = kernel.folder / "robot_ws" / "src" / "robot" / "robot" / "quiet.py"
    python = subprocess.run([sys.executable, str(file)], capture_output=True, text=True, check=False)
    error = python.stderr.replace(f"{kernel.folder}/", "").splitlines()[1:]
    assert error[-1] == "AttributeError: module 'rclpy' has no attribute 'node'"
    assert shown.text.splitlines()[0] == python.stdout.strip() == "[]"
    assert shown.text.splitlines()[-len(error) :] == error


def test_plain_cells_do_not_have_what_spinbook_imports(kernel: Kernel) -> None:
    kernel.run("%nodes")

    assert kernel.run(f"import re\n{IMPORTED}").text == "[]\n"


@pytest.mark.parametrize("end", ["kill", "shut_down"])
def test_nodes_end_with_the_kernel_however_it_ends(
    new_kernel: Callable[..., Kernel], process_mark: ProcessMark, end: str
) -> None:
    kernel = new_kernel()
    kernel.run(f"%%node talker --seconds 60 --until talking\n{TALKER}")
    kernel.run(
        "%%node daemon --seconds 60\nimport os, time\nif os.fork() == 0:\n    os.setsid()\n    if os.fork() == 0:\n"
        "        time.sleep(1000)\n    os._exit(0)\nos.wait()\n"
    )
    kernel.run(
        "%%node stubborn --seconds 60 --until ready\nimport signal, time\nsignal.signal(2, signal.SIG_IGN)\n"
        "print('ready')\ntime.sleep(1000)\n"
    )
    assert any("talker.py" in line for line in process_mark.alive())

    getattr(kernel, end)()

    process_mark.wait_until_none()


def listener_code(count: int) -> str:
    return (
        "import rclpy\nfrom std_msgs.msg import String\nrclpy.init()\nheard = []\n"
        "node = rclpy.create_node('listener')\n"
        "node.create_subscription(String, '/chatter', lambda m: heard.append(m.data), 10)\n"
        f"while len(heard) < {count}: rclpy.spin_once(node)\nprint(sorted(set(heard)))\n"
    )


def test_two_notebooks_do_not_hear_each_other_unless_asked_to(
    new_kernel: Callable[..., Kernel], ros_domain: int
) -> None:
    one, two = new_kernel(), new_kernel()
    one.run(f"%%node talker --seconds 60 --until talking\n{TALKER.replace('WHO', 'one')}")
    two.run(f"%%node talker --seconds 60 --until talking\n{TALKER.replace('WHO', 'two')}")

    assert one.run(f"%%node listener --seconds 60\n{listener_code(20)}").text.startswith("['from one']")
    assert two.run(f"%%node listener --seconds 60\n{listener_code(20)}").text.startswith("['from two']")

    for notebook, name in ((one, "one"), (two, "two")):
        assert f"ROS_DOMAIN_ID={ros_domain} (shared)" in notebook.run(f"%domain {ros_domain}").text
        notebook.run(f"%%node talker --seconds 60 --until talking\n{TALKER.replace('WHO', name)}")
    both = one.run(
        "%%node listener --seconds 60\n" + listener_code(0).replace("len(heard) < 0", "len(set(heard)) < 2")
    ).text
    assert both.startswith("['from one', 'from two']")


def test_an_absent_middleware_does_not_kill_the_kernel(new_kernel: Callable[..., Kernel]) -> None:
    kernel = new_kernel(RMW_IMPLEMENTATION="rmw_no_such_thing")

    assert "rmw_no_such_thing, which is not installed" in kernel.loaded.text
    assert "talking" in kernel.run(f"%%node talker --seconds 60 --until talking\n{TALKER}").text


@pytest.mark.parametrize("home", ["/nonexistent", ""])
def test_nodes_run_where_there_is_no_home(new_kernel: Callable[..., Kernel], home: str) -> None:
    kernel = new_kernel(HOME=home)

    assert "talking" in kernel.run(f"%%node talker --seconds 60 --until talking\n{TALKER}").text


ANGRY = """import rclpy
from rclpy.executors import ExternalShutdownException
from std_srvs.srv import Trigger
rclpy.init()
node = rclpy.create_node("angry")
def on_request(request, response):
    node.get_logger().error("leave me alone")
    return response
node.create_service(Trigger, "ask", on_request)
node.get_logger().info("here")
try:
    rclpy.spin(node)
except (KeyboardInterrupt, ExternalShutdownException):
    pass
"""


def test_an_error_that_a_command_provokes_can_be_expected_there(kernel: Kernel) -> None:
    kernel.run(f"%%node angry --seconds 60 --until here\n{ANGRY}")
    call = "service call /ask std_srvs/srv/Trigger"

    assert "✗ angry: it logged ERROR: leave me alone.\n" in kernel.run(f"%ros2 --seconds 60 {call}").text
    meant = kernel.run(f"%ros2 --seconds 60 --expect-error {call}").text
    assert "— as expected, angry: it logged ERROR: leave me alone. —\n" in meant
