"""The environment variables of the grader's processes and of students' programs: what is listed here, nothing else."""

from __future__ import annotations

import os
import sys

from grader.sandbox.program import HUB, Paths, ProgramSpec
from groundwork.clean_environment import GUARD, without_foreign

#: What Python and ROS 2 themselves need. Nothing else from this process's environment reaches a sandbox.
RUNTIME_VARIABLES = (
    *("PATH", "LANG", "LD_LIBRARY_PATH", GUARD, "PYTHONPATH", "PYTHONHASHSEED", "PYTHONDONTWRITEBYTECODE"),
    *("PYTHONNOUSERSITE", "OPENBLAS_NUM_THREADS", "MALLOC_ARENA_MAX", "AMENT_PREFIX_PATH", "RMW_IMPLEMENTATION"),
    *("ROS_DISTRO", "ROS_VERSION", "ROS_PYTHON_VERSION", "CONDA_PREFIX"),
)

#: What the grader's own processes get besides: where files are, and how texts are written.
WORKER_VARIABLES = (
    *("HOME", "USER", "LOGNAME", "TMPDIR", "TZ", "LC_ALL", "LC_CTYPE", "PYTHONPYCACHEPREFIX"),
    *("XDG_CACHE_HOME", "SPINBOOK_CACHE", "CXX", "COMPILED_INTERFACES"),
)


def for_trusted(names: tuple[str, ...] = (*RUNTIME_VARIABLES, *WORKER_VARIABLES)) -> dict[str, str]:
    """Return this process's variables of these names, without another installation's modules and libraries."""
    clean = without_foreign(dict(os.environ), workspaces=False)
    return {name: clean[name] for name in names if name in clean}


def for_program(program: ProgramSpec, paths: Paths) -> dict[str, str]:
    """Return a program's whole environment: the variables of Python, of ROS 2 and of its folders, and its own."""
    needed = {name: os.environ[name] for name in (*RUNTIME_VARIABLES, "LD_PRELOAD") if name in os.environ}
    hub = {"RMW_LOCKSTEP_SOCKET": f"fd:{HUB}"} if program.hub is not None else {}
    return {
        **needed,
        **hub,
        "PATH": f"{sys.prefix}/bin:/usr/local/bin:/usr/bin:/bin",
        "HOME": paths.home,
        "TMPDIR": paths.temporary,
        "PYTHONUNBUFFERED": "1",
        "ROS_LOG_DIR": f"{paths.home}/log",
        "USER": "student",
        "LOGNAME": "student",
        **program.environment,
    }
