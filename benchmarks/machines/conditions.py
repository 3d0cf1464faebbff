"""What can be odd about a machine: each condition is a changed environment, a changed folder, or a command in front."""

from __future__ import annotations

import os
import shutil
import subprocess
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from pathlib import Path

#: Modules that a program imports, in a version that breaks whatever gets it.
OF_ROS = ("rclpy", "std_msgs", "sensor_msgs")
POLLUTION = (*OF_ROS, "numpy", "json", "pytest", "yaml", "sitecustomize")
COMPILERS = ("cc", "gcc", "g++", "c++", "clang", "clang++")
#: Inside a user namespace of its own, the command may make no further one.
NO_NAMESPACES = ("unshare", "--user", "--map-root-user", "sh", "-c")
FORBID = 'echo 0 > /proc/sys/user/max_user_namespaces; exec "$@"'


@dataclass(frozen=True)
class Condition:
    """One oddity: variables to set (`None` unsets one), and words in front of each command."""

    name: str
    variables: Mapping[str, str | None] = field(default_factory=dict)
    prefix: tuple[str, ...] = ()
    #: Programs that must be there for it to be tried.
    needs: tuple[str, ...] = ()

    def environment(self) -> dict[str, str]:
        """Return the environment of its commands."""
        variables = {**os.environ, **self.variables}
        return {name: value for name, value in variables.items() if value is not None}

    def missing(self) -> str | None:
        """Return why it can't be tried here, or `None`."""
        absent = [program for program in self.needs if not shutil.which(program)]
        if absent:
            return f"no {', '.join(absent)} here"
        trial = subprocess.run([*self.prefix, "true"], capture_output=True, text=True, check=False)
        return f"not possible here: {trial.stderr.strip()}" if trial.returncode else None


def limited(name: str, limit: str) -> Condition:
    """Return a condition with a limit of the shell's `ulimit`, such as `-n 64`."""
    return Condition(f"ulimit {name}", prefix=("sh", "-c", f'ulimit {limit}; exec "$@"', "sh"))


def conditions(scratch: Path) -> list[Condition]:
    """Return every condition; what they need is written into `scratch`."""
    return [
        Condition("as it is"),
        *variables_of_others(scratch),
        *places(scratch),
        *kinds_of_text(),
        *limits(),
        *parts_missing(scratch),
        *mounts(scratch),
    ]


def variables_of_others(scratch: Path) -> list[Condition]:
    """Return conditions in which another installation has set variables."""
    polluted, libraries = scratch / "polluted", scratch / "libraries"
    for folder in (polluted, libraries):
        folder.mkdir()
    another_ros = scratch / "another-ros"
    another_ros.mkdir()
    for module in POLLUTION:
        for folder in (polluted, another_ros) if module in OF_ROS else (polluted,):
            (folder / f"{module}.py").write_text("raise RuntimeError('a module of another installation')\n")
    for library in ("librcl.so", "libstdc++.so.6", "libpython3.so"):
        (libraries / library).write_text("not a library")
    ros = {"ROS_DISTRO": "foxy", "AMENT_PREFIX_PATH": "/nowhere", "RMW_IMPLEMENTATION": "rmw_nowhere_cpp"}
    quiet = {"ROS_LOG_DIR": "/proc/nowhere", "RCUTILS_LOGGING_SEVERITY": "FATAL", "CYCLONEDDS_URI": "file:///nowhere"}
    fast_dds = {"ROS_LOCALHOST_ONLY": "1", "FASTRTPS_DEFAULT_PROFILES_FILE": "/nowhere.xml", "ROS_DOMAIN_ID": "232"}
    broken = os.fspath(polluted / "rclpy.py")
    guard = "_ROS_WHEELS_BOOTSTRAP_COMPLETE"
    tools = {"PYTEST_ADDOPTS": "--collect-only", "PYTEST_PLUGINS": "nothing", "MPLBACKEND": "TkAgg"}
    return [
        Condition("PYTHONPATH polluted", {"PYTHONPATH": os.fspath(polluted)}),
        Condition("PYTHONPATH of another ROS", {"PYTHONPATH": os.fspath(another_ros)}),
        Condition("LD_LIBRARY_PATH polluted", {"LD_LIBRARY_PATH": os.fspath(libraries)}),
        Condition("LD_LIBRARY_PATH with gaps", {"LD_LIBRARY_PATH": ":/usr/lib:.:"}),
        Condition("the wheels' guard, path lost", {guard: "1", "LD_LIBRARY_PATH": None}),
        Condition("the wheels' guard, another's path", {guard: "1", "LD_LIBRARY_PATH": os.fspath(libraries)}),
        Condition("PYTHONHOME of another Python", {"PYTHONHOME": "/nowhere"}),
        Condition("LD_PRELOAD of nothing", {"LD_PRELOAD": "/nowhere/libnothing.so"}),
        Condition("PYTHON* set", {"PYTHONOPTIMIZE": "2", "PYTHONHASHSEED": "7", "PYTHONSAFEPATH": "1"}),
        Condition("PYTHONWARNINGS=error", {"PYTHONWARNINGS": "error"}),
        Condition("ROS variables of Foxy", ros),
        Condition("ROS logs silent, and nowhere", quiet),
        Condition("variables of pytest, matplotlib", {**tools, "OMP_NUM_THREADS": "0", "VIRTUAL_ENV": "/nowhere"}),
        Condition("ROS_DOMAIN_ID=kitchen", {"ROS_DOMAIN_ID": "kitchen"}),
        Condition("Fast DDS settings, localhost only", fast_dds),
        Condition("PYTHONSTARTUP, PYTHONUSERBASE", {"PYTHONSTARTUP": broken, "PYTHONUSERBASE": os.fspath(polluted)}),
        Condition("PYTHONDEVMODE, PYTHONMALLOC", {"PYTHONDEVMODE": "1", "PYTHONMALLOC": "debug"}),
        Condition("conda's variables", {"CONDA_PREFIX": "/nowhere/conda", "CONDA_DEFAULT_ENV": "base", "_CE_M": ""}),
        Condition(
            "a proxy that is not there", dict.fromkeys(("http_proxy", "https_proxy", "ALL_PROXY"), "http://[::1]:1")
        ),
    ]


