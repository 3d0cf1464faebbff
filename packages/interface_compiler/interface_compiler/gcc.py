"""Compiles the generated code of one package with gcc, into one Python extension module.

CMake makes eight libraries per package, which find one another by name on LD_LIBRARY_PATH. Here they are one library,
which needs no search: a table in it (`dispatch.cpp`) replaces the search of `librosidl_typesupport_c`.
"""

from __future__ import annotations

import os
import re
import subprocess
from collections.abc import Iterable, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from pathlib import Path

from interface_compiler import toolchain
from interface_compiler.definition import CompileError
from interface_compiler.generators import GeneratedCode
from interface_compiler.prefixes import PYTHON

#: The wheels' libraries that the code calls, and those whose headers it includes.
_LIBRARIES = (
    *("rosidl_runtime_c", "rosidl_typesupport_c", "rosidl_typesupport_fastrtps_c", "rosidl_typesupport_fastrtps_cpp"),
    *("rosidl_typesupport_introspection_c", "fastcdr", "rcutils", "rmw"),
)
_HEADERS = (
    *("rosidl_runtime_c", "rosidl_runtime_cpp", "rosidl_typesupport_interface", "rosidl_typesupport_c"),
    *("rosidl_typesupport_introspection_c", "rosidl_typesupport_fastrtps_c", "rosidl_typesupport_fastrtps_cpp"),
    *("fastcdr", "rmw", "rcutils", "rcpputils", "rosidl_dynamic_typesupport", "tracetools"),
)
#: The libraries into which CMake puts a package.
_PARTS_BY_CMAKE = (
    *("rosidl_generator_c", "rosidl_generator_py", "rosidl_typesupport_c"),
    *("rosidl_typesupport_fastrtps_c", "rosidl_typesupport_introspection_c"),
)
_FLAGS = ("-O1", "-fPIC", "-g0", "-fvisibility=default")
_DISPATCH = Path(__file__).with_name("dispatch.cpp.in")
#: Restricts the converters from and to Python to the limited API. Using anything else must be an error, not a warning.
_PYTHON_UNIT = "python.c"
_LIMITED_API = Path(__file__).with_name("limited_api.h")
_CONVERTER_FLAGS = ("-include", str(_LIMITED_API), "-Werror=implicit-function-declaration")
#: `tp_name` is not in the limited API: the test in the generated code, which `is_named` of limited_api.h replaces.
_TYPE_NAME = re.compile(r'strcmp\(field->ob_type->tp_name, ("[\w.]+")\) == 0')
_TYPE_IS_NAMED = "assert(field->ob_type->tp_name != NULL);"
#: Makes the library's own copies of std::string's functions, some of which older C++ libraries lack.
_OWN_STRINGS = "#include <cstddef>\n#undef _GLIBCXX_EXTERN_TEMPLATE\n#define _GLIBCXX_EXTERN_TEMPLATE 0\n"
_SYMBOL = re.compile(r"STRINGIFY\(ROSIDL_TYPESUPPORT_INTERFACE__(MESSAGE|SERVICE)_SYMBOL_NAME\((\w+), ([^)]*)\)\)")


@dataclass(frozen=True)
class Dependency:
    """Another package whose types this one uses, and the prefix it is installed in."""

    package: str
    prefix: Path

    @property
    def module(self) -> Path:
        """Its extension module, if the package was compiled here; absent if CMake made it."""
        return self.prefix / PYTHON / self.package / module_name(self.package)

    @property
    def is_ours(self) -> bool:
        """Whether it was compiled here."""
        return self.module.is_file()

    def libraries(self) -> list[Path]:
        """Return what to link against."""
        if self.is_ours:
            return [self.module]
        found = [self.prefix / "lib" / f"lib{self.package}__{part}.so" for part in _PARTS_BY_CMAKE]
        return [library for library in found if library.is_file()]


def module_name(package: str) -> str:
    """The file name of a package's extension module, which rosidl's Python code imports by this name.

    Its ending is that of every Python from 3.10 on (PEP 3149, PEP 384).
    """
    return f"{package}_s__rosidl_typesupport_c.abi3.so"


def compile_package(generated: GeneratedCode, work: Path, dependencies: Sequence[Dependency], wheels: Path) -> Path:
    """Compile a package's code. Return the extension module, which is in its Python package.

    Args:
        generated: the code.
        work: a folder for objects.
        dependencies: the packages whose types it uses.
        wheels: the prefix with ROS's own headers and libraries.

    Raises `CompileError` if gcc fails.
    """
    units = _units(generated, work)
    # Assertions in the code name its file: without the folder, so that the result is the same in every folder.
    places = [f"-ffile-prefix-map={folder}=." for folder in (work, generated.python)]
    flags = [*_FLAGS, *places, *_includes(generated, dependencies, wheels)]
    objects = [work / f"{number}.o" for number in range(len(units))]
    with ThreadPoolExecutor(os.cpu_count()) as pool:
        done = pool.map(lambda unit, target: _compile(unit, target, flags, generated.package), units, objects)
        list(done)  # raises what a compiler has raised
    module = generated.python / module_name(generated.package)
    libraries = [str(library) for dependency in dependencies for library in dependency.libraries()]
    libraries += [str(wheels / "lib" / f"lib{name}.so") for name in _LIBRARIES]
    link = ["-shared", "-s", "-Wl,--as-needed", f"-Wl,-soname,{module.name}", "-Wl,-rpath,$ORIGIN/../../.."]
    _run(["g++", *link, "-o", str(module), *map(str, objects), *libraries], generated.package)
    for source in _python_sources(generated):
        source.unlink()
    return module


