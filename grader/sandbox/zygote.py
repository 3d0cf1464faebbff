"""The fork server's process: imports rclpy once, then forks a supervisor and a student for each request."""

from __future__ import annotations

import atexit
import builtins
import contextlib
import ctypes
import faulthandler
import gc
import importlib
import importlib.machinery
import io
import itertools
import os
import pickle
import resource
import signal
import socket
import sys
import types
from pathlib import Path

from grader import preloaded
from grader.sandbox import callers, filesystem, heap, seccomp, syscalls, uncaught
from grader.sandbox.confine import PassedDescriptors
from grader.sandbox.environment import for_program
from grader.sandbox.fork_server import ForkServer
from grader.sandbox.middleware import choosable, connect, load_type_support
from grader.sandbox.program import OPEN_FILES, START_REQUEST, Paths, ProgramSpec
from grader.sandbox.supervisor import StudentToRun, refuse, supervise
from groundwork.clean_environment import own_path
from rmw_lockstep import IDENTIFIER

#: The number of cores that a program sees. It runs on one core, but rclpy's MultiThreadedExecutor starts this many
#: threads, and with a single thread, programs that work on other machines would hang here.
CORES_SHOWN = 4


def run_program(program: ProgramSpec, paths: Paths) -> None:
    """Run a program as `__main__` in this process; return or raise SystemExit as the program does.

    It first connects to the hub, if there is one. So a program that ended without a connection has run none of the
    student's code: that is a fault of the machine or of ours.

    An uncaught exception prints its traceback, beginning with the student's own lines, and exits with 1; an uncaught
    KeyboardInterrupt ends the process by SIGINT. Threads, atexit and the rest of the end are the interpreter's own.
    """
    path = str(Path(paths.folder, program.main))
    variables = for_program(program, paths)
    for name in os.environ.keys() - variables.keys():
        del os.environ[name]
    for name, value in variables.items():
        if os.environ.get(name) != value:
            os.environ[name] = value
    if not program.preloaded:
        os.execv(sys.executable, [sys.executable, path, *program.arguments])
    if program.hub is not None:
        connect(variables["RMW_LOCKSTEP_SOCKET"])
    module = _prepare_main(path, program.arguments)
    os.sched_getaffinity = lambda pid: set(range(CORES_SHOWN))
    try:
        exec(compile(Path(path).read_bytes(), path, "exec", dont_inherit=True), module.__dict__)
    except SystemExit:
        raise
    except BaseException as fault:
        uncaught.end(fault)


def _prepare_main(path: str, arguments: tuple[str, ...]) -> types.ModuleType:
    """Make this interpreter look as if it had been started with the file."""
    syscalls.prctl(syscalls.PR_SET_NAME, os.fsencode(Path(sys.executable).name))
    sys.argv = [path, *arguments]
    sys.orig_argv = [sys.executable, *sys.argv]
    sys.path.insert(0, str(Path(path).parent))
    imported = [entry for entry in os.environ.get("PYTHONPATH", "").split(os.pathsep) if entry]
    sys.path[1:1] = [entry for entry in imported if entry not in sys.path]
    sys.path_importer_cache.clear()
    for name, number, mode in (("stdin", 0, "r"), ("stdout", 1, "w"), ("stderr", 2, "w")):
        errors = "surrogateescape" if mode == "r" else "backslashreplace"
        binary = io.FileIO(number, mode, closefd=False)
        buffered = io.BufferedReader(binary) if mode == "r" else io.BufferedWriter(binary)
        # Line-buffered as on a terminal, so that no text is lost when the program is killed.
        stream = io.TextIOWrapper(buffered, "utf-8", errors, line_buffering=True)
        setattr(sys, name, stream)
        setattr(sys, f"__{name}__", stream)
    # C code ends a program that gives a message a value of another type. This prints the line where it did.
    faulthandler.enable(2, all_threads=False)
    module = types.ModuleType("__main__")
    module.__file__ = path
    module.__loader__ = importlib.machinery.SourceFileLoader("__main__", path)
    module.__dict__["__builtins__"] = builtins
    module.__dict__["__cached__"] = None
    atexit.register(uncaught.end_of_interrupt)  # the first to be registered is the last to be called
    _ours.append(sys.modules["__main__"])
    sys.modules["__main__"] = module
    for name in (*_own_modules, *filter(_is_own, _modules_of_this_fork())):
        _ours.append(sys.modules.pop(name))
    return module


# The names of Spinbook's modules, and the number of all modules, before a fork. Stored here, because each name that a
# fork reads in `sys.modules` would copy a page of the fork server's memory.
_own_modules: list[str] = []
_count_of_modules: list[int] = []


def _note_modules() -> None:
    _own_modules[:] = filter(_is_own, sys.modules)
    _count_of_modules[:] = [len(sys.modules)]


def _is_own(module: str) -> bool:
    return module.partition(".")[0] in ("grader", "groundwork", "rmw_lockstep")


def _modules_of_this_fork() -> list[str]:
    """Return the names of the modules that were imported after the fork: the last ones in `sys.modules`."""
    return list(itertools.islice(reversed(sys.modules), len(sys.modules) - _count_of_modules[0]))


# The modules whose code is still running below the student's. Without a reference they would be torn down.
_ours: list[types.ModuleType] = []


# python -m grader.sandbox.zygote DESCRIPTOR OWNER MODULE…: OWNER is empty, or the module of `_fork_for`


#: In bytes. The longest is the name of a module.
_LONGEST_MESSAGE = 1024
_MOST_DESCRIPTORS = 8


