"""What students hand in: a small right program for the exercise heartbeat, in pieces, in notebooks and in archives."""

from __future__ import annotations

import io
import json
import tarfile
import zipfile
from collections.abc import Mapping
from pathlib import Path
from typing import Any

IMPORTS = "import rclpy\nfrom rclpy.node import Node\nfrom std_msgs.msg import Header\n"
INIT = """\
class Heartbeat(Node):
    def __init__(self):
        super().__init__('heartbeat')
        self.publisher = self.create_publisher(Header, '/heartbeat', 10)
        self.timer = self.create_timer(0.25, self.beat)
"""
BEAT = """\
    def beat(self):
        message = Header(frame_id='torso')
        message.stamp = self.get_clock().now().to_msg()
        self.publisher.publish(message)
"""
CLASS = f"{INIT}\n{BEAT}"
MAIN = """\
def main():
    rclpy.init()
    try:
        rclpy.spin(Heartbeat())
    except (KeyboardInterrupt, rclpy.executors.ExternalShutdownException):
        pass
"""
GUARD = "if __name__ == '__main__':\n    main()\n"
PROGRAM = f"{IMPORTS}\n\n{CLASS}\n\n{MAIN}\n\n{GUARD}"
NODE = f"%%node heartbeat\n{PROGRAM}"
OLD = NODE.replace("0.25", "0.5")

EXERCISE = {"spinbook": {"exercise": "heartbeat"}}


def cell(source: str, metadata: Mapping[str, Any] | None = None, ran: int | None = None, outputs: Any = ()) -> Any:
    """Return a code cell as Jupyter saves it."""
    return {
        "cell_type": "code",
        "execution_count": ran,
        "metadata": dict(metadata or {}),
        "outputs": list(outputs),
        "source": source.splitlines(keepends=True),
    }


def notebook(*cells: Any, **metadata: Any) -> bytes:
    """Return a notebook's file; a cell is its source, or what `cell` returns."""
    whole = [cell(one) if isinstance(one, str) else one for one in cells]
    return json.dumps({"cells": whole, "metadata": metadata, "nbformat": 4, "nbformat_minor": 5}).encode()


def check_cell(digest: str, ran: int | None = None) -> Any:
    """Return a cell with a saved `%check`."""
    shown = {"text/plain": "Heartbeat: your cell"}
    output = {
        "output_type": "display_data",
        "data": shown,
        "metadata": {"spinbook": {"exercise": "heartbeat", "code": digest}},
    }
    return cell("%check heartbeat", ran=ran, outputs=[output])


def zipped(files: Mapping[str, str | bytes]) -> bytes:
    """Return a zip with these files."""
    out = io.BytesIO()
    with zipfile.ZipFile(out, "w", zipfile.ZIP_DEFLATED) as archive:
        for name, content in files.items():
            archive.writestr(name, content)
    return out.getvalue()


def tarred(files: Mapping[str, str | bytes], compression: str = "gz") -> bytes:
    """Return a compressed tar with these files."""
    out = io.BytesIO()
    with tarfile.open(fileobj=out, mode=f"w:{compression}") as archive:  # type: ignore[call-overload]
        for name, content in files.items():
            data = content if isinstance(content, bytes) else content.encode()
            entry = tarfile.TarInfo(name)
            entry.size = len(data)
            archive.addfile(entry, io.BytesIO(data))
    return out.getvalue()


def written(folder: Path, files: Mapping[str, str | bytes]) -> Path:
    """Write these files into a folder, and return it."""
    for name, content in files.items():
        path = folder / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_bytes(content if isinstance(content, bytes) else content.encode())
    return folder
