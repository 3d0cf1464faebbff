"""Runs code as a page's processes do, over rcl_python and in one interpreter.

Reads a JSON list of pairs from its input, "program" or "cell" and the code, and prints what each has printed, as a JSON
list. Before each, the page's own code imports modules of ROS. When the code calls `page_imports(NAME)`, it is the turn
of the page's own code, which imports one more.
"""

import builtins
import contextlib
import importlib
import io
import json
import sys

import rcl_python
from spinbook.browser.in_page import cells, process, program_imports

rcl_python.install()
program_imports.watch()
process.import_rclpy()


def page_imports(name: str) -> None:
    """Import a module as the grader's runner does when the program waits."""
    program_imports.turn_to_page()
    importlib.import_module(name)
    program_imports.turn_to_program()


vars(builtins)["page_imports"] = page_imports


def printed(kind: str, code: str) -> str:
    """What the code prints."""
    for own in ("rclpy.action", "sensor_msgs.msg", "std_srvs.srv"):
        importlib.import_module(own)
    output = io.StringIO()
    with contextlib.redirect_stdout(output), contextlib.redirect_stderr(output):
        if kind == "program":
            process.run_program(code, "program.py", [], {})
        else:
            cells.run_python(code)
    return output.getvalue()


print(json.dumps([printed(kind, code) for kind, code in json.load(sys.stdin)]))
