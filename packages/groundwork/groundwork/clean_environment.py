"""Keeps another installation's modules and libraries away from this one's programs.

A terminal may name the modules of a cluster, of an old ROS 2 or of another project in `PYTHONPATH` and
`LD_LIBRARY_PATH`, and they would come before those that are installed here. This module runs before anything else is
imported, so it imports only what Python itself has loaded by then.
"""

from __future__ import annotations

import os
import sys

#: What is allowed of the variables that Python itself reads. Others change what a program does: `PYTHONOPTIMIZE`, for
#: example, removes every assert.
OF_PYTHON = (
    *("PYTHONPATH", "PYTHONHASHSEED", "PYTHONDONTWRITEBYTECODE", "PYTHONPYCACHEPREFIX", "PYTHONNOUSERSITE"),
    *("PYTHONUNBUFFERED", "PYTHONIOENCODING", "PYTHONUTF8", "PYTHON_COLORS"),
)

#: Set by PyPI's ROS wheels once they have extended `LD_LIBRARY_PATH`. Where it is set, they leave that as it is.
GUARD = "_ROS_WHEELS_BOOTSTRAP_COMPLETE"

#: In a command that was started again: its process's number, and a dict of the variables that it does not use, as text.
IGNORED = "SPINBOOK_IGNORED"

#: A folder with one of these on `PYTHONPATH` is where this software is.
_OWN_PACKAGES = (
    "groundwork",
    "grader",
    "spinbook",
    "rmw_lockstep",
    "interface_compiler",
    "ros_in_python",
    "rcl_python",
)


#: Where tf2 and others that PyPI lacks are: in a checkout, outside of this Python's folders.
_IMPORTABLE = os.path.join("ros_in_python", "importable")


def without_foreign(environment: dict[str, str], workspaces: bool = True) -> dict[str, str]:
    """Return `environment` without what would change which modules and libraries this Python's programs load.

    Search paths keep this installation's folders, those of compiled interfaces, and those of the ROS 2 in use: PyPI's
    wheels if they are installed here, otherwise the sourced one. A sourced workspace on top of it stays, but without
    `workspaces` not one on top of the wheels, which need none.
    """
    kept = {name: value for name, value in environment.items() if not _is_of_loaders(name)}
    has_own_ros = any(os.path.isdir(os.path.join(folder, "rclpy")) for folder in _site_folders())
    prefixes = _ros_prefixes(environment, has_own_ros, workspaces)
    own = [*_own_roots(), *_entries(environment, "COMPILED_INTERFACES")]
    roots = own + [os.path.join(prefix, part) for prefix in prefixes for part in ("lib", "local", "opt")]
    _put(kept, "PYTHONPATH", _modules(environment, roots, has_own_ros))
    _put(kept, "LD_LIBRARY_PATH", _libraries(_entries(environment, "LD_LIBRARY_PATH"), roots))
    _put(kept, "AMENT_PREFIX_PATH", prefixes)
    for_cmake = _entries(environment, "CMAKE_PREFIX_PATH")
    _put(kept, "CMAKE_PREFIX_PATH", [entry for entry in for_cmake if _is_inside(entry, [*own, *prefixes])])
    if _of_wheels() not in _entries(kept, "LD_LIBRARY_PATH"):
        kept.pop(GUARD, None)  # another installation's wheels have set it
    if _uses_foreign_user_site():
        kept["PYTHONNOUSERSITE"] = "1"
    return kept


def restart_if_polluted(module: str) -> None:
    """Start this command, the `main()` of `module`, again without another installation's variables, if there are any.

    The new process has the former values in the variable `IGNORED`.
    """
    for number in range(3):
        try:
            os.fstat(number)
        except OSError:  # the caller closed it, and the next file to be opened would get its number
            os.set_inheritable(os.open(os.devnull, os.O_RDWR), True)
    if sys.path and not _is_inside(sys.path[0], _own_roots()) and not _holds(sys.path[0] or ".", _OWN_PACKAGES):
        del sys.path[0]  # `python -m` adds the current folder, which may be a student's
    environment = dict(os.environ)
    cleaned = without_foreign(environment)
    removed = {name: text for name, text in environment.items() if cleaned.get(name) != text}
    # A process keeps its number when it starts again, which it does once.
    if cleaned == environment or environment.get(IGNORED, "").startswith(f"({os.getpid()}, "):
        return
    note = repr((os.getpid(), removed))
    os.execve(sys.executable, module_command(module, *sys.argv[1:]), {**cleaned, IGNORED: note})


def ignored() -> dict[str, str]:
    """Return the variables that this command, or the one that started it, does not use, with their values."""
    import ast

    return dict(ast.literal_eval(os.environ.get(IGNORED, "(0, {})"))[1])


#: `python -c` adds the current folder to the path as an empty text.
_DROP_FOLDER = "import sys; sys.path[:] = filter(None, sys.path)"


def module_command(module: str, *words: str, flags: tuple[str, ...] = ()) -> list[str]:
    """Return the command that runs a module's `main()`, without the current folder on its path.

    `python -m` would find modules in that folder first, such as a student's `queue.py`.
    """
    return [sys.executable, *flags, "-c", f"{_DROP_FOLDER}; from {module} import main; sys.exit(main())", *words]


