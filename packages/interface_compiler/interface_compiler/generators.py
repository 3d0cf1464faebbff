"""Runs ROS's code generators on the definitions of one package.

They are those that CMake's `rosidl_generate_interfaces` runs, so types and hashes are the same. Their command lines
describe their input: https://github.com/ros2/rosidl and https://github.com/ros2/rosidl_python.
"""

from __future__ import annotations

import contextlib
import functools
import importlib
import io
import json
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from types import ModuleType
from typing import Any

#: The type supports that rclpy and Fast DDS use. Without introspection, nested types of another package fail.
TYPE_SUPPORTS = ("rosidl_typesupport_fastrtps_c", "rosidl_typesupport_introspection_c")
_HEADERS_OF_OWN = ("rosidl_generator_c", *TYPE_SUPPORTS)


@dataclass(frozen=True)
class GeneratedCode:
    """Where the code of one package was written: C and C++, the C of introspection, and Python with its C."""

    package: str
    c: Path
    introspection: Path
    python: Path


@dataclass(frozen=True)
class DefinitionFolder:
    """One package's definitions: `folder/{msg,srv,action}/…`, and `share` for their installed files.

    `known` are the folders of the other packages' shared files, by package.
    """

    package: str
    folder: Path
    share: Path
    known: Mapping[str, Path]

    def interfaces(self) -> list[Path]:
        """Return the definitions, relative to the folder, sorted."""
        files = (file for kind in ("msg", "srv", "action") for file in self.folder.glob(f"{kind}/*.{kind}"))
        return sorted(file.relative_to(self.folder) for file in files)


def generate(sources: DefinitionFolder, work: Path, python: Path, templates: Path) -> GeneratedCode:
    """Write the code of a package, and its .idl files and type descriptions into its share folder.

    Args:
        sources: the definitions.
        work: an empty folder for files that only the compiler needs.
        python: where the Python package goes.
        templates: the `share` folder that has the generators' templates.
    """
    generated = GeneratedCode(sources.package, work / "c", work / "introspection", python)
    for folder in (generated.c / sources.package, generated.introspection / sources.package, python):
        folder.mkdir(parents=True, exist_ok=True)
    _read_each_idl_once()
    _search_each_template_once()
    # The generators print what they write.
    with contextlib.redirect_stdout(io.StringIO()):
        _write_idl(sources)
        _Generators(sources, generated, work, templates).run()
    (python / "__init__.py").touch()
    _write_visibility(generated, templates)
    return generated


def describe(sources: DefinitionFolder, work: Path) -> None:
    """Write only the .idl files and the type descriptions, with their hashes, into a package's share folder."""
    _read_each_idl_once()
    with contextlib.redirect_stdout(io.StringIO()):
        _write_idl(sources)
        _Generators(sources, GeneratedCode(sources.package, work, work, work), work, work).describe()


def _write_idl(sources: DefinitionFolder) -> None:
    from rosidl_adapter import convert_to_idl

    for interface in sources.interfaces():
        target = sources.share / interface
        target.parent.mkdir(parents=True, exist_ok=True)
        target.write_bytes((sources.folder / interface).read_bytes())
        convert_to_idl(sources.folder, sources.package, interface, sources.share)