def places(scratch: Path) -> list[Condition]:
    """Return conditions in which a usual folder is odd."""
    spaced = scratch / "a folder with spaces"
    spaced.mkdir()
    return [
        Condition("HOME unset", {"HOME": None}),
        Condition("HOME that is not there", {"HOME": "/nowhere/home"}),
        Condition("HOME that can't be written", {"HOME": "/proc"}),
        Condition("TMPDIR that is not there", {"TMPDIR": "/nowhere/tmp"}),
        Condition("TMPDIR with spaces", {"TMPDIR": os.fspath(spaced)}),
        Condition("XDG_CACHE_HOME not there", {"XDG_CACHE_HOME": "/proc/nowhere"}),
    ]


def kinds_of_text() -> list[Condition]:
    """Return conditions that concern text, time and the terminal."""
    return [
        Condition("locale C, ASCII", {"LC_ALL": "C", "PYTHONUTF8": "0", "PYTHONCOERCECLOCALE": "0"}),
        Condition("locale that is not there", {"LC_ALL": "tr_TR.ISO-8859-9", "LANG": "tr_TR"}),
        Condition("stdout in Latin-1", {"PYTHONIOENCODING": "latin-1"}),
        Condition("stdout in ASCII", {"PYTHONIOENCODING": "ascii", "LANG": "C"}),
        Condition("TZ of Chatham", {"TZ": "Pacific/Chatham"}),
        Condition("TZ wrong", {"TZ": "Middle/Earth"}),
        Condition("no TERM, no colours", {"TERM": None, "NO_COLOR": "1", "COLUMNS": "20"}),
    ]


def limits() -> list[Condition]:
    """Return conditions with a resource limit, and with a priority."""
    return [
        Condition("umask 077", prefix=("sh", "-c", 'umask 077; exec "$@"', "sh")),
        Condition("umask 000", prefix=("sh", "-c", 'umask 000; exec "$@"', "sh")),
        limited("files 128", "-n 128"),
        limited("processes 64", "-u 64"),
        limited("stack 1 MB", "-s 1024"),
        limited("no core, 100 MB a file", "-c 0 -f 204800"),
        limited("memory 1 GB", "-v 1048576"),
        limited("files 64", "-n 64"),
        limited("1 MB a file", "-f 2048"),
        limited("processes 4", "-u 4"),
        limited("memory 100 MB", "-v 102400"),
        limited("CPU 5 s", "-t 5"),
        Condition("one CPU", prefix=("taskset", "-c", "0"), needs=("taskset",)),
        *(
            Condition(f"{name} closed", prefix=("sh", "-c", f'exec {number}; exec "$@"', "sh"))
            for name, number in (("stdin", "<&-"), ("stderr", "2>&-"))
        ),
        Condition("SIGPIPE, SIGCHLD, SIGINT ignored", prefix=("sh", "-c", "trap '' PIPE CHLD INT; exec \"$@\"", "sh")),
        Condition("lowest priority", prefix=("nice", "-n", "19")),
    ]


