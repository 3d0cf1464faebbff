"""The wheels of what was compiled here say which machines they fit, and pip installs them."""

from __future__ import annotations

import platform
import re
import subprocess
import sys
import zipfile
from io import BytesIO
from pathlib import Path

from grader.wheels import middleware_wheel
from interface_compiler.wheel_file import platform_tag
from rmw_lockstep.library import DESCRIPTION, PREBUILT


def test_the_middlewares_wheel_is_for_every_python_and_the_systems_of_pypis_ros_2(tmp_path: Path) -> None:
    name, content = middleware_wheel()

    assert re.fullmatch(
        rf"rmw_lockstep_prebuilt-[\d.]+\+[0-9a-f]{{16}}-py3-none-manylinux_2_28_{platform.machine()}\.whl", name
    )
    (tmp_path / name).write_bytes(content)
    pip = [
        sys.executable,
        "-m",
        "pip",
        "install",
        "--quiet",
        "--no-deps",
        "--no-index",
        "--target",
        str(tmp_path / "in"),
    ]
    subprocess.run([*pip, str(tmp_path / name)], check=True, timeout=280)
    assert {"liblockstep.so", "librmw_lockstep_cpp.so", "wheels", DESCRIPTION} <= {
        file.name for file in (tmp_path / "in" / PREBUILT).iterdir()
    }


def test_the_middlewares_wheel_is_small_and_the_same_bytes_each_time() -> None:
    name, content = middleware_wheel()

    assert middleware_wheel() == (name, content)
    assert len(content) < 400_000
    with zipfile.ZipFile(BytesIO(content)) as archive:
        assert archive.testzip() is None


def test_a_wheel_claims_to_fit_only_systems_that_have_what_its_libraries_call() -> None:
    old, newer_c, newer_cpp = (
        b"\x7fELF\0GLIBC_2.14\0GLIBCXX_3.4.21\0",
        b"\x7fELF\0GLIBC_2.14\0GLIBC_2.38\0",
        b"\x7fELF\0GLIBC_2.14\0GLIBCXX_3.4.29\0GLIBCXX_3.4.9\0",
    )

    machine = platform.machine()
    assert platform_tag([old]) == f"manylinux_2_28_{machine}"
    assert platform_tag([old, newer_c]) == f"manylinux_2_38_{machine}"
    assert platform_tag([newer_cpp, old]) == f"manylinux_2_34_{machine}"
    assert platform_tag([b""]) == f"manylinux_2_28_{machine}"
