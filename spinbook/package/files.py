"""The files of a course's packages, as text: nodes in an ament_python one, interfaces in an ament_cmake one."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

from interface_compiler.checks import dependencies
from interface_compiler.definition import Definition
from ros_in_python.ros2 import ament_python
from ros_in_python.ros2.ament_python import Manifest, package_xml
from spinbook.chapter.imports import ros_packages
from spinbook.chapter.python_code import facts_of
from spinbook.course.course import Package


@dataclass(frozen=True)
class Module:
    """A node's file: `name` without .py, and its code, byte for byte.

    `executables` are its names for `ros2 run`; if there are none, it is that of its file.
    """

    name: str
    code: str
    executables: tuple[str, ...] = ()

    @property
    def has_main(self) -> bool:
        """Whether it has a `main`, which `ros2 run` calls."""
        return facts_of(self.code).has_main


def package_files(
    package: Package, modules: Sequence[Module], interfaces: Sequence[str] = (), extra: Mapping[str, str] | None = None
) -> dict[str, str]:
    """Return path in the package -> content. `interfaces` are the course's own packages of interfaces.

    `extra` are launch and parameter files (path -> content): setup.py installs their folders.
    """
    extra = extra or {}
    folders = sorted({path.partition("/")[0] for path in extra})
    needs = [*_dependencies(modules, interfaces), *(["ros2launch"] if "launch" in folders else [])]
    files = ament_python.package_files(_manifest(package, needs), _executables(modules), folders)
    files.update({f"{package.name}/{module.name}.py": module.code for module in modules})
    return {**files, **extra}


def _manifest(package: Package, needs: Sequence[str]) -> Manifest:
    return Manifest(
        package.name,
        package.version,
        package.description,
        package.maintainer,
        package.email,
        package.license,
        exec_depends=needs,
    )


def _executables(modules: Sequence[Module]) -> list[tuple[str, str]]:
    """Return (executable, module) for everything that `ros2 run` can start."""
    return [(name, m.name) for m in modules if m.has_main for name in m.executables or (m.name,)]


def _dependencies(modules: Sequence[Module], interfaces: Sequence[str]) -> list[str]:
    """Return the ROS packages that the modules import."""
    imported = {name.partition(".")[0] for module in modules for name in facts_of(module.code).imports}
    return sorted(imported & (ros_packages() | {"rclpy", *interfaces}))


# Layout as in ROS 2's documentation, "Creating custom msg and srv files" and "Creating an action".


def interface_package_files(course: Package, definitions: Sequence[Definition]) -> dict[str, str]:
    """Return path in the package -> content, for the definitions of one package.

    Maintainer, version and licence are those of the course's package of nodes.
    """
    name = definitions[0].package
    # ROS itself adds what services and actions need, except action_msgs.
    needed = sorted(dependencies(definitions)[name] - {"service_msgs", "unique_identifier_msgs", "action_msgs"})
    if any(item.kind == "action" for item in definitions):
        needed.append("action_msgs")
    files = {item.path: item.text for item in definitions}
    return {
        **files,
        "CMakeLists.txt": _cmake(name, sorted(files), needed),
        "package.xml": _interface_package_xml(course, name, needed),
    }


def _interface_package_xml(course: Package, name: str, needed: Sequence[str]) -> str:
    description = f"Messages, services and actions of {course.name}"
    manifest = replace(
        _manifest(course, ["rosidl_default_runtime"]), name=name, description=description, depends=needed
    )
    buildtools = ("ament_cmake", "rosidl_default_generators")
    return package_xml(manifest, "ament_cmake", buildtools=buildtools, groups=["rosidl_interface_packages"])


def _cmake(name: str, paths: Sequence[str], needed: Sequence[str]) -> str:
    find = "".join(f"find_package({package} REQUIRED)\n" for package in needed)
    interfaces = "".join(f'  "{path}"\n' for path in paths)
    depends = f"  DEPENDENCIES {' '.join(needed)}\n" if needed else ""
    return (
        "cmake_minimum_required(VERSION 3.8)\n"
        f"project({name})\n\n"
        "find_package(ament_cmake REQUIRED)\n"
        "find_package(rosidl_default_generators REQUIRED)\n"
        f"{find}\n"
        "rosidl_generate_interfaces(${PROJECT_NAME}\n"
        f"{interfaces}{depends})\n\n"
        "ament_export_dependencies(rosidl_default_runtime)\n"
        "ament_package()\n"
    )
