"""Programs find this installation's modules and libraries, whatever a terminal's variables name."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import pytest

from groundwork import clean_environment
from groundwork.clean_environment import GUARD, module_command, own_path, without_foreign

WHEELS = Path(sys.prefix, "lib", f"python{sys.version_info.major}.{sys.version_info.minor}", "site-packages", "rclpy")


@pytest.mark.parametrize(
    "name",
    [
        *("PYTHONHOME", "PYTHONSTARTUP", "PYTHONOPTIMIZE", "PYTHONWARNINGS", "PYTHONINSPECT", "PYTHONSAFEPATH"),
        *("LD_PRELOAD", "LD_AUDIT", "LD_DEBUG", "CMAKE_PREFIX_PATH"),
    ],
)
def test_what_changes_how_programs_start_is_left_out(name: str) -> None:
    assert without_foreign({name: "1", "HOME": "/home/ana"}) == {"HOME": "/home/ana"}


def test_foreign_folders_leave_the_search_paths_and_own_ones_stay(tmp_path: Path) -> None:
    compiled, cluster = tmp_path / "compiled", tmp_path / "cluster"
    for folder in (compiled / "lib", cluster / "numpy"):
        folder.mkdir(parents=True)
    environment = {
        "COMPILED_INTERFACES": str(compiled),
        "PYTHONPATH": f"{cluster}:{compiled / 'lib'}::/nowhere",
        "LD_LIBRARY_PATH": f"{cluster}:{sys.prefix}/lib:{compiled / 'lib'}",
        GUARD: "1",
    }

    clean = without_foreign(environment)

    assert clean["PYTHONPATH"] == str(compiled / "lib")
    assert clean["LD_LIBRARY_PATH"] == f"{sys.prefix}/lib:{compiled / 'lib'}"
    assert clean[GUARD] == "1"
    assert without_foreign(clean) == clean


@pytest.mark.skipif(not WHEELS.exists(), reason="ROS 2 is a sourced one here")
def test_beside_the_wheels_another_ros_is_left_out_with_the_workspaces_on_top_of_it(tmp_path: Path) -> None:
    ros, workspace = tmp_path / "humble", tmp_path / "ws" / "install" / "arm"
    modules = workspace / "lib" / "python3.10" / "site-packages"
    for folder in (ros / "share" / "rcl_interfaces", modules):
        folder.mkdir(parents=True)
    alone = {"AMENT_PREFIX_PATH": str(workspace), "PYTHONPATH": str(modules)}

    assert without_foreign(alone) == alone
    assert without_foreign({**alone, "AMENT_PREFIX_PATH": f"{workspace}:{ros}"}) == {}


def test_a_folder_behind_a_symbolic_link_is_an_own_one(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (tmp_path / "elsewhere").mkdir()
    (tmp_path / "lib").symlink_to(tmp_path / "elsewhere")
    monkeypatch.setattr(sys, "prefix", str(tmp_path))
    environment = {"LD_LIBRARY_PATH": str(tmp_path / "lib"), GUARD: "1"}
    assert without_foreign(environment) == environment


def test_a_command_starts_again_only_once_whatever_it_finds_then(tmp_path: Path) -> None:
    (tmp_path / "loop.py").write_text(
        "import os\nfrom groundwork.clean_environment import ignored, restart_if_polluted\n"
        "def main():\n    os.environ['LD_PRELOAD'] = ''\n    restart_if_polluted('loop')\n"
        "    print(sorted(ignored()))\n"
    )
    environment = {**os.environ, "PYTHONPATH": f"{tmp_path}:{tmp_path / 'foreign'}", "PYTHONOPTIMIZE": "1"}
    (tmp_path / "groundwork").mkdir()
    (tmp_path / "groundwork" / "__init__.py").write_text(
        f"__path__ = [{str(Path(__file__).parents[1] / 'groundwork')!r}]\n"
    )

    done = subprocess.run(module_command("loop"), env=environment, capture_output=True, text=True, timeout=60)

    assert done.stdout == "['LD_PRELOAD', 'PYTHONOPTIMIZE', 'PYTHONPATH']\n", done.stderr


def test_a_sourced_ros_stays_as_it_is_where_there_are_no_wheels(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    ros, version = tmp_path / "jazzy", f"python{sys.version_info.major}.{sys.version_info.minor}"
    for folder in ("share/rcl_interfaces", f"lib/{version}/site-packages/rclpy", "opt/vendor/lib"):
        (ros / folder).mkdir(parents=True)
    monkeypatch.setattr(clean_environment, "_site_folders", lambda: [str(tmp_path / "venv" / "site-packages")])
    environment = {
        "AMENT_PREFIX_PATH": str(ros),
        "CMAKE_PREFIX_PATH": str(ros),
        "PYTHONPATH": str(ros / "lib" / version / "site-packages"),
        "LD_LIBRARY_PATH": f"{ros}/opt/vendor/lib:{ros}/lib",
        "ROS_DISTRO": "jazzy",
    }
    assert without_foreign(environment) == environment
    assert without_foreign(environment, workspaces=False) == environment


@pytest.mark.parametrize("prefix", ["/usr", "/usr/local"])
def test_a_systems_python_keeps_what_its_wheels_have_set(prefix: str, monkeypatch: pytest.MonkeyPatch) -> None:
    # Without the guard, the next Python would put the folders, and a middleware before them, in an order of its own.
    for name in ("prefix", "exec_prefix", "base_prefix", "base_exec_prefix"):
        monkeypatch.setattr(sys, name, prefix)
    packages = f"{prefix}/lib/python{sys.version_info.major}.{sys.version_info.minor}/site-packages"
    set_by_wheels = {"LD_LIBRARY_PATH": f"{packages}/ros_rclpy.libs:{prefix}/lib", GUARD: "1"}

    assert without_foreign({**set_by_wheels, "LD_PRELOAD": "/nowhere/lib.so"}) == set_by_wheels


def test_the_guard_of_another_installations_wheels_is_left_out() -> None:
    assert GUARD not in without_foreign({GUARD: "1", "LD_LIBRARY_PATH": "/another/lib"})


def test_a_module_runs_without_the_current_folders_files(tmp_path: Path) -> None:
    (tmp_path / "json.py").write_text("raise SystemExit('the wrong one')")
    (tmp_path / "tool").mkdir()
    (tmp_path / "tool" / "show.py").write_text("import json, sys\ndef main(): print(sys.argv[1:])\n")
    environment = {**os.environ, "PYTHONPATH": str(tmp_path / "tool")}

    done = subprocess.run(
        module_command("show", "a", "b"), cwd=tmp_path, env=environment, capture_output=True, text=True
    )

    assert (done.stdout, done.stderr) == ("['a', 'b']\n", "")


def test_a_path_that_a_pth_file_adds_is_not_an_own_one(tmp_path: Path) -> None:
    assert own_path([str(tmp_path), *sys.path]) == own_path(sys.path)
    assert os.path.dirname(os.__file__) in own_path(sys.path)  # noqa: PTH120


def test_a_standard_stream_that_is_closed_is_not_taken_by_another_file_here_or_in_child_processes() -> None:
    code = (
        "import os, sys; os.close(2); sys.path.insert(0, sys.argv[1])\n"
        "from groundwork.clean_environment import restart_if_polluted; restart_if_polluted('nothing')\n"
        "print(os.readlink('/proc/self/fd/2'), os.get_inheritable(2))"
    )
    command = [sys.executable, "-S", "-c", code, str(Path(clean_environment.__file__).parents[1])]
    done = subprocess.run(command, env={}, stdout=subprocess.PIPE, text=True, check=True)
    assert done.stdout == "/dev/null True\n"
