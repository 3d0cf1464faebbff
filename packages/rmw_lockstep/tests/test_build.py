"""The middleware is compiled once for a ROS 2, found again at once, and its absence is reported with what to do."""

from __future__ import annotations

import json
import os
import platform
import re
import shutil
import subprocess
import sys
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import pytest

import rmw_lockstep
from rmw_lockstep import library as finding
from rmw_lockstep.build import build
from rmw_lockstep.library import DESCRIPTION, PREBUILT, Library, UnavailableLibrary, library
from rmw_lockstep.ros import installed_ros

PACKAGE = Path(rmw_lockstep.__file__).parent

needs_compiler = pytest.mark.skipif(shutil.which("g++") is None, reason="g++ is not installed")

#: Does nothing, but is loaded and linked like the real one: tested is what is compiled when, and where it goes.
LOCKSTEP = 'extern "C" __attribute__((visibility("default"))) int lockstep_connect(const char *) { return 0; }\n'
RMW = (
    '#include <rmw/rmw.h>\nextern "C" int lockstep_connect(const char *);\nint use() { return lockstep_connect(0); }\n'
)


SOURCED = (found := installed_ros()) is not None and found.chooses_at_run_time


class Copy:
    """A copy of the package with small C++ sources, and the Python that compiles them, with folders of its own."""

    def __init__(self, folder: Path) -> None:
        self.package, self.cache = folder / "rmw_lockstep", folder / "cache"
        (self.package / "lockstep").mkdir(parents=True)
        (self.package / "src").mkdir()
        for file in PACKAGE.glob("*.*"):
            shutil.copy(file, self.package)
        shutil.copy(PACKAGE / "lockstep" / "older_libraries.hpp", self.package / "lockstep")
        (self.package / "lockstep" / "a.cpp").write_text(LOCKSTEP)
        (self.package / "lockstep" / "exports.map").write_text("{ global: lockstep_*; local: *; };\n")
        (self.package / "src" / "b.cpp").write_text(RMW)
        self.environment = {**os.environ, "PYTHONPATH": str(folder), "XDG_CACHE_HOME": str(self.cache)}

    def run(self, module: str, *arguments: str, **environment: str) -> subprocess.CompletedProcess[str]:
        """Run a module of the copy. Nothing is written into the real environment: it is considered read-only."""
        code = (
            "import runpy, sys; from pathlib import Path; from rmw_lockstep import library\n"
            "folder = Path(__import__('os').environ['XDG_CACHE_HOME']) / 'rmw_lockstep'\n"
            "library.library_folders = lambda: iter([folder])\n"
            f"sys.argv = {[module, *arguments]!r}; runpy.run_module({module!r}, run_name='__main__')"
        )
        return subprocess.run(
            [sys.executable, "-P" if sys.version_info >= (3, 11) else "-B", "-c", code],
            cwd=self.package.parent,
            env={**self.environment, **environment},
            capture_output=True,
            text=True,
            check=False,
        )

    def built(self) -> list[Path]:
        """Return the sets of libraries that have been compiled."""
        return [file.parent for file in sorted(self.cache.glob("rmw_lockstep/*/built.json"))]


@pytest.fixture
def copy(tmp_path: Path) -> Copy:
    return Copy(tmp_path)


@needs_compiler
def test_compiles_once_and_again_when_a_source_has_changed(copy: Copy) -> None:
    first = copy.run("rmw_lockstep.build")
    assert first.returncode == 0, first.stderr
    (folder,) = copy.built()
    assert first.stdout.strip() == str(folder)
    made = (folder / "liblockstep.so").stat().st_mtime_ns

    assert copy.run("rmw_lockstep.build").stdout == first.stdout
    assert (folder / "liblockstep.so").stat().st_mtime_ns == made

    with (copy.package / "src" / "b.cpp").open("a") as source:
        source.write("int more() { return 1; }\n")
    assert copy.run("rmw_lockstep.build").stdout != first.stdout
    assert len(copy.built()) == 2


