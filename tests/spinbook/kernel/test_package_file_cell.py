"""`%%package_file`, and `%log --until`."""

from __future__ import annotations

from notebook_kernel import Kernel

SLOW = """import time

print("first", flush=True)
time.sleep(1)
print("second", flush=True)
time.sleep(60)
"""


def test_a_cell_puts_a_parameter_file_into_the_package(module_kernel: Kernel) -> None:
    shown = module_kernel.run("%%package_file config/arm.yaml\n/arm:\n  ros__parameters: {gain: 0.5}")

    assert shown.text == "Wrote robot_ws/src/robot/config/arm.yaml\n"
    folder = module_kernel.folder / "robot_ws/src/robot"
    assert (folder / "config/arm.yaml").read_text() == "/arm:\n  ros__parameters: {gain: 0.5}\n"
    assert "glob('config/*')" in (folder / "setup.py").read_text()


def test_a_node_that_is_run_later_leaves_the_files_where_they_are(module_kernel: Kernel) -> None:
    module_kernel.run("%%package_file config/leg.yaml\n/leg: {}")
    module_kernel.run("%%node tiny\nprint('done')")

    folder = module_kernel.folder / "robot_ws/src/robot"
    assert (folder / "config/leg.yaml").exists()
    assert "glob('config/*')" in (folder / "setup.py").read_text()


def test_any_other_path_is_refused(module_kernel: Kernel) -> None:
    for path in ("../../evil.yaml", "config/../x.yaml", "setup.py"):
        assert "is not a launch or parameter file" in module_kernel.run(f"%%package_file {path}\nx").error


def test_a_log_is_shown_once_it_holds_what_is_waited_for(module_kernel: Kernel) -> None:
    module_kernel.run(f"%%node slow --until first --seconds 60\n{SLOW}")

    assert module_kernel.run("%log slow --until second").text == "first\nsecond\n"
    assert "did not print 'third' within 0.2 s" in module_kernel.run("%log slow --until third --seconds 0.2").text
    module_kernel.run("%stop slow")
