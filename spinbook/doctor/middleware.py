"""Checks of communication: the middlewares, shared memory, logs, and a message between two processes."""

from __future__ import annotations

import json
import os
import shutil
import subprocess
import sys
import tempfile
import threading
import time
from collections.abc import Mapping
from pathlib import Path

from groundwork.child_process import run_program
from rmw_lockstep import IDENTIFIER
from rmw_lockstep.library import PREBUILT, Library, library
from spinbook.doctor.diagnosis import MachineFinding, last_words, missing, ok, set_up_again, warning
from spinbook.kernel.environment import claim_domain, for_domain, missing_middleware

#: rclpy's exit code if RMW_IMPLEMENTATION can't be loaded.
NOT_LOADED = 102
_PRINT_MIDDLEWARE = "import rclpy; print(rclpy.get_rmw_implementation_identifier())"
#: Longer than the checks may take, whose end also ends this (s).
_LOADING_S = 60.0


def _load(environment: Mapping[str, str]) -> tuple[str, subprocess.CompletedProcess[str]]:
    """Load the middleware in a process of its own, which rclpy ends if the middleware is missing. Return its name."""
    trial = run_program([sys.executable, "-c", _PRINT_MIDDLEWARE], _LOADING_S, env=environment)
    return "".join(trial.stdout.splitlines()[-1:]), trial


def examine_middleware() -> MachineFinding:
    """Load the middleware that nodes use here."""
    chosen = os.environ.get("RMW_IMPLEMENTATION", "")
    absent = missing_middleware(os.environ)
    loaded, trial = _load(os.environ)
    if trial.returncode == 0:
        if loaded.startswith("rmw_fastrtps"):
            return ok(f"{loaded}{' (RMW_IMPLEMENTATION)' if chosen else ''}")
        return warning(
            f"{loaded} (RMW_IMPLEMENTATION)",
            "Spinbook's loopback profile is for Fast DDS; for other middlewares it only sets LOCALHOST. "
            "For the default: unset RMW_IMPLEMENTATION",
        )
    if absent or trial.returncode == NOT_LOADED:
        return missing(
            f"RMW_IMPLEMENTATION is '{chosen}', which is not installed here",
            "Nodes would exit with code 102 and no message. Fix: unset RMW_IMPLEMENTATION",
        )
    return missing(f"does not load: {last_words(trial)}", set_up_again())


_NEEDED = "Without it nothing can be graded or checked."


def examine_lockstep() -> MachineFinding:
    """Load the grader's middleware."""
    lockstep = library()
    if not isinstance(lockstep, Library):
        return warning(f"not available: {lockstep.reason}", f"{_NEEDED} {lockstep.remedy}")
    loaded, trial = _load({**os.environ, **lockstep.environment(os.environ)})
    if loaded == IDENTIFIER:
        return ok(f"{loaded}, {lockstep.folder}")
    reason = last_words(trial) if trial.stderr.strip() else f"rclpy has loaded {loaded or 'nothing'}"
    return warning(f"it is compiled, but does not load: {reason}", f"{_NEEDED} {_again(lockstep)}")


def _again(lockstep: Library) -> str:
    if lockstep.folder.name == PREBUILT:
        wheel = f"wheels/{PREBUILT}-*.whl"
        return f"Install its wheel again. In a handout's folder: .venv/bin/pip install --force-reinstall {wheel}"
    return f"Compile it again: rm -r {lockstep.folder}; python -m rmw_lockstep.build"


#: Bytes that should be free: each participant of Fast DDS takes about half a MB.
_ENOUGH = 32 * 2**20
_NOT_NEEDED = "Notebooks and the grader don't need it; nodes in your terminals print warnings without it."


def examine_shared_memory() -> MachineFinding:
    """Write to shared memory, and check how much is free."""
    folder = Path("/dev/shm")
    try:
        with tempfile.TemporaryFile(dir=folder) as file:
            file.write(b"spinbook")
    except OSError as error:
        return warning(f"{folder} can't be written: {error.strerror}", _NOT_NEEDED)
    free = shutil.disk_usage(folder).free
    left = sum(1 for _ in folder.glob("fastrtps_*"))
    memory = f"{folder}, {free // 2**20} MB free" + (f", {left} files of Fast DDS" if left else "")
    if free < _ENOUGH:
        return warning(
            memory,
            "Programs that import rclpy are killed when it is full.\n"
            "Remove the files of killed nodes: fastdds shm clean. In a container, use --shm-size 256m.",
        )
    return ok(memory)