@needs_compiler
def test_of_two_at_once_one_compiles_and_the_other_waits(copy: Copy, tmp_path: Path) -> None:
    log = tmp_path / "links"
    compiler = tmp_path / "compiler"
    compiler.write_text(f'#!/bin/sh\ncase "$*" in *soname,liblockstep*) echo >>{log};; esac\nexec g++ "$@"\n')
    compiler.chmod(0o755)

    with ThreadPoolExecutor() as pool:
        results = list(pool.map(lambda _: copy.run("rmw_lockstep.build", CXX=str(compiler)), range(2)))

    assert [result.returncode for result in results] == [0, 0]
    assert results[0].stdout == results[1].stdout
    assert log.read_text() == "\n", "it was linked once"


@needs_compiler
def test_the_library_for_the_wheels_has_the_name_that_they_are_linked_to(copy: Copy) -> None:
    copy.run("rmw_lockstep.build")
    (folder,) = copy.built()

    names = {path: _dynamic(folder / path) for path in ("librmw_lockstep_cpp.so", "wheels/librmw_fastrtps_cpp.so")}

    assert "SONAME" in names["librmw_lockstep_cpp.so"]
    assert "[librmw_lockstep_cpp.so]" in names["librmw_lockstep_cpp.so"]
    assert "[librmw_fastrtps_cpp.so]" in names["wheels/librmw_fastrtps_cpp.so"]
    assert all("[liblockstep.so]" in dependencies for dependencies in names.values())
    assert "libstdc++" not in _dynamic(folder / "liblockstep.so")


@needs_compiler
@pytest.mark.skipif(platform.machine() != "x86_64", reason="PyPI's ROS 2 is for x86_64")
def test_the_libraries_run_wherever_the_ros_2_of_pypi_does() -> None:
    found = build()
    assert isinstance(found, Library)

    for name in ("liblockstep.so", "librmw_lockstep_cpp.so", "wheels/librmw_fastrtps_cpp.so"):
        called = subprocess.run(
            ["readelf", "-V", found.folder / name], capture_output=True, text=True, check=True
        ).stdout
        assert max(int(minor) for minor in re.findall(r"\bGLIBC_2\.(\d+)", called)) <= 28, name
        assert max([0, *map(int, re.findall(r"\bGLIBCXX_3\.4\.(\d+)", called))]) <= 24, name


def _dynamic(file: Path) -> str:
    return subprocess.run(["readelf", "-d", file], capture_output=True, text=True, check=True).stdout


@needs_compiler
def test_what_does_not_compile_leaves_nothing_and_shows_the_error(copy: Copy) -> None:
    (copy.package / "src" / "b.cpp").write_text("this is not C++\n")

    said = copy.run("rmw_lockstep.build")

    assert said.returncode == 1
    assert "b.cpp:1" in said.stderr
    assert "Traceback" not in said.stderr
    assert copy.built() == []
    assert [path.name for path in (copy.cache / "rmw_lockstep").iterdir()] == [".lock"]


def test_without_a_compiler_it_says_what_to_install(copy: Copy) -> None:
    said = copy.run("rmw_lockstep.build", CXX="no-such-compiler")

    assert said.returncode == 1
    assert (
        "There is no middleware rmw_lockstep: neither a wheel of it that fits is installed, nor g++ to" in said.stderr
    )
    assert "Install one of them: the wheel rmw_lockstep_prebuilt, or sudo apt-get install g++" in said.stderr


@needs_compiler
def test_what_was_compiled_is_found_without_the_compiler_too(copy: Copy) -> None:
    folder = copy.run("rmw_lockstep.build").stdout

    assert copy.run("rmw_lockstep.build", CXX="no-such-compiler").stdout == folder


