"""The files of an ament_cmake package, as text: what `ros2 pkg create` writes by default.

Commands: https://docs.ros.org/en/jazzy/How-To-Guides/Ament-CMake-Documentation.html
"""

from __future__ import annotations

from collections.abc import Sequence

from ros_in_python.ros2.ament_python import Manifest, package_xml

#: What the linters' tests need: in package.xml.
_TEST_DEPENDENCIES = ("ament_lint_auto", "ament_lint_common")

_HEAD = """\
cmake_minimum_required(VERSION 3.8)
project({name})

if(CMAKE_COMPILER_IS_GNUCXX OR CMAKE_CXX_COMPILER_ID MATCHES "Clang")
  add_compile_options(-Wall -Wextra -Wpedantic)
endif()

find_package(ament_cmake REQUIRED)
"""
_NODE = """
add_executable({node} src/{node}.cpp)
target_compile_features({node} PUBLIC c_std_99 cxx_std_17)
{needs}install(TARGETS {node} DESTINATION lib/${{PROJECT_NAME}})
"""
_LIBRARY = """
add_library({library} src/{library}.cpp)
target_include_directories({library} PUBLIC
  $<BUILD_INTERFACE:${{CMAKE_CURRENT_SOURCE_DIR}}/include>
  $<INSTALL_INTERFACE:include/${{PROJECT_NAME}}>)
{needs}install(DIRECTORY include/ DESTINATION include/${{PROJECT_NAME}})
install(TARGETS {library} EXPORT export_${{PROJECT_NAME}})
ament_export_targets(export_${{PROJECT_NAME}})
"""
_TAIL = """
if(BUILD_TESTING)
  find_package(ament_lint_auto REQUIRED)
  # These two ask for a notice in each file, and for a repository.
  set(ament_cmake_copyright_FOUND TRUE)
  set(ament_cmake_cpplint_FOUND TRUE)
  ament_lint_auto_find_test_dependencies()
endif()

ament_package()
"""
_MAIN = """\
#include <cstdio>

int main()
{{
  std::printf("hello world {name} package\\n");
  return 0;
}}
"""
_HEADER = """\
#ifndef {guard}
#define {guard}

namespace {name}
{{

class {kind}
{{
public:
  {kind}();
}};

}}  // namespace {name}

#endif  // {guard}
"""
_SOURCE = """\
#include "{name}/{library}.hpp"

namespace {name}
{{

{kind}::{kind}() = default;

}}  // namespace {name}
"""


def cmake_files(manifest: Manifest, depends: Sequence[str], node: str, library: str) -> dict[str, str]:
    """Return path within the package's folder -> content. `node` and `library` are what it makes, if anything."""
    name = manifest.name
    found = "".join(f"find_package({package} REQUIRED)\n" for package in depends)
    text = _HEAD.format(name=name) + found
    files: dict[str, str] = {}
    if library:
        text += _LIBRARY.format(library=library, needs=_needs(library, depends))
        kind = library.title().replace("_", "")
        guard = f"{name}__{library}_HPP_".upper()
        files[f"include/{name}/{library}.hpp"] = _HEADER.format(name=name, kind=kind, guard=guard)
        files[f"src/{library}.cpp"] = _SOURCE.format(name=name, kind=kind, library=library)
    if node:
        text += _NODE.format(node=node, needs=_needs(node, depends))
        files[f"src/{node}.cpp"] = _MAIN.format(name=name)
    xml = package_xml(manifest, "ament_cmake", _TEST_DEPENDENCIES, buildtools=["ament_cmake"])
    return {"package.xml": xml, "CMakeLists.txt": text + _TAIL, **files}


def _needs(target: str, depends: Sequence[str]) -> str:
    return f"ament_target_dependencies({target} {' '.join(depends)})\n" if depends else ""
