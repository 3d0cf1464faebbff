"""The wheels' own interfaces, described again from their definitions: CMake's descriptions and hashes exactly."""

from __future__ import annotations

import json
import subprocess
import sys
from pathlib import Path

import pytest

from interface_compiler import prefixes

WHEELS = Path(sys.prefix)
DESCRIBE = """
import sys
from pathlib import Path
from interface_compiler import prefixes
from interface_compiler.generators import DefinitionFolder, describe
out = Path(sys.argv[1])
for package in sys.argv[2:]:
    for path, text in prefixes.definitions_of(package, Path(sys.prefix)).items():
        (out / "in" / package / path).parent.mkdir(parents=True, exist_ok=True)
        (out / "in" / package / path).write_text(text)
    known = {name: prefix / "share" / name for name, prefix in prefixes.packages([Path(sys.prefix)]).items()}
    del known[package]
    describe(DefinitionFolder(package, out / "in" / package, out / package, known), out)
"""


def compare(packages: list[str], out: Path) -> tuple[int, list[str]]:
    """Return how many descriptions are the same, and which differ."""
    subprocess.run([sys.executable, "-c", DESCRIBE, str(out), *packages], check=True, timeout=250)
    same, different = 0, []
    for package in packages:
        for path in prefixes.definitions_of(package, WHEELS):
            name = Path(package, path).with_suffix(".json")
            if json.loads((out / name).read_text()) == json.loads((WHEELS / "share" / name).read_text()):
                same += 1
            else:
                different.append(str(name))
    return same, different


def test_descriptions_are_those_that_cmake_made(tmp_path: Path) -> None:
    same, different = compare(["builtin_interfaces", "std_msgs", "action_msgs"], tmp_path)

    assert different == []
    assert same > 30


@pytest.mark.soak
def test_every_description_of_the_wheels_is_the_one_that_cmake_made(tmp_path: Path) -> None:
    made_here = {"example_interfaces", "turtlesim"}
    packages = sorted(prefixes.interfaces([WHEELS]).keys() - made_here)

    same, different = compare([name for name in packages if prefixes.definitions_of(name, WHEELS)], tmp_path)

    assert different == []
    assert same >= 199
