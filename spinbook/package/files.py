"""What an ament_python package consists of, made from its modules. Pure: text in, text out.

Layout as in ROS 2's documentation of ament_python: package.xml (REP 149, format 3), setup.py with the executables
as console_scripts, setup.cfg that puts them into lib/PACKAGE, and an empty marker for the ament index.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from xml.sax.saxutils import escape, quoteattr

from spinbook.chapter.imports import ros_packages
from spinbook.chapter.python_code import CodeError, inspect
from spinbook.course.course import Package


@dataclass(frozen=True)
class Module:
    """A node's file: `name` without .py, and its code, byte for byte.

    `executables` are what `ros2 run` calls it; none: the same as its file.
    """

    name: str
    code: str
    executables: tuple[str, ...] = ()

    @property
    def has_main(self) -> bool:
        """Whether it can be an executable: `ros2 run` calls its `main`."""
        try:
            return inspect(self.code).has_main
        except CodeError:
            return False


def package_files(
    package: Package, modules: Sequence[Module], interfaces: Sequence[str] = (), extra: Mapping[str, str] | None = None
) -> dict[str, str]:
    """Path within the package's folder -> content. `interfaces` are the course's own packages of interfaces.

    `extra` are launch and parameter files (path -> content): setup.py installs their folders.
    """
    extra = extra or {}
    folders = sorted({path.partition("/")[0] for path in extra})
    files = {
        "package.xml": _package_xml(
            package, [*_dependencies(modules, interfaces), *(["ros2launch"] if "launch" in folders else [])]
        ),
        "setup.py": _setup_py(package, _executables(modules), folders),
        "setup.cfg": _setup_cfg(package),
        f"resource/{package.name}": "",
        f"{package.name}/__init__.py": "",
    }
    files.update({f"{package.name}/{module.name}.py": module.code for module in modules})
    return {**files, **extra}


def _executables(modules: Sequence[Module]) -> list[tuple[str, str]]:
    """(executable, module) of all that `ros2 run` can start."""
    return [(name, m.name) for m in modules if m.has_main for name in m.executables or (m.name,)]


def _dependencies(modules: Sequence[Module], interfaces: Sequence[str]) -> list[str]:
    """The ROS packages that the modules import."""
    imported: set[str] = set()
    for module in modules:
        try:
            code = inspect(module.code)
        except CodeError:
            continue
        imported |= {name.partition(".")[0] for name in code.imports}
    return sorted(imported & (ros_packages() | {"rclpy", *interfaces}))


def _package_xml(package: Package, dependencies: Sequence[str]) -> str:
    depends = "".join(f"  <exec_depend>{name}</exec_depend>\n" for name in dependencies)
    return (
        '<?xml version="1.0"?>\n'
        '<?xml-model href="http://download.ros.org/schema/package_format3.xsd" '
        'schematypens="http://www.w3.org/2001/XMLSchema"?>\n'
        '<package format="3">\n'
        f"  <name>{package.name}</name>\n"
        f"  <version>{escape(package.version)}</version>\n"
        f"  <description>{escape(package.description or package.name)}</description>\n"
        f"  <maintainer email={quoteattr(package.email)}>{escape(package.maintainer)}</maintainer>\n"
        f"  <license>{escape(package.license)}</license>\n"
        "\n"
        f"{depends}"
        "\n"
        "  <export>\n"
        "    <build_type>ament_python</build_type>\n"
        "  </export>\n"
        "</package>\n"
    )


def _setup_py(package: Package, executables: Sequence[tuple[str, str]], folders: Sequence[str] = ()) -> str:
    scripts = "".join(f"            '{name} = {package.name}.{module}:main',\n" for name, module in executables)
    data = "".join(f"        ('share/' + package_name + '/{name}', glob('{name}/*')),\n" for name in folders)
    settings: Mapping[str, str] = {
        "name": "package_name",
        "version": repr(package.version),
        "packages": "[package_name]",
        "data_files": (
            "[\n"
            "        ('share/ament_index/resource_index/packages', ['resource/' + package_name]),\n"
            "        ('share/' + package_name, ['package.xml']),\n"
            f"{data}"
            "    ]"
        ),
        "install_requires": "['setuptools']",
        "zip_safe": "True",
        "maintainer": repr(package.maintainer),
        "maintainer_email": repr(package.email),
        "description": repr(package.description or package.name),
        "license": repr(package.license),
        "entry_points": "{\n        'console_scripts': [\n" + scripts + "        ],\n    }",
    }
    body = "".join(f"    {key}={value},\n" for key, value in settings.items())
    imports = "from glob import glob\n\n" if folders else ""
    return f"{imports}from setuptools import setup\n\npackage_name = {package.name!r}\n\nsetup(\n{body})\n"


def _setup_cfg(package: Package) -> str:
    return f"[develop]\nscript_dir=$base/lib/{package.name}\n\n[install]\ninstall_scripts=$base/lib/{package.name}\n"