@needs_compiler
def test_a_prebuilt_package_is_used_where_it_is_installed_if_it_fits(copy: Copy, tmp_path: Path) -> None:
    copy.run("rmw_lockstep.build")
    (folder,) = copy.built()
    prebuilt = tmp_path / PREBUILT
    folder.rename(prebuilt)
    (prebuilt / "__init__.py").touch()

    assert copy.run("rmw_lockstep.build").stdout.strip() == str(prebuilt), "although there is a compiler"
    assert copy.run("rmw_lockstep.build", CXX="no-such-compiler").stdout.strip() == str(prebuilt)

    described = json.loads((prebuilt / DESCRIPTION).read_text())
    described["ros"]["rmw"] = "6.1.0"
    (prebuilt / DESCRIPTION).write_text(json.dumps(described))
    assert (
        "neither a wheel of it that fits is installed" in copy.run("rmw_lockstep.build", CXX="no-such-compiler").stderr
    )


@pytest.fixture
def no_ros(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    monkeypatch.setattr(sys, "prefix", str(tmp_path))
    monkeypatch.delenv("AMENT_PREFIX_PATH", raising=False)


@pytest.mark.usefixtures("no_ros")
def test_without_ros_it_says_so() -> None:
    assert library() == UnavailableLibrary("ROS 2's headers are not installed here", "Install ROS 2: make setup")


def test_a_sourced_ros_chooses_by_name_and_the_wheels_by_the_order_of_folders(tmp_path: Path) -> None:
    wheels = Library(tmp_path, tmp_path / "wheels")
    sourced = Library(tmp_path, tmp_path / "sourced")
    (tmp_path / "sourced/lib").mkdir(parents=True)
    (tmp_path / "sourced/lib/librmw_implementation.so").touch()

    assert wheels.environment({"LD_LIBRARY_PATH": "/a"})["LD_LIBRARY_PATH"] == f"{tmp_path}/wheels:/a"
    assert sourced.environment({"LD_LIBRARY_PATH": "/a"})["LD_LIBRARY_PATH"] == f"{tmp_path}:/a"
    assert sourced.environment({})["RMW_IMPLEMENTATION"] == "rmw_lockstep_cpp"
    assert wheels.environment({})["LD_PRELOAD"] == f"{tmp_path}/liblockstep.so"


@needs_compiler
def test_rclpy_loads_the_real_one_and_nothing_of_fast_dds() -> None:
    found = build()
    assert isinstance(found, Library)
    code = (
        "import rclpy; from pathlib import Path; rclpy.init(); rclpy.create_node('node')\n"
        "print(rclpy.get_rmw_implementation_identifier()); print(Path('/proc/self/maps').read_text())"
    )
    environment = {**os.environ, **found.environment(os.environ), "LD_BIND_NOW": "1"}  # every function is looked up

    said = subprocess.run([sys.executable, "-c", code], env=environment, capture_output=True, text=True, check=False)

    name, _, loaded = said.stdout.partition("\n")
    assert name == "rmw_lockstep_cpp", said.stderr
    assert "librcl.so" in loaded
    # Their names, not their folders: other libraries stand beside them, and which copy is loaded changes per Python.
    assert not re.search(
        r"/(libfastrtps\.so|librmw_fastrtps_shared|librmw_dds_common|libtinyxml2-)[^/]*$", loaded, re.M
    )
    assert finding.library() == found


def test_without_fast_dds_it_is_not_compiled_but_its_wheel_asked_for(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (tmp_path / "include/rmw/rmw").mkdir(parents=True)
    (tmp_path / "include/rmw/rmw/rmw.h").touch()
    monkeypatch.setattr(sys, "prefix", str(tmp_path))
    monkeypatch.setattr(finding, "library_folders", lambda: iter([tmp_path]))
    monkeypatch.delenv("AMENT_PREFIX_PATH", raising=False)
    missing = build()
    assert isinstance(missing, UnavailableLibrary)
    assert PREBUILT in missing.remedy
    assert "Fast DDS" in missing.reason