class _Generators:
    """Calls the generators one after another. Each reads its arguments from a JSON file."""

    def __init__(self, sources: DefinitionFolder, generated: GeneratedCode, work: Path, templates: Path) -> None:
        self._sources, self._generated, self._work, self._templates = sources, generated, work, templates
        idl = [interface.with_suffix(".idl").as_posix() for interface in sources.interfaces()]
        self._common = {
            "package_name": sources.package,
            "idl_tuples": [f"{sources.share}:{name}" for name in idl],
            "ros_interface_files": [str(sources.share / interface) for interface in sources.interfaces()],
            "target_dependencies": [],
        }
        self._descriptions = [f"{name}:{(sources.share / name).with_suffix('.json')}" for name in idl]

    def run(self) -> None:
        package, generated = self._sources.package, self._generated
        c, introspection = generated.c / package, generated.introspection / package
        self.describe()
        self._call("rosidl_generator_c", "generate_c", c)
        self._call("rosidl_typesupport_fastrtps_c", "generate_typesupport_fastrtps_c", c)
        self._call("rosidl_typesupport_introspection_c", "generate_c", introspection)
        self._call("rosidl_typesupport_c", "generate_c", c, more=[list(TYPE_SUPPORTS)])
        self._call("rosidl_generator_py", "generate_py", generated.python, more=[["rosidl_typesupport_c"]])

    def describe(self) -> None:
        includes = [f"{name}:{folder}" for name, folder in sorted(self._sources.known.items())]
        self._call("rosidl_generator_type_description", "generate_type_hash", self._sources.share, includes)

    def _call(
        self, generator: str, function: str, output: Path, includes: Sequence[str] = (), more: Sequence[Any] = ()
    ) -> None:
        arguments = self._work / f"{generator}.json"
        content = {
            **self._common,
            "output_dir": str(output),
            "template_dir": str(self._templates / generator / "resource"),
            "include_paths": list(includes),
            "type_description_tuples": self._descriptions,
        }
        arguments.write_text(json.dumps(content), encoding="utf-8")
        getattr(importlib.import_module(generator), function)(str(arguments), *more)


def _write_visibility(generated: GeneratedCode, templates: Path) -> None:
    """Write the headers with the export macros, which CMake makes in a usual build."""
    folder = generated.c / generated.package / "msg"
    folder.mkdir(exist_ok=True)
    for generator in _HEADERS_OF_OWN:
        name = f"{generator}__visibility_control.h"
        text = (templates / generator / "resource" / f"{name}.in").read_text(encoding="utf-8")
        text = text.replace("@PROJECT_NAME@", generated.package).replace(
            "@PROJECT_NAME_UPPER@", generated.package.upper()
        )
        (folder / name).write_text(text, encoding="utf-8")


@functools.cache
def _read_each_idl_once() -> None:
    """Let the generators share what they parse: otherwise each spends most of its time on parsing every .idl again."""
    import rosidl_generator_py.generate_py_impl
    import rosidl_generator_type_description
    import rosidl_parser.parser
    import rosidl_pycommon

    read: Callable[..., Any] = rosidl_parser.parser.parse_idl_file
    parsed: dict[str, Any] = {}

    def parse_idl_file(locator: Any, png_file: Any = None) -> Any:
        key = str(locator.get_absolute_path())
        if key not in parsed:
            parsed[key] = read(locator)
        return parsed[key]

    modules: list[ModuleType] = [
        rosidl_parser.parser,
        rosidl_generator_type_description,
        rosidl_pycommon,
        rosidl_generator_py.generate_py_impl,
    ]
    for module in modules:
        module.parse_idl_file = parse_idl_file  # type: ignore[attr-defined]


@functools.cache
def _search_each_template_once() -> None:
    """Let the template engine remember where expressions end: otherwise it parses a template again for each message."""
    import em

    for name in ("complex", "next"):
        setattr(em.Scanner, name, _remembered(getattr(em.Scanner, name), (em.ParseError, em.TransientParseError)))


def _remembered(search: Callable[..., int], failures: tuple[type[Exception], ...]) -> Callable[..., int]:
    """Cache the result or exception of a search by the text, the position in it and the arguments."""
    found: dict[tuple[object, ...], int | Exception] = {}

    def remembered(scanner: Any, *words: object) -> int:
        key = (scanner.buffer, scanner.head + scanner.pointer, *words)
        if key not in found:
            try:
                found[key] = search(scanner, *words)
            except failures as failure:
                found[key] = failure
        result = found[key]
        if isinstance(result, Exception):
            raise result.with_traceback(None)
        return result

    return remembered
