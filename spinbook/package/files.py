"""The files of an ament_python package of nodes and an ament_cmake package of interfaces, as text."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from xml.sax.saxutils import escape, quoteattr

from interface_compiler.checks import dependencies
from interface_compiler.definition import Definition
from spinbook.chapter.imports import ros_packages
from spinbook.chapter.python_code import CodeError, inspect
from spinbook.course.course import Package

# Layout as in ROS 2's documentation of ament_python: package.xml (REP 149, format 3), setup.py with the executables as
# console_scripts, setup.cfg that puts them into lib/PACKAGE, and an empty marker for the ament index.


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


#: The tests that `ros2 pkg create` gives a package of Python: copyright notices, flake8, PEP 257. Where ROS 2 is not
#: installed its linters are not there, and the tests are skipped: a package without any test fails `colcon test`.
TESTS = {
    "copyright": (
        "import pytest\n\n\n"
        "# The modules have no copyright notice yet: without this mark the test asks for one.\n"
        "@pytest.mark.skip(reason='No copyright notice has been put into the source files.')\n"
        "@pytest.mark.copyright\n"
        "@pytest.mark.linter\n"
        "def test_copyright():\n"
        "    main = pytest.importorskip('ament_copyright.main', reason='ament_copyright comes with ROS 2')\n"
        "    assert main.main(argv=['.', 'test']) == 0, 'Found errors'\n"
    ),
    "flake8": (
        "import pytest\n\n\n"
        "@pytest.mark.flake8\n"
        "@pytest.mark.linter\n"
        "def test_flake8():\n"
        "    main = pytest.importorskip('ament_flake8.main', reason='ament_flake8 comes with ROS 2')\n"
        "    code, errors = main.main_with_errors(argv=[])\n"
        "    assert code == 0, '\\n'.join(errors)\n"
    ),
    "pep257": (
        "import pytest\n\n\n"
        "@pytest.mark.linter\n"
        "@pytest.mark.pep257\n"
        "def test_pep257():\n"
        "    main = pytest.importorskip('ament_pep257.main', reason='ament_pep257 comes with ROS 2')\n"
        "    assert main.main(argv=['.', 'test']) == 0, 'Found code style errors'\n"
    ),
}

#: What the tests need: in package.xml.
TEST_DEPENDENCIES = ("ament_copyright", "ament_flake8", "ament_pep257", "python3-pytest")

#: ament_flake8 allows no longer line.
LONGEST_LINE = 99


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
        **{f"test/test_{name}.py": text for name, text in TESTS.items()},
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
    tests = "".join(f"  <test_depend>{name}</test_depend>\n" for name in TEST_DEPENDENCIES)
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
        f"{tests}"
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
        "maintainer": _literal("maintainer", package.maintainer),
        "maintainer_email": _literal("maintainer_email", package.email),
        "description": _literal("description", package.description or package.name),
        "license": _literal("license", package.license),
        # By this colcon sees that the tests are pytest's.
        "extras_require": "{'test': ['pytest']}",
        "entry_points": "{\n        'console_scripts': [\n" + scripts + "        ],\n    }",
    }
    body = "".join(f"    {key}={value},\n" for key, value in settings.items())
    imports = "from glob import glob\n\n" if folders else ""
    return f"{imports}from setuptools import setup\n\npackage_name = {package.name!r}\n\nsetup(\n{body})\n"


def _literal(key: str, text: str) -> str:
    """A text as Python source; one that is too long for its line in pieces."""
    if len(f"    {key}={text!r},") <= LONGEST_LINE:
        return repr(text)
    pieces, rest = [], text
    while rest:
        size = LONGEST_LINE - 12
        while len(repr(rest[:size])) > LONGEST_LINE - 10:
            size -= 1
        pieces.append(rest[:size])
        rest = rest[size:]
    return "(\n" + "".join(f"        {piece!r}\n" for piece in pieces) + "    )"


def _setup_cfg(package: Package) -> str:
    return f"[develop]\nscript_dir=$base/lib/{package.name}\n\n[install]\ninstall_scripts=$base/lib/{package.name}\n"


# Layout as in ROS 2's documentation, "Creating custom msg and srv files" and "Creating an action".


def interface_package_files(course: Package, definitions: Sequence[Definition]) -> dict[str, str]:
    """Path within the package's folder -> content, for the definitions of one package.

    Maintainer, version and licence are those of the course's package of nodes.
    """
    name = definitions[0].package
    # ROS adds what services and actions need by itself, action_msgs apart.
    needed = sorted(dependencies(definitions)[name] - {"service_msgs", "unique_identifier_msgs", "action_msgs"})
    if any(item.kind == "action" for item in definitions):
        needed.append("action_msgs")
    files = {item.path: item.text for item in definitions}
    return {
        **files,
        "CMakeLists.txt": _cmake(name, sorted(files), needed),
        "package.xml": _interface_package_xml(course, name, needed),
    }


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


def _interface_package_xml(course: Package, name: str, needed: Sequence[str]) -> str:
    tags: Mapping[str, Sequence[str]] = {
        "buildtool_depend": ("ament_cmake", "rosidl_default_generators"),
        "depend": needed,
        "exec_depend": ("rosidl_default_runtime",),
        "member_of_group": ("rosidl_interface_packages",),
    }
    lines = "".join(f"  <{tag}>{value}</{tag}>\n" for tag, values in tags.items() for value in values)
    return (
        '<?xml version="1.0"?>\n'
        '<?xml-model href="http://download.ros.org/schema/package_format3.xsd" '
        'schematypens="http://www.w3.org/2001/XMLSchema"?>\n'
        '<package format="3">\n'
        f"  <name>{name}</name>\n"
        f"  <version>{escape(course.version)}</version>\n"
        f"  <description>Messages, services and actions of {escape(course.name)}</description>\n"
        f"  <maintainer email={quoteattr(course.email)}>{escape(course.maintainer)}</maintainer>\n"
        f"  <license>{escape(course.license)}</license>\n"
        f"\n{lines}\n"
        "  <export>\n"
        "    <build_type>ament_cmake</build_type>\n"
        "  </export>\n"
        "</package>\n"
    )