def _units(generated: GeneratedCode, work: Path) -> list[Path]:
    """Return the compiler's inputs, as few as possible: it spends most of its time on reading headers."""
    c, introspection = generated.c / generated.package, generated.introspection / generated.package
    kinds = ("msg", "srv", "action")
    details = [c / kind / "detail" for kind in kinds]
    cpp = [*_each(details, "*.cpp"), *_each([c / kind for kind in kinds], "*__type_support.cpp")]
    for source in _python_sources(generated):
        _limit(source)
    dispatch = work / "dispatch.cpp"
    dispatch.write_text(_dispatch(c), encoding="utf-8")
    return [
        *_joined(work / "fastrtps.cpp", [*cpp, dispatch]),
        *_joined(work / _PYTHON_UNIT, _python_sources(generated)),
        *_joined(work / "functions.c", [*_each(details, "*__functions.c"), *_each(details, "*__type_support.c")]),
        *_joined(work / "introspection.c", _each([introspection / kind / "detail" for kind in kinds], "*.c")),
        # These define the same static names and can't be joined.
        *_each(details, "*__description.c"),
    ]


def _each(folders: Iterable[Path], pattern: str) -> list[Path]:
    return [source for folder in folders for source in sorted(folder.glob(pattern))]


def _joined(unit: Path, sources: Sequence[Path]) -> list[Path]:
    if not sources:
        return []
    includes = "".join(f'#include "{source}"\n' for source in sources)
    unit.write_text((_OWN_STRINGS if unit.suffix == ".cpp" else "") + includes, encoding="utf-8")
    return [unit]


def _python_sources(generated: GeneratedCode) -> list[Path]:
    converters = sorted(generated.python.glob("*/*_s.c"))
    return [*converters, *sorted(generated.python.glob(f"_{generated.package}_s.ep.*.c"))]


def _limit(source: Path) -> None:
    """Replace the test of a type's name by one that the limited API allows."""
    text = source.read_text(encoding="utf-8").replace(_TYPE_IS_NAMED, "")
    source.write_text(_TYPE_NAME.sub(r"is_named(field, \1)", text), encoding="utf-8")


def _dispatch(c: Path) -> str:
    """Return the table's code: each type support that the generated code would search for, by that name."""
    found: dict[str, list[str]] = {"message": [], "service": []}
    for source in sorted(c.glob("*/*__type_support.cpp")):
        for kind, support, names in _SYMBOL.findall(source.read_text(encoding="utf-8")):
            interface = "__".join(part.strip() for part in names.split(","))
            found[kind.lower()].append(f"{support}__get_{kind.lower()}_type_support_handle__{interface}")
    text = _DISPATCH.read_text(encoding="utf-8")
    declared = [f"const rosidl_{kind}_type_support_t * {name}();" for kind, names in found.items() for name in names]
    text = text.replace("@DECLARATIONS@", "\n".join(declared))
    for kind, names in found.items():
        text = text.replace(f"@{kind.upper()}S@", "".join(f'  {{"{name}", {name}}},\n' for name in names))
    return text


def _includes(generated: GeneratedCode, dependencies: Iterable[Dependency], wheels: Path) -> list[str]:
    import numpy

    folders = [generated.c, generated.introspection, toolchain.headers(), Path(numpy.get_include())]
    folders += [wheels / "include", *(wheels / "include" / name for name in _HEADERS)]
    folders += [dependency.prefix / "include" / dependency.package for dependency in dependencies]
    return [f"-I{folder}" for folder in folders if folder.is_dir()]


def _compile(unit: Path, target: Path, flags: Sequence[str], package: str) -> None:
    if unit.suffix == ".cpp":
        renamed = [
            f"-Drosidl_typesupport_c__get_{kind}_typesupport_handle_function=own_{kind}_typesupport"
            for kind in ("message", "service")
        ]
        compiler = ["g++", "-std=c++17", *renamed]
    else:
        compiler = ["gcc", "-std=gnu11"]
    compiler += _CONVERTER_FLAGS if unit.name == _PYTHON_UNIT else ["-w"]
    _run([*compiler, *flags, "-c", str(unit), "-o", str(target)], package)


def _run(command: Sequence[str], package: str) -> None:
    done = subprocess.run(command, capture_output=True, text=True, errors="replace", check=False)
    if done.returncode == 0:
        return
    lines = [line for line in done.stderr.splitlines() if "error" in line.lower()] or done.stderr.splitlines()
    first = re.sub(r"^\S*/", "", lines[0])[:300] if lines else f"{command[0]} ended with exit code {done.returncode}"
    raise CompileError(
        f"{command[0]} failed on the package {package}: {first}. Its definitions are valid, so this is a fault of "
        f"the installation of {command[0]} or of interface_compiler."
    )
