"""The file format of wheels: a zip whose RECORD lists every file with its hash. The same files give the same bytes.

PEP 427, and "Recording installed projects" in the Python Packaging User Guide.
"""

from __future__ import annotations

import base64
import csv
import hashlib
import io
import platform
import re
import stat
import zipfile
from collections.abc import Iterable, Mapping
from types import MappingProxyType

#: PyPI's wheels of ROS 2 need glibc 2.28: wheels for use with them need not claim to fit older systems.
_OLDEST_GLIBC = 28
#: The last number of a glibc -> that of the newest `GLIBCXX_3.4.x` beside it, as in auditwheel's manylinux policies.
_CPP_LIBRARIES = {28: 24, 31: 28, 34: 29, 35: 30, 39: 33}
_GLIBC = re.compile(rb"\0GLIBC_2\.(\d+)")
_GLIBCXX = re.compile(rb"\0GLIBCXX_3\.4\.(\d+)")


def wheel_file(
    project: str, version: str, summary: str, python: str, files: Mapping[str, bytes], data: Mapping[str, bytes]
) -> tuple[str, bytes]:
    """Return the file name and content of a wheel of compiled libraries.

    Args:
        project: such as `compiled-interfaces-turtlesim`.
        version: such as `0.1.0`.
        summary: what it is, in one line.
        python: for which Pythons, such as `py3-none` or `cp310-abi3`.
        files: what pip puts into site-packages, by name.
        data: what it puts into the environment itself, such as `share/…`.
    """
    name = f"{project.replace('-', '_')}-{version}"
    tag = f"{python}-{platform_tag(files.values())}"
    content = {**files, **{f"{name}.data/data/{file}": text for file, text in data.items()}}
    content[f"{name}.dist-info/METADATA"] = (
        f"Metadata-Version: 2.1\nName: {project}\nVersion: {version}\nSummary: {summary}\n".encode()
    )
    content[f"{name}.dist-info/WHEEL"] = (
        f"Wheel-Version: 1.0\nGenerator: interface_compiler\nRoot-Is-Purelib: false\nTag: {tag}\n".encode()
    )
    listing = f"{name}.dist-info/RECORD"
    content[listing] = record(content, listing)
    return f"{name}-{tag}.whl", zipped(content, last=listing)


def platform_tag(libraries: Iterable[bytes]) -> str:
    """Return the platform that these libraries need, such as `manylinux_2_28_x86_64` (PEP 600).

    They name the versions of glibc and of GCC's C++ library that they call.
    """
    content = b"\0".join(libraries)
    glibc = max([_OLDEST_GLIBC, *map(int, _GLIBC.findall(content))])
    cpp = max([0, *map(int, _GLIBCXX.findall(content))])
    newest = max(_CPP_LIBRARIES)
    glibc = max(glibc, next((system for system, number in _CPP_LIBRARIES.items() if cpp <= number), newest))
    return f"manylinux_2_{glibc}_{platform.machine()}"


def record(files: Mapping[str, bytes], listing: str) -> bytes:
    """Return the content of a wheel's RECORD, which is the file `listing` itself."""
    out = io.StringIO()
    writer = csv.writer(out, lineterminator="\n")
    for name in sorted(set(files) - {listing}):
        digest = base64.urlsafe_b64encode(hashlib.sha256(files[name]).digest()).rstrip(b"=").decode()
        writer.writerow((name, f"sha256={digest}", len(files[name])))
    writer.writerow((listing, "", ""))
    return out.getvalue().encode()


#: The earliest date that a zip can contain.
EARLIEST = (1980, 1, 1, 0, 0, 0)


def zipped(
    files: Mapping[str, bytes],
    last: str = "",
    date: tuple[int, ...] = EARLIEST,
    modes: Mapping[str, int] = MappingProxyType({}),
) -> bytes:
    """Return an archive of `files`, sorted by name; `last` names one that goes to the end.

    `date` is that of every file: year, month, day, hour, minute, second. `modes` are those of files that are not 0o644.
    """
    out = io.BytesIO()
    with zipfile.ZipFile(out, "w") as archive:
        for name in sorted(files, key=lambda name: (name == last, name)):
            entry = zipfile.ZipInfo(name, date)  # type: ignore[arg-type]
            entry.create_system = 3
            entry.compress_type = zipfile.ZIP_DEFLATED
            entry.external_attr = (stat.S_IFREG | modes.get(name, 0o644)) << 16
            archive.writestr(entry, files[name])
    return out.getvalue()
