"""The ROS environment of rigs and of students: one host, quick discovery, output that is the same each time."""

from __future__ import annotations

from pathlib import Path

PROFILE = Path(__file__).parents[1] / "loopback.xml"

#: For every process that takes part in a spin over Fast DDS. The ROS domain comes on top.
FAST_DDS = {
    "FASTRTPS_DEFAULT_PROFILES_FILE": str(PROFILE),
    "ROS_AUTOMATIC_DISCOVERY_RANGE": "SYSTEM_DEFAULT",
}

#: For the worker and its rigs. A second RMW or a ROS_STATIC_PEERS of the user's would part rig and student.
OURS = {
    **FAST_DDS,
    "RMW_IMPLEMENTATION": "rmw_fastrtps_cpp",
    "ROS_STATIC_PEERS": "",
    "PYTHONHASHSEED": "0",
    "OPENBLAS_NUM_THREADS": "1",
}

#: For students' programs. No time stamps in the log, so that two runs log the same.
STUDENTS = {
    "RCUTILS_CONSOLE_OUTPUT_FORMAT": "[{severity}] [{name}]: {message}",
    "RCUTILS_COLORIZED_OUTPUT": "0",
}