def main() -> None:
    """Serve until the last user of the socket is gone. Return only as a student whose program has ended."""
    _put_ours_first()
    descriptor, owner, modules = int(sys.argv[1]), sys.argv[2], sys.argv[3:]
    path = sys.path.copy()
    sys.path[:] = own_path(sys.path)  # a .pth file may have added another installation's modules
    os.chdir("/")
    soft, hard = resource.getrlimit(resource.RLIMIT_NOFILE)
    if 0 <= soft < OPEN_FILES <= hard:
        resource.setrlimit(resource.RLIMIT_NOFILE, (OPEN_FILES, hard))
    gc.disable()  # until it forks: it would look through all that is imported, a tenth of the time
    fault = _load(modules)
    if owner:
        descriptor = _fork_for(owner, descriptor, modules, path)
    path.clear()  # a student's program can see it
    _prepare_for_forks()
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    signal.signal(signal.SIGCHLD, signal.SIG_IGN)  # supervisors need no reaping
    job = serve(descriptor, fault)
    if job is not None:
        run_program(job.program, job.paths)


def _put_ours_first() -> None:
    """Start again if PyPI's wheels, which start Python again themselves, have put their libraries before ours."""
    preload = Path(os.environ.get("LD_PRELOAD", ""))
    folders = os.environ.get("LD_LIBRARY_PATH", "").split(os.pathsep)
    found = (folder for folder in folders if Path(folder, preload.name).is_file())
    own = str(preload.parent) if preload.is_absolute() else next(found, "")
    ordered = sorted(folders, key=lambda folder: not folder.startswith(own))
    if ordered != folders:
        os.environ["LD_LIBRARY_PATH"] = os.pathsep.join(ordered)
        os.execv(sys.executable, sys.orig_argv)


def _fork_for(owner: str, descriptor: int, modules: list[str], path: list[str]) -> int:
    """Fork, and return in the child, with the descriptor of its requests, as the fork server of this process.

    This process becomes the owner, by `main` of the module with that name. It has read nothing yet from `descriptor`,
    so the fork server knows nothing that no student may see; and both import rclpy only once. `path` is where the owner
    finds modules.
    """
    ours, theirs = socket.socketpair(socket.AF_UNIX, socket.SOCK_SEQPACKET)
    if (pid := _fork()) == 0:
        os.setsid()
        syscalls.prctl(syscalls.PR_SET_NAME, b"fork server")
        os.close(descriptor)
        ours.close()
        return theirs.detach()
    theirs.close()
    sys.path[:] = path
    importlib.import_module(owner).main(descriptor, ForkServer(modules, (ours, pid)))
    sys.exit()


def _prepare_for_forks() -> None:
    """Do once what every fork would otherwise have to do."""
    filesystem.system()
    filesystem.interpreter()
    if seccomp.supported():
        seccomp.program()
    callers.remember_files()
    preloaded.choose()
    preloaded.hide()
    sys.path_importer_cache.clear()  # otherwise each fork would copy it to clear it
    _note_modules()
    gc.collect()
    gc.freeze()
    gc.enable()
    heap.fill_gaps()


def serve(requests: int, fault: str | None) -> StudentToRun | None:
    """Fork a supervisor for each request for one, and import the modules that others name.

    Return what to run in each student, and None at the end of all requests.

    With a `fault` nothing is started: it is the answer to each request.
    """
    listening = socket.socket(fileno=requests)
    while True:
        message, passed, _, _ = socket.recv_fds(listening, _LONGEST_MESSAGE, _MOST_DESCRIPTORS)
        if not message:
            return None
        if message != START_REQUEST:
            preloaded.show_all()
            with contextlib.suppress(Exception):  # a program that imports it gets the error
                _import(message.decode())
            _prepare_for_forks()
            continue
        if _fork() == 0:
            listening.detach()
            os.close(requests)
            for number in passed:  # no program may inherit the received descriptors
                os.set_inheritable(number, False)
            with os.fdopen(passed[0], "rb") as stream:
                start = pickle.load(stream)
            descriptors = PassedDescriptors.of(start, passed[1:])
            if fault:
                refuse(descriptors.control, fault)
            return supervise(start, descriptors)
        for number in passed:
            os.close(number)


def _fork() -> int:
    """Fork as the C library does, without Python's own preparation of threads, locks and random numbers.

    The fork server and its supervisors use none of these. A student is forked as Python does, which prepares them.
    """
    return syscalls.libc_call("fork", of=_with_python)


# Hold the GIL across the call: the child continues in Python.
_with_python = ctypes.PyDLL(None, use_errno=True)


#: Each package of messages imports one function of rosidl_generator_py. Unless this module is missing, that loads the
#: generator and lark's parser, too: 50 ms, and 7 MB that each fork would share.
_GENERATOR = "rosidl_generator_py.generate_py_impl"


def _load(modules: list[str]) -> str | None:
    """Import modules. Return a message if rclpy has loaded another middleware than the grader's."""
    middleware = os.environ.pop("RMW_IMPLEMENTATION", None)
    if middleware and choosable():
        os.environ["RMW_IMPLEMENTATION"] = middleware
    sys.modules[_GENERATOR] = None  # type: ignore[assignment]
    for name in modules:
        _import(name)
    del sys.modules[_GENERATOR]
    if middleware:
        os.environ["RMW_IMPLEMENTATION"] = middleware
    if "rclpy" not in sys.modules:
        return None
    loaded = sys.modules["rclpy"].get_rmw_implementation_identifier()
    if loaded == IDENTIFIER:
        return None
    return f"rclpy has loaded the middleware {loaded}, not {IDENTIFIER}. Run spinbook doctor to see what is installed"


def _import(name: str) -> None:
    """Import a module and, if it is one of message, service or action types, load their compiled support."""
    with preloaded.noted(), contextlib.suppress(ImportError):
        if preloaded.is_of_interfaces(name):
            load_type_support(name)
        else:
            importlib.import_module(name)


if __name__ == "__main__":
    main()
