"""The files of an ament_python package, as text: what `ros2 pkg create` writes."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from xml.sax.saxutils import escape, quoteattr

# Layout as in ROS 2's documentation of ament_python: package.xml (REP 149, format 3), setup.py with the executables as
# console_scripts, setup.cfg that puts them into lib/PACKAGE, and an empty marker for the ament index.


@dataclass(frozen=True)
class Manifest:
    """What a package says about itself in package.xml and setup.py.

    `depends` are needed to build and to run, `exec_depends` only to run.
    """

    name: str
    version: str
    description: str
    maintainer: str
    email: str
    license: str
    depends: Sequence[str] = ()
    exec_depends: Sequence[str] = ()


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
    manifest: Manifest, executables: Sequence[tuple[str, str]], folders: Sequence[str] = ()
) -> dict[str, str]:
    """Return path within the package's folder -> content, of all but the modules.

    `executables` are pairs of what `ros2 run` calls it and the module with its `main`. Of `folders`, such as `launch`,
    setup.py installs every file.
    """
    return {
        "package.xml": package_xml(manifest, "ament_python", TEST_DEPENDENCIES),
        "setup.py": _setup_py(manifest, executables, folders),
        "setup.cfg": _setup_cfg(manifest),
        f"resource/{manifest.name}": "",
        f"{manifest.name}/__init__.py": "",
        **{f"test/test_{name}.py": text for name, text in TESTS.items()},
    }


def package_xml(
    manifest: Manifest,
    build_type: str,
    test_dependencies: Sequence[str] = (),
    buildtools: Sequence[str] = (),
    groups: Sequence[str] = (),
) -> str:
    """Return the text of package.xml for a package of this build type. `groups` are those to which it belongs."""
    needs = {
        "buildtool_depend": buildtools,
        "exec_depend": manifest.exec_depends,
        "depend": manifest.depends,
        "member_of_group": groups,
    }
    depends = "".join(f"  <{tag}>{name}</{tag}>\n" for tag, names in needs.items() for name in names)
    tests = "".join(f"  <test_depend>{name}</test_depend>\n" for name in test_dependencies)
    return (
        '<?xml version="1.0"?>\n'
        '<?xml-model href="http://download.ros.org/schema/package_format3.xsd" '
        'schematypens="http://www.w3.org/2001/XMLSchema"?>\n'
        '<package format="3">\n'
        f"  <name>{manifest.name}</name>\n"
        f"  <version>{escape(manifest.version)}</version>\n"
        f"  <description>{escape(manifest.description or manifest.name)}</description>\n"
        f"  <maintainer email={quoteattr(manifest.email)}>{escape(manifest.maintainer)}</maintainer>\n"
        f"  <license>{escape(manifest.license)}</license>\n"
        "\n"
        f"{depends}"
        "\n"
        f"{tests}"
        "\n"
        "  <export>\n"
        f"    <build_type>{build_type}</build_type>\n"
        "  </export>\n"
        "</package>\n"
    )


def _setup_py(manifest: Manifest, executables: Sequence[tuple[str, str]], folders: Sequence[str]) -> str:
    scripts = "".join(f"            '{name} = {manifest.name}.{module}:main',\n" for name, module in executables)
    data = "".join(f"        ('share/' + package_name + '/{name}', glob('{name}/*')),\n" for name in folders)
    settings: Mapping[str, str] = {
        "name": "package_name",
        "version": repr(manifest.version),
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
        "maintainer": _literal("maintainer", manifest.maintainer),
        "maintainer_email": _literal("maintainer_email", manifest.email),
        "description": _literal("description", manifest.description or manifest.name),
        "license": _literal("license", manifest.license),
        # By this colcon sees that the tests are pytest's.
        "extras_require": "{'test': ['pytest']}",
        "entry_points": "{\n        'console_scripts': [\n" + scripts + "        ],\n    }",
    }
    body = "".join(f"    {key}={value},\n" for key, value in settings.items())
    imports = "from glob import glob\n\n" if folders else ""
    return f"{imports}from setuptools import setup\n\npackage_name = {manifest.name!r}\n\nsetup(\n{body})\n"


def _literal(key: str, text: str) -> str:
    """Return a text as Python source, in pieces if it is too long for its line."""
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


def _setup_cfg(manifest: Manifest) -> str:
    return f"[develop]\nscript_dir=$base/lib/{manifest.name}\n\n[install]\ninstall_scripts=$base/lib/{manifest.name}\n"
