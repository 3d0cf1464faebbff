"""A node may be shown in pieces: its cell runs the whole, with the current content of the cells above."""

from __future__ import annotations

import re

from notebook_kernel import Kernel

CLASS = """class Talker(Node):
    def __init__(self):
        super().__init__("talker")
        self.get_logger().info("I am " + NAME)
"""
MAIN = "def main(args=None):\n    rclpy.init(args=args)\n    rclpy.spin(Talker())\n"


def test_a_node_is_made_whole_of_the_parts_above_as_they_are_now(kernel: Kernel) -> None:
    assert "kept for the nodes below" in kernel.run(f"%%part talker --keep\n{CLASS}").text
    assert kernel.run("%%part name\nNAME = 'Ada'\nprint(NAME)").text == "Ada\n"
    shown = kernel.run(f"%%node main --seconds 60 --until Ada --main --after talker name\n{MAIN}")
    assert "[INFO] [talker]: I am Ada" in shown.text

    kernel.run("%%part name\nNAME = 'Grace'")
    shown = kernel.run(f"%%node main --seconds 60 --until Grace --main --after talker name\n{MAIN}")

    assert "[INFO] [talker]: I am Grace" in shown.text


def test_a_traceback_counts_lines_as_the_cells_do(kernel: Kernel) -> None:
    kernel.run(f"%%part talker --keep\n{CLASS}")

    shown = kernel.run(f"%%node main --main --after talker\n{MAIN}")

    assert re.search(r'main.py", line \d+ above its cell, in __init__\n.*NAME', shown.text)
    assert 'main.py", line 4, in main\n    rclpy.spin(Talker())' in shown.text


def test_a_part_that_is_missing_is_named(kernel: Kernel) -> None:
    shown = kernel.run(f"%%node main --main --after nowhere\n{MAIN}")

    assert "uses what `nowhere` defines: run its cell above first" in shown.error


def test_two_classes_without_a_main_run_in_one_process_with_the_usual_imports(kernel: Kernel) -> None:
    both = CLASS.replace("NAME", "'one'") + "\n\n" + CLASS.replace("Talker", "Other").replace('"talker"', '"other"')

    shown = kernel.run(
        "%%node both --seconds 60 --until two --class Talker --class Other --usual-imports\n"
        + both.replace("NAME", "'two'")
    )

    assert "[talker]: I am one" in shown.text
    assert "[other]: I am two" in shown.text
    assert kernel.run("%stop both").text == "both stopped.\n"


def test_a_newer_version_of_a_class_runs_with_the_main_of_the_one_above_again_and_again(kernel: Kernel) -> None:
    first = CLASS.replace("NAME", "'old'") + MAIN
    kernel.run(f"%%node speaker --seconds 60 --until I --main --usual-imports\n{first}")
    newer = "%%node speaker --seconds 60 --until I --main --after speaker\n" + CLASS.replace("NAME", "'new'")

    shown, again = kernel.run(newer), kernel.run(newer)

    started = "(runs with the `main` of the version above)\n(restarting speaker"
    assert shown.text.startswith(f"{started} with its new version)\n")
    assert again.text.startswith(f"{started})\n")
    assert "I am new" in shown.text
    assert "I am new" in again.text
    newest = kernel.run(newer.replace("'new'", "'newest'"))
    assert newest.text.startswith(f"{started} with its new version)\n")
    assert "(restarting speaker)\n" in kernel.run("%ros2 --until newest run robot speaker").text


def test_a_newer_version_in_another_file_replaces_the_earlier_one(kernel: Kernel) -> None:
    code = CLASS.replace("NAME", "'here'") + MAIN
    kernel.run(f"%%node speaker --seconds 60 --until I --main --usual-imports\n{code}")

    shown = kernel.run(f"%%node louder --seconds 60 --until I --main --usual-imports --replaces speaker\n{code}")

    assert shown.text.startswith("(replaces speaker, the earlier version of this node)\n")
    assert kernel.run("%nodes").text.split()[0] == "louder"


def test_ros2_run_starts_the_node_by_the_name_that_its_package_gives_it(kernel: Kernel) -> None:
    code = CLASS.replace("NAME", "str(sys.argv[1:2])") + MAIN
    options = "--seconds 60 --until I --main --usual-imports --as arm/hand"
    create = "%ros2 pkg create --build-type ament_python --node-name wave arm"
    assert kernel.run(create).text.startswith("Created the package arm")
    assert "Hi from arm." in kernel.run("%ros2 run arm wave").text
    kernel.run(f"%%node gripper {options}\n{code}")

    shown = kernel.run("%ros2 --seconds 60 --until left run arm hand left")

    assert "(restarting gripper)" in shown.text
    assert "I am ['left']" in shown.text
    setup = (kernel.folder / "robot_ws/src/arm/setup.py").read_text()
    assert "'hand = arm.gripper:main'" in setup


def test_nodes_of_a_package_import_each_other_by_its_name(kernel: Kernel) -> None:
    kernel.run("%%node names --as arm/names\nNAME = 'Emmy'\n")

    code = "from arm.names import NAME\nprint('I am ' + NAME)\n"
    shown = kernel.run(f"%%node other --as arm/other\n{code}")

    assert "I am Emmy" in shown.text


def test_an_endless_loop_is_a_process_that_the_kernel_does_not_wait_for(kernel: Kernel) -> None:
    shown = kernel.run(
        "%%node endless --seconds 60 --until on\nimport time\nwhile True:\n    print('on')\n    time.sleep(1)\n"
    )

    assert "endless continues in the background" in shown.text
    assert "did not come" not in shown.text


WORDS = "import sys\nprint(int(sys.argv[1]) + int(sys.argv[2]))\n"


def test_a_node_that_is_kept_is_started_by_ros2_run_with_its_words(kernel: Kernel) -> None:
    assert "saved, not started" in kernel.run(f"%%node adder --keep --as sums/add\n{WORDS}").text

    assert kernel.run("%ros2 run sums add 2 3").text.startswith("5\n")


def test_a_program_of_an_earlier_chapter_is_saved_for_ros2_run(kernel: Kernel) -> None:
    saved = kernel.run("%%node greeter --of one --as robot/greeter\nprint('from chapter one')\n")

    assert saved.text == "— saved: `ros2 run` starts this program of the chapter one —\n"
    assert "from chapter one" in kernel.run("%ros2 run robot greeter").text


def test_a_node_of_the_course_s_package_runs_by_name_before_it_is_built(kernel: Kernel) -> None:
    kernel.run("%%node greeting\nimport time\nprint('hello')\ntime.sleep(60)\n")

    run = "%ros2 --until hello run robot greeting"
    twice, again = kernel.run(f"{run}\n{run}").text, kernel.run(run).text

    assert "greeting continues in the background" in twice
    assert "greeting_2 continues in the background" in twice
    assert "(restarting greeting)\n" in again


def test_the_method_of_a_class_that_spins_is_called_and_its_answer_printed(kernel: Kernel) -> None:
    method = "    def ask(self):\n        rclpy.spin_once(self, timeout_sec=0.1)\n        return 'enough'\n"
    code = CLASS.replace("NAME", "'here'") + method

    shown = kernel.run(f"%%node asker --seconds 60 --class Talker.ask --usual-imports\n{code}")
    kept = kernel.run(f"%%node kept --keep --class Talker.ask --usual-imports\n{code}")

    assert "ask() returned 'enough'\n" in shown.text
    assert "asker has ended (exit code 0)" in shown.text
    assert kept.text == "— saved, not started: nothing here calls Talker.ask, which spins —\n"