def own_path(path: list[str]) -> list[str]:
    """Return the entries of a module search path that are this installation's, or that `PYTHONPATH` names."""
    named = _entries(dict(os.environ), "PYTHONPATH")
    roots = [*_own_roots(), *named]
    return [
        entry
        for entry in path
        if _is_inside(entry, roots) or _holds(entry, _OWN_PACKAGES) or entry.endswith(_IMPORTABLE)
    ]


def _is_of_loaders(name: str) -> bool:
    """Return whether a variable changes how Python or the dynamic linker works, and is not one that is allowed."""
    return name.startswith(("PYTHON", "LD_")) and name not in (*OF_PYTHON, "LD_LIBRARY_PATH")


def _ros_prefixes(environment: dict[str, str], has_own_ros: bool, workspaces: bool) -> list[str]:
    """Return what may be on `AMENT_PREFIX_PATH`: nothing of another ROS 2 than PyPI's wheels, if these are here."""
    entries = _entries(environment, "AMENT_PREFIX_PATH")
    own = [*_own_roots(), *_entries(environment, "COMPILED_INTERFACES")]
    foreign = [entry for entry in entries if not _is_inside(entry, own)]
    is_on_another = any(os.path.isdir(os.path.join(entry, "share", "rcl_interfaces")) for entry in foreign)
    if has_own_ros and (is_on_another or not workspaces):
        return [entry for entry in entries if entry not in foreign]
    return entries


def _modules(environment: dict[str, str], roots: list[str], has_own_ros: bool) -> list[str]:
    """Return what may be on `PYTHONPATH`; without PyPI's wheels also where rclpy is."""
    packages = _OWN_PACKAGES if has_own_ros else (*_OWN_PACKAGES, "rclpy")
    entries = _entries(environment, "PYTHONPATH")
    return [entry for entry in entries if _is_inside(entry, roots) or _holds(entry, packages)]


def _libraries(entries: list[str], roots: list[str]) -> list[str]:
    own = [entry for entry in entries if entry == _of_wheels() or _is_inside(entry, roots)]
    foreign = [entry for entry in entries if entry not in own]
    # A cluster's Python may need libraries in folders that only this variable names.
    return [*own, *foreign] if foreign and not _starts_with(own) else own


def _of_wheels() -> str:
    """Return the folder that PyPI's ROS wheels add to `LD_LIBRARY_PATH` whatever this Python's prefix is."""
    return os.path.join(sys.prefix, "lib")


_starts: dict[str, bool] = {}


def _starts_with(libraries: list[str]) -> bool:
    """Return whether this Python starts with only these folders of libraries."""
    path = os.pathsep.join(libraries)
    if path not in _starts:
        code = os.spawnve(
            os.P_WAIT,
            sys.executable,
            [sys.executable, "-I", "-S", "-c", "import os; os.close(2); import _ctypes, zlib"],
            {"LD_LIBRARY_PATH": path, GUARD: "1"},
        )
        _starts[path] = code == 0
    return _starts[path]


def _own_roots() -> list[str]:
    """Return the folders of this Python, of the Python that its environment was made from, and of this software."""
    prefixes = {sys.prefix, sys.exec_prefix, sys.base_prefix, sys.base_exec_prefix}
    # A system's Python is in /usr, as are many other things.
    own = [prefix for prefix in sorted(prefixes) if prefix not in ("/usr", "/usr/local", "/")]
    return [*own, *_site_folders(), os.path.dirname(os.__file__)]


def _site_folders() -> list[str]:
    version = f"python{sys.version_info.major}.{sys.version_info.minor}"
    return [
        os.path.join(sys.prefix, "lib", version, "site-packages"),
        *(os.path.join(prefix, "lib", "python3", "dist-packages") for prefix in ("/usr", sys.prefix)),
        os.path.join("/usr/local/lib", version, "dist-packages"),
        os.path.dirname(os.path.dirname(os.path.abspath(__file__))),
    ]


def _uses_foreign_user_site() -> bool:
    """Return whether Python looks into the user's own folder of packages, and this software is not there."""
    site = sys.modules.get("site")
    folder = str(getattr(site, "USER_SITE", None) or "")
    enabled = bool(getattr(site, "ENABLE_USER_SITE", False)) and os.path.isdir(folder)
    return enabled and not _is_inside(os.path.abspath(__file__), [folder])


def _is_inside(path: str, folders: list[str]) -> bool:
    """Return whether a path is one of these folders or below one, as it is written or without its symbolic links."""
    paths = {os.path.abspath(path), os.path.realpath(path)}
    return any(
        one == folder or one.startswith(folder.rstrip("/") + "/")
        for one in paths
        for name in folders
        for folder in (os.path.abspath(name), os.path.realpath(name))
    )


def _holds(folder: str, packages: tuple[str, ...]) -> bool:
    return any(os.path.isfile(os.path.join(folder, package, "__init__.py")) for package in packages)


def _entries(environment: dict[str, str], name: str) -> list[str]:
    return [entry for entry in environment.get(name, "").split(os.pathsep) if entry]


def _put(environment: dict[str, str], name: str, entries: list[str]) -> None:
    environment.pop(name, None)
    if entries:
        environment[name] = os.pathsep.join(entries)