def examine_log_folder() -> MachineFinding:
    """Write a file where ROS 2 would: to ROS_LOG_DIR, otherwise ROS_HOME/log, otherwise ~/.ros/log."""
    chosen, variable = _log_folder()
    if chosen is None:
        return _fallback("HOME is not set")
    existing = next(folder for folder in (chosen, *chosen.parents) if folder.exists())
    try:
        with tempfile.TemporaryFile(dir=existing):
            return ok(f"{chosen} ({variable})")
    except OSError as error:
        reason = f"{chosen} ({variable}) can't be written: {error.strerror}"
    if variable != "HOME":
        return missing(reason, f"rclpy.init would fail. Set {variable} to a folder that you can write, or unset it.")
    return _fallback(reason)


def _log_folder() -> tuple[Path | None, str]:
    if folder := os.environ.get("ROS_LOG_DIR"):
        return Path(folder).expanduser().absolute(), "ROS_LOG_DIR"
    if folder := os.environ.get("ROS_HOME"):
        return Path(folder).expanduser().absolute() / "log", "ROS_HOME"
    if folder := os.environ.get("HOME"):
        return Path(folder).absolute() / ".ros" / "log", "HOME"
    return None, "HOME"


def _fallback(reason: str) -> MachineFinding:
    """Check the temporary folder, where notebooks and `spinbook ros2` then write their logs."""
    try:
        with tempfile.TemporaryFile():
            pass
    except OSError as error:
        return missing(f"{reason}; neither can {tempfile.gettempdir()}: {error.strerror}", "Make one of them writable.")
    return warning(
        f"{reason}; Spinbook uses {tempfile.gettempdir()} instead",
        "Your own nodes in a terminal fail at rclpy.init. Fix: export ROS_LOG_DIR=/tmp/ros-log",
    )


_ARRIVES_WITHIN_S = 30.0


def examine_message() -> MachineFinding:
    """Start a publisher and a subscriber as processes, in a ROS domain of their own, on this machine's loopback."""
    inherited = dict(os.environ)
    if missing_middleware(inherited):
        del inherited["RMW_IMPLEMENTATION"]
    claimed = claim_domain()
    try:
        environment = inherited | for_domain(claimed.number, inherited)
        took = _send_one(environment)
    except subprocess.TimeoutExpired:
        return missing(
            f"none arrived within {_ARRIVES_WITHIN_S:g} s (domain {claimed.number}, 127.0.0.1)",
            "Is the loopback interface up (ip link show lo)? Does a firewall drop UDP on 127.0.0.1?",
        )
    except subprocess.CalledProcessError as error:
        return missing(
            f"the listener failed: {last_words(error)}",
            "To see its output: python -m spinbook.doctor.middleware listen",
        )
    finally:
        claimed.release()
    return ok(
        f"arrived from another process in {took['travel_s'] * 1e3:.1f} ms; discovery took "
        f" {took['discovery_s'] * 1e3:.0f} ms"
    )


def _send_one(environment: dict[str, str]) -> dict[str, float]:
    program = [sys.executable, "-m", "spinbook.doctor.middleware"]
    silent = subprocess.DEVNULL
    talker = subprocess.Popen(program, env=environment, stdin=subprocess.PIPE, stdout=silent, stderr=silent)
    try:
        listener = run_program([*program, "listen"], _ARRIVES_WITHIN_S, env=environment)
    finally:
        talker.kill()
        talker.communicate()
    listener.check_returncode()
    took = json.loads(listener.stdout)
    assert isinstance(took, dict)
    return took


TOPIC = "/spinbook_doctor"
_PERIOD_S = 0.02


# Only the two programs import rclpy: if it is missing, other checks say so.


def talk() -> None:
    """Publish the monotonic clock (ns) until standard input is closed."""
    import rclpy
    from std_msgs.msg import UInt64

    closed = threading.Event()

    def read() -> None:
        sys.stdin.read()
        closed.set()

    threading.Thread(target=read, daemon=True).start()
    rclpy.init()
    publisher = rclpy.create_node("spinbook_doctor_talker").create_publisher(UInt64, TOPIC, 10)
    while not closed.wait(_PERIOD_S):
        publisher.publish(UInt64(data=time.monotonic_ns()))
    rclpy.try_shutdown()


def listen() -> None:
    """Print `discovery_s`, from the node's start to the first message, and `travel_s`, the message's own time (s)."""
    import rclpy
    from std_msgs.msg import UInt64

    rclpy.init()
    node = rclpy.create_node("spinbook_doctor_listener")
    travels: list[float] = []

    def keep(message: UInt64) -> None:
        travels.append(time.monotonic_ns() - message.data)

    node.create_subscription(UInt64, TOPIC, keep, 10)
    start = time.monotonic()
    while not travels:
        rclpy.spin_once(node, timeout_sec=0.1)
    print(json.dumps({"discovery_s": time.monotonic() - start, "travel_s": travels[0] / 1e9}), flush=True)
    rclpy.try_shutdown()


if __name__ == "__main__":
    listen() if sys.argv[1:] == ["listen"] else talk()