def mounts(scratch: Path) -> list[Condition]:
    """Return conditions in which a file system is odd; each is mounted for its commands alone."""
    tiny, linked, closed = scratch / "tiny", scratch / "linked", scratch / "closed"
    tiny.mkdir()
    linked.symlink_to("/tmp")
    closed.mkdir(mode=0)
    long = scratch / ("n" * 60) / ("m" * 60)
    long.mkdir(parents=True)
    return [
        Condition("TMPDIR with a long path", {"TMPDIR": os.fspath(long)}),
        Condition("TMPDIR a link", {"TMPDIR": os.fspath(linked)}),
        Condition("TMPDIR relative", {"TMPDIR": "."}),
        _mounted("TMPDIR full", f"mount -t tmpfs -o size=4k none {tiny}", {"TMPDIR": os.fspath(tiny)}),
        _mounted("TMPDIR with noexec", f"mount -t tmpfs -o noexec none {tiny}", {"TMPDIR": os.fspath(tiny)}),
        _mounted("TMPDIR read-only", f"mount -t tmpfs -o ro none {tiny}", {"TMPDIR": os.fspath(tiny)}),
        _mounted("/dev/shm of 4 kB", "mount -t tmpfs -o size=4k none /dev/shm"),
        _mounted("/dev/shm read-only, noexec", "mount -t tmpfs -o ro,noexec none /dev/shm"),
        _mounted(
            "/dev/null a file", f"touch {tiny}/null && chmod 600 {tiny}/null && mount --bind {tiny}/null /dev/null"
        ),
        _mounted("HOME read-only", f"mount -t tmpfs -o ro none {tiny}", {"HOME": os.fspath(tiny)}),
    ]


def _mounted(name: str, mount: str, variables: Mapping[str, str | None] | None = None) -> Condition:
    return Condition(
        name, variables or {}, ("unshare", "--mount", "sh", "-c", f'{mount} && exec "$@"', "sh"), ("unshare",)
    )


def parts_missing(scratch: Path) -> list[Condition]:
    """Return conditions in which a part of the machine is not there."""
    no_proc = 'mount -t tmpfs none /proc && exec "$@"'
    return [
        Condition("no compiler", {"PATH": _path_without(scratch / "no-compiler", *COMPILERS)}),
        Condition("no g++", {"PATH": _path_without(scratch / "no-gxx", "g++", "c++", "clang++")}),
        Condition("no bubblewrap", {"PATH": _path_without(scratch / "no-bwrap", "bwrap")}),
        Condition("no git, no unshare", {"PATH": _path_without(scratch / "no-git", "git", "unshare")}),
        Condition("no namespaces", prefix=(*NO_NAMESPACES, FORBID, "sh"), needs=("unshare",)),
        Condition("no network", prefix=("unshare", "--net"), needs=("unshare",)),
        Condition("no /proc", prefix=("unshare", "--mount", "sh", "-c", no_proc, "sh"), needs=("unshare",)),
        Condition("not root", {"HOME": "/nonexistent"}, _as_user(65534), ("setpriv",)),
        Condition("a user without a name or HOME", {"HOME": None}, _as_user(54321), ("setpriv",)),
    ]


def _as_user(number: int) -> tuple[str, ...]:
    return ("setpriv", f"--reuid={number}", f"--regid={number}", "--clear-groups")


def _path_without(folder: Path, *names: str) -> str:
    """Return a PATH with every program of today's but these."""
    folder.mkdir()
    _link(folder, lambda program: program not in names and not program.startswith(tuple(f"{name}-" for name in names)))
    return os.fspath(folder)


def _link(folder: Path, wanted: Callable[[str], bool]) -> None:
    for place in map(Path, os.get_exec_path()):
        for program in place.iterdir() if place.is_dir() else ():
            link = folder / program.name
            if wanted(program.name) and not link.is_symlink():
                link.symlink_to(program)
