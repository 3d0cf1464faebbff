"""Builds packages in a prefix, in a process of its own: `python -m interface_compiler.prefix_builder PREFIX PACKAGE …`.

The generators change global state and import many modules, which must not stay in a notebook's kernel.
"""

from __future__ import annotations

import json
import shutil
import sys
import tempfile
from collections.abc import Sequence
from pathlib import Path

from interface_compiler import checks, prefixes
from interface_compiler.definition import CompileError, read_folder
from interface_compiler.gcc import Dependency, compile_package
from interface_compiler.generators import DefinitionFolder, GeneratedCode, generate
from interface_compiler.prefixes import PYTHON, RESOURCES

#: Where a prefix keeps the definitions that it was made from.
DEFINITIONS = "definitions"

_PACKAGE_XML = """\
<?xml version="1.0"?>
<package format="3">
  <name>{package}</name>
  <version>0.0.0</version>
  <description>Interfaces compiled by interface_compiler</description>
  <maintainer email="nobody@example.org">The authors of these definitions</maintainer>
  <license>Apache-2.0</license>
  <member_of_group>rosidl_interface_packages</member_of_group>
</package>
"""


def build(prefix: Path, package: str) -> None:
    """Build one package in a prefix from `prefix/definitions/PACKAGE/{msg,srv,action}/`.

    Other packages it needs are in the same prefix, or installed. Raises CompileError if gcc fails.
    """
    wheels = Path(sys.prefix)
    places = prefixes.packages([prefix, *prefixes.installed()])
    known = {name: places[name] / "share" / name for name in places if name != package}
    sources = DefinitionFolder(package, prefix / DEFINITIONS / package, prefix / "share" / package, known)
    definitions = [item for item in read_folder(prefix / DEFINITIONS)[0] if item.package == package]
    needed = sorted(checks.dependencies(definitions)[package])
    with tempfile.TemporaryDirectory(prefix=f"{package}-") as temporary:
        work = Path(temporary)
        generated = generate(sources, work, prefix / PYTHON / package, wheels / "share")
        used = [Dependency(name, places[name]) for name in _used(sources, needed)]
        compile_package(generated, work, used, wheels)
        _write_init(generated, used)
        _copy_headers(generated, prefix)
    _write_index(prefix, sources, needed)


def _used(sources: DefinitionFolder, needed: Sequence[str]) -> list[str]:
    """Return the packages whose types this one uses, including those inside nested types."""
    used = set(needed)
    for interface in sources.interfaces():
        content = json.loads((sources.share / interface).with_suffix(".json").read_text(encoding="utf-8"))
        described = content["type_description_msg"]["referenced_type_descriptions"]
        used |= {entry["type_name"].split("/")[0] for entry in described}
    return sorted(used - {sources.package})


def _write_init(generated: GeneratedCode, used: Sequence[Dependency]) -> None:
    lines = [f'"""The interfaces of the ROS 2 package {generated.package}."""\n']
    ours = [dependency.package for dependency in used if dependency.is_ours]
    if ours:
        lines.append("\n# Their libraries have to be loaded before this package's own.\n")
        lines += [f"import {name}.{name}_s__rosidl_typesupport_c\n" for name in ours]
    (generated.python / "__init__.py").write_text("".join(lines), encoding="utf-8")


def _copy_headers(generated: GeneratedCode, prefix: Path) -> None:
    """Keep the headers, for packages that use this one's types."""
    target = prefix / "include" / generated.package
    for root in (generated.c, generated.introspection):
        for header in root.rglob("*.h"):
            copy = target / header.relative_to(root)
            copy.parent.mkdir(parents=True, exist_ok=True)
            shutil.copyfile(header, copy)


def _write_index(prefix: Path, sources: DefinitionFolder, needed: Sequence[str]) -> None:
    """Write what ament finds the package by: its markers and its package.xml."""
    files = [file for item in sources.interfaces() for file in (item.as_posix(), item.with_suffix(".idl").as_posix())]
    markers = {
        "rosidl_interfaces": "\n".join(sorted(files)) + "\n",
        "package_run_dependencies": ";".join(needed),
        "packages": "",
    }
    (sources.share / "package.xml").write_text(_PACKAGE_XML.format(package=sources.package), encoding="utf-8")
    for kind, text in markers.items():
        (prefix / RESOURCES / kind).mkdir(parents=True, exist_ok=True)
        (prefix / RESOURCES / kind / sources.package).write_text(text, encoding="utf-8")


def main() -> int:
    """Build the packages that the command line names, in that order; return the exit code."""
    try:
        for package in sys.argv[2:]:
            build(Path(sys.argv[1]), package)
    except CompileError as error:
        print(error, file=sys.stderr)
        return 1
    return 0


if __name__ == "__main__":
    sys.exit(main())
