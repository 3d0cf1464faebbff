"""On Ctrl-C a program goes on only when rclpy has shut its contexts down, however late rclpy's thread gets a CPU."""

from __future__ import annotations

import signal
import textwrap

import pytest
from programs import LONGEST_S, Watch

#: Everything on one CPU, on which rclpy's thread for signals only runs while nothing else wants to.
LATE = """
def name_of(thread):
    with open(f'/proc/self/task/{thread}/comm') as file: return file.read().strip()
os.sched_setaffinity(0, [min(os.sched_getaffinity(0))])
for thread in map(int, os.listdir('/proc/self/task')):
    os.sched_setaffinity(thread, os.sched_getaffinity(0))
    if thread != os.getpid() and name_of(thread) != 'lockstep':
        os.sched_setscheduler(thread, os.SCHED_IDLE, os.sched_param(0))
"""

WAITS = {
    "a spin": "rclpy.spin(node)",
    "a spin in several threads": """
        executor = MultiThreadedExecutor(2)
        executor.add_node(node)
        executor.spin()
    """,
    "the events executor": """
        from rclpy.experimental.events_executor import EventsExecutor
        executor = EventsExecutor()
        executor.add_node(node)
        executor.spin()
    """,
    "a sleep": "while True: time.sleep(1000)",
    "a lock": "lock = threading.Lock(); lock.acquire(); lock.acquire()",
    "a condition": "threading.Event().wait(1000)",
    "a file": "import select; select.select([], [], [], 1000)",
    "an event loop": "import asyncio; asyncio.new_event_loop().run_until_complete(asyncio.sleep(1000))",
    "a read": "os.read(os.pipe()[0], 1)",
    "a thread that spins": """
        def spin():
            try: rclpy.spin(node)
            except ExternalShutdownException: pass
        thread = threading.Thread(target=spin, daemon=True)
        thread.start()
        thread.join()
    """,
}


def ended(watch: Watch, source: str) -> str:
    """Return what a program printed that gets a Ctrl-C when it is idle."""
    program = watch.start(LATE + textwrap.dedent(source))
    watch.go_on(0)
    program.process.send_signal(signal.SIGINT)
    try:
        return str(program.process.communicate(timeout=LONGEST_S)[0])
    finally:
        program.end()


@pytest.mark.parametrize("wait", WAITS.values(), ids=WAITS)
def test_after_ctrl_c_a_program_finds_its_context_shut_down(watch: Watch, wait: str) -> None:
    source = f"try:\n{textwrap.indent(textwrap.dedent(wait), '    ')}\n"
    source += "except BaseException as fault: print(rclpy.ok(), type(fault).__name__, flush=True)\nos._exit(0)\n"
    assert ended(watch, source) == "False KeyboardInterrupt\n"
