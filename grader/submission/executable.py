"""Finds the executable of an installed ROS 2 package, as `ros2 run` does."""

from __future__ import annotations

import hashlib
import os
from dataclasses import dataclass
from pathlib import Path


@dataclass(frozen=True)
class Executable:
    """An installed Python executable: its script, the folders it needs to see, and where its modules are."""

    script: Path
    folders: tuple[Path, ...]
    python_path: str

    def digest(self) -> str:
        """SHA-256 of the script and of every Python file beside its modules."""
        total = hashlib.sha256(self.script.read_bytes())
        for folder in self.python_path.split(os.pathsep):
            for file in sorted(Path(folder).rglob("*.py")):
                total.update(file.read_bytes())
        return total.hexdigest()


def find(given: str) -> Executable | str:
    """The executable that `package/executable` names, or a sentence that says why there is none."""
    package, _, name = given.partition("/")
    prefixes = [Path(prefix) for prefix in os.environ.get("AMENT_PREFIX_PATH", "").split(os.pathsep) if prefix]
    for prefix in prefixes:
        script = prefix / "lib" / package / name
        if script.is_file():
            return _described(prefix, script)
    looked = ", ".join(map(str, prefixes)) or "nowhere: AMENT_PREFIX_PATH is not set"
    return (
        f"{given}: there is no such file, and no installed package {package} with the executable {name} (looked in "
        f"{looked}). Build the package with colcon and source install/setup.sh first."
    )


def _described(prefix: Path, script: Path) -> Executable:
    modules = [folder for folder in prefix.glob("lib/python3*/site-packages") if folder.is_dir()]
    folders = [prefix]
    for folder in list(modules):
        for link in folder.glob("*.egg-link"):
            # Where `colcon build --symlink-install` left the modules in the build and source folders.
            target = Path(link.read_text(encoding="utf-8").splitlines()[0])
            modules.append(target)
            folders += [target, *(entry.resolve().parent for entry in target.iterdir() if entry.is_symlink())]
    return Executable(script, tuple(folders), os.pathsep.join(map(str, modules)))
