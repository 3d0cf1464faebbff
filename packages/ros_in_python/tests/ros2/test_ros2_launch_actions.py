"""`ros2 launch` runs what is more than nodes: other files and programs, functions, times, events and expressions."""

from __future__ import annotations

import re
from pathlib import Path

import pytest
from ros2_terminal import Answer, Terminal

HEAD = """\
import os
from launch import LaunchDescription
from launch.actions import *
from launch.conditions import *
from launch.event_handlers import *
from launch.events import Shutdown as ShutdownEvent
from launch.launch_description_sources import PythonLaunchDescriptionSource
from launch.substitutions import *
from launch_ros.actions import *
from launch_ros.parameter_descriptions import ParameterFile
from launch_ros.substitutions import FindPackageShare

def say(text, **more):
    return ExecuteProcess(cmd=["echo", text], **more)

def generate_launch_description():
"""


@pytest.fixture(autouse=True)
def _not_sourced(monkeypatch: pytest.MonkeyPatch) -> None:
    for name in ("AMENT_PREFIX_PATH", "PYTHONPATH", "GREETING"):
        monkeypatch.delenv(name, raising=False)


def launched(terminal: Terminal, folder: Path, body: str, *words: str) -> Answer:
    """Launch a file whose function has this body, and return what the command says, without process numbers."""
    lines = "".join(f"    {line}\n" for line in body.strip().splitlines())
    (folder / "a.launch.py").write_text(HEAD + lines)
    return terminal.ros2("launch", "a.launch.py", *words, cwd=folder)


def said(answer: Answer) -> list[str]:
    """What the launch's log and its programs say, without the starts and ends of processes."""
    lines = [line for line in answer.out.splitlines() if "process started" not in line and "cleanly" not in line]
    return [line.removeprefix("[INFO] [launch.user]: ") for line in lines]


def test_a_program_runs_with_its_words_its_folder_and_its_environment(terminal: Terminal, tmp_path: Path) -> None:
    answer = launched(terminal, tmp_path, """
return LaunchDescription([
    SetEnvironmentVariable("GREETING", "hello"), AppendEnvironmentVariable("GREETING", "world", separator=" "),
    ExecuteProcess(
        cmd=["echo $GREETING $PWD $NAME"], shell=True, cwd="/tmp", additional_env={"NAME": "me"}, name="shell"),
    GroupAction([UnsetEnvironmentVariable("GREETING")]),
    RegisterEventHandler(OnShutdown(on_shutdown=[LogInfo(msg=LocalSubstitution("event.reason"))])),
    LogInfo(msg=["env: ", EnvironmentVariable("GREETING")]),
])""")  # fmt: skip
    assert (answer.code, answer.err) == (0, "")
    assert sorted(said(answer)[:2]) == ["[shell-1] hello world /tmp me", "env: hello world"]
    assert said(answer)[2:] == ["idle"]


def test_an_included_file_gets_arguments_and_knows_where_it_is(terminal: Terminal, tmp_path: Path) -> None:
    inner = HEAD + (
        "    return LaunchDescription([DeclareLaunchArgument('who', default_value='nobody'),\n"
        "        LogInfo(msg=['inner ', LaunchConfiguration('who'), ' ', ThisLaunchFileDir()])])\n"
    )
    (tmp_path / "sub").mkdir()
    (tmp_path / "sub" / "inner.launch.py").write_text(inner)
    (tmp_path / "sub" / "inner.launch.yaml").write_text(
        "launch:\n- arg: {name: who}\n- log: {message: yaml $(var who) $(dirname)}\n"
    )
    answer = launched(terminal, tmp_path, """
here = os.path.dirname(__file__)
return LaunchDescription([
    IncludeLaunchDescription(
        PythonLaunchDescriptionSource([here, "/sub/inner.launch.py"]), launch_arguments={"who": "me"}.items()),
    GroupAction([IncludeLaunchDescription("sub/inner.launch.yaml", launch_arguments=[("who", "you")])]),
    LogInfo(msg=["outer ", LaunchConfiguration("who"), " ", ThisLaunchFileDir()]),
])""")  # fmt: skip
    assert (answer.code, answer.err) == (0, "")
    assert said(answer) == [f"inner me {tmp_path}/sub", f"yaml you {tmp_path}/sub", f"outer me {tmp_path}"]


def test_a_file_that_includes_itself_is_an_error(terminal: Terminal, tmp_path: Path) -> None:
    answer = launched(terminal, tmp_path, "return LaunchDescription([IncludeLaunchDescription('a.launch.py')])")
    assert answer.code == 1
    assert "does it include itself?" in answer.err


def test_a_function_sees_the_arguments_and_gives_more_actions(terminal: Terminal, tmp_path: Path) -> None:
    answer = launched(terminal, tmp_path, """
def more(context, *, prefix):
    count = int(LaunchConfiguration("count").perform(context))
    return [LogInfo(msg=f"{prefix} {number}") for number in range(count)]
return LaunchDescription([
    DeclareLaunchArgument("count"), OpaqueFunction(function=more, kwargs={"prefix": "number"}),
])""", "count:=2")  # fmt: skip
    assert said(answer) == ["number 0", "number 1"]


def test_a_function_that_fails_is_named(terminal: Terminal, tmp_path: Path) -> None:
    answer = launched(terminal, tmp_path, "return LaunchDescription([OpaqueFunction(function=lambda context: 1 / 0)])")
    assert answer.code == 1
    assert "OpaqueFunction fails: ZeroDivisionError" in answer.err


def test_expressions_commands_and_conditions(terminal: Terminal, tmp_path: Path) -> None:
    answer = launched(terminal, tmp_path, """
n = LaunchConfiguration("n")
return LaunchDescription([
    DeclareLaunchArgument("n", default_value="3"), SetLaunchConfiguration("m", [n, "0"]),
    LogInfo(msg=[PythonExpression(["1 + ", n]), " ", PythonExpression(["round(pi)"]), " ", LaunchConfiguration("m")]),
    LogInfo(msg=["printed ", Command(["echo ", n])]),
    LogInfo(msg="equal", condition=IfCondition(EqualsSubstitution(n, "3.0"))),
    LogInfo(msg="not", condition=UnlessCondition(AndSubstitution(EqualsSubstitution(n, 3), "true"))),
    LogInfo(msg="legacy", condition=LaunchConfigurationEquals("n", "3")),
])""")  # fmt: skip
    assert said(answer) == ["4 3 30", "printed 3", "", "equal", "legacy"]


def test_a_handler_that_fails_ends_the_launch_and_is_named(terminal: Terminal, tmp_path: Path) -> None:
    answer = launched(terminal, tmp_path, """
first, second = say("first"), say("second")
return LaunchDescription([
    RegisterEventHandler(OnProcessExit(target_action=first, on_exit=[second])),
    RegisterEventHandler(OnProcessExit(target_action=second, on_exit=lambda event, context: LogInfo(
        msg=f"{event.process_name} ended with {event.returncode}"))),
    RegisterEventHandler(OnProcessStart(target_action=first, on_start=[LogInfo(msg="started")])),
    RegisterEventHandler(OnProcessIO(target_action=first, on_stdout=lambda event, context: LogInfo(msg="never"))),
    TimerAction(period=0.3, actions=[first]),
])""")  # fmt: skip
    assert answer.code == 1
    assert "the handler of ProcessIO fails: TypeError" in answer.err
    assert {"started", "[echo-1] first"} <= set(said(answer))


def test_output_ends_and_functions_are_handled(terminal: Terminal, tmp_path: Path) -> None:
    answer = launched(terminal, tmp_path, """
first, second = say("first"), say("second", on_exit=[LogInfo(msg="after second")])
return LaunchDescription([
    RegisterEventHandler(OnProcessExit(target_action=first, on_exit=[second])),
    RegisterEventHandler(OnProcessExit(target_action=second, on_exit=lambda event, context: LogInfo(
        msg=f"{event.process_name} ended with {event.returncode}"))),
    RegisterEventHandler(OnProcessIO(target_action=first, on_stdout=lambda event: LogInfo(
        msg="heard " + event.text.decode().strip()))),
    TimerAction(period=0.1, actions=[first]),
])""")  # fmt: skip
    assert (answer.code, answer.err) == (0, "")
    assert said(answer) == ["[echo-1] first", "heard first", "[echo-2] second", "echo-2 ended with 0", "after second"]


def test_a_handler_hears_of_a_program_that_stands_before_it(terminal: Terminal, tmp_path: Path) -> None:
    answer = launched(terminal, tmp_path, """
first = ExecuteProcess(cmd=["printf", "1\\n2\\n3\\n"])
return LaunchDescription([
    first,
    RegisterEventHandler(OnProcessStart(target_action=first, on_start=[LogInfo(msg="started")])),
    RegisterEventHandler(OnProcessIO(target_action=first, on_stdout=lambda event: LogInfo(
        msg="heard " + event.text.decode().strip()))),
    RegisterEventHandler(OnProcessExit(target_action=first, on_exit=[LogInfo(msg="ended")])),
])""")  # fmt: skip
    assert (answer.code, answer.err) == (0, "")
    told = [line for line in said(answer) if not line.startswith("[printf-1]")]
    assert told == ["started", "heard 1", "heard 2", "heard 3", "ended"]


@pytest.mark.parametrize("end", ["Shutdown(reason='done')", "EmitEvent(event=ShutdownEvent(reason='done'))"])
def test_a_launch_can_end_itself_and_tells_who_listens(terminal: Terminal, tmp_path: Path, end: str) -> None:
    answer = launched(terminal, tmp_path, f"""
return LaunchDescription([
    RegisterEventHandler(OnShutdown(on_shutdown=lambda event, context: [LogInfo(msg="ends: " + event.reason)])),
    ExecuteProcess(cmd=["sleep", "1000"]),
    say("x", on_exit={end}),
])""")  # fmt: skip
    assert answer.code == 0
    assert "ends: done" in said(answer)
    assert "[INFO] [launch]: process[echo-2] was required: shutting down launched system" in answer.out
    assert "[INFO] [sleep-1]: sending signal 'SIGINT' to process[sleep-1]" in answer.out
    assert "[ERROR] [sleep-1]: process has died" in answer.out


def test_a_program_that_dies_is_started_again(terminal: Terminal, tmp_path: Path) -> None:
    answer = launched(terminal, tmp_path, """
count = os.path.join(os.path.dirname(__file__), "count")
return LaunchDescription([
    ExecuteProcess(
        cmd=[f"echo again >> {count}; test $(wc -l < {count}) -lt 3"], shell=True, respawn=True, respawn_delay=0.1,
        on_exit=lambda event, context: Shutdown() if event.returncode else None),
])""")  # fmt: skip
    assert (tmp_path / "count").read_text() == "again\n" * 3
    assert answer.out.count("[echo-1]: process started") == 3


def test_a_group_can_forget_what_holds_outside(terminal: Terminal, tmp_path: Path) -> None:
    answer = launched(terminal, tmp_path, """
show = LogInfo(msg=[LaunchConfiguration("a", default="-"), LaunchConfiguration("b", default="-"),
    EnvironmentVariable("GREETING", default_value="-")])
return LaunchDescription([
    SetEnvironmentVariable("GREETING", "hello"), SetLaunchConfiguration("a", "1"), SetLaunchConfiguration("b", "2"),
    GroupAction([show], forwarding=False, launch_configurations={"b": [LaunchConfiguration("b"), "3"]}),
    PushLaunchConfigurations(), PushEnvironment(), ResetLaunchConfigurations(), ResetEnvironment(), show,
    PopEnvironment(), PopLaunchConfigurations(), UnsetLaunchConfiguration("a"), show,
])""")  # fmt: skip
    assert said(answer) == ["-23-", "---", "-2hello"]


def test_what_waits_is_worked_out_when_its_time_has_come(terminal: Terminal, tmp_path: Path) -> None:
    answer = launched(terminal, tmp_path, """
def now(context):
    return [LogInfo(msg="second")]
first = say("x")
return LaunchDescription([
    TimerAction(period=0.1, actions=[OpaqueFunction(function=now), first]), LogInfo(msg="first"),
    RegisterEventHandler(OnProcessExit(on_exit=[Shutdown(reason="enough")], target_action=first, handle_once=True)),
    RegisterEventHandler(OnShutdown(on_shutdown=[LogInfo(msg=LocalSubstitution("event.reason"))])),
    TimerAction(period=0.3, actions=[LogInfo(msg="after all")], cancel_on_shutdown=False),
    TimerAction(period=0.3, actions=[LogInfo(msg="never")]),
])""")  # fmt: skip
    end = "[INFO] [launch]: process[echo-1] was required: shutting down launched system"
    assert said(answer) == ["first", "second", "[echo-1] x", end, "enough", "after all"]


def test_a_program_gets_its_signals_and_its_own_line_format(terminal: Terminal, tmp_path: Path) -> None:
    answer = launched(terminal, tmp_path, """
from launch.events import matches_action as only
from launch.events.process import ShutdownProcess, SignalProcess
stubborn = ExecuteProcess(cmd=["trap 'echo heard' INT; echo up; echo err >&2; while :; do sleep 0.05; done"],
    shell=True, name="stubborn", output_format="{this.process_description.final_name}> {line}", sigterm_timeout="0.2")
return LaunchDescription([
    stubborn,
    RegisterEventHandler(OnProcessIO(
        on_stdout=lambda event: EmitEvent(event=SignalProcess(signal_number="SIGINT", process_matcher=only(stubborn)))
        if b"up" in event.text else EmitEvent(event=ShutdownProcess(process_matcher=only(stubborn))),
        on_stderr=lambda event: LogInfo(msg=f"other: {event.text.decode().strip()}"))),
])""")  # fmt: skip
    assert answer.code == 0
    assert "stubborn-1> up" in said(answer)
    assert "other: err" in said(answer)
    assert "exit code -15" in answer.out


def test_parameters_names_and_remappings_for_all_that_follow(terminal: Terminal, tmp_path: Path) -> None:
    (tmp_path / "show.sh").write_text("""#!/bin/sh
echo "$@"
for word in "$@"; do case "$word" in *.yaml) cat "$word" ;; esac; done
""")
    (tmp_path / "show.sh").chmod(0o755)
    (tmp_path / "p.yaml").write_text("/**: {ros__parameters: {gain: $(var gain)}}\n")
    answer = launched(terminal, tmp_path, """
show = os.path.join(os.path.dirname(__file__), "show.sh")
return LaunchDescription([
    DeclareLaunchArgument("gain", default_value="2.5"),
    SetParameter("use_sim_time", True), SetRemap("chatter", "gossip"),
    Node(executable=show, name="one", parameters=[ParameterFile("p.yaml", allow_substs=True), {"a": {"b": 1}}]),
])""")  # fmt: skip
    assert answer.code == 0
    text = re.sub(r"/\S+launch_params_", "", "\n".join(said(answer)))
    assert "-r __node:=one --params-file 1.yaml --params-file 2.yaml --params-file 3.yaml -r chatter:=gossip" in text
    assert "use_sim_time: true" in text
    assert "gain: 2.5" in text
    assert "b: 1" in text


XML = """<launch>
  <arg name="who" default="world"/>
  <let name="greeting" value="hello $(var who)"/>
  <set_env name="GREETING" value="$(var greeting)"/>
  <log message="$(eval '1 + 2') $(env GREETING) $(equals $(var who) world)"/>
  <timer period="0.1"><executable cmd="echo $(env GREETING) late"/></timer>
  <group><include file="$(dirname)/inner.launch.xml"><arg name="who" value="you"/></include></group>
  <log message="$(var who)" unless="$(not true)"/>
</launch>
"""
YAML = """launch:
- arg: {name: who, default: world}
- let: {name: greeting, value: hello $(var who)}
- set_env: {name: GREETING, value: $(var greeting)}
- log: {message: "$(eval '1 + 2') $(env GREETING) $(equals $(var who) world)"}
- timer:
    period: 0.1
    children:
    - executable: {cmd: echo $(env GREETING) late}
- group:
  - include:
      file: $(dirname)/inner.launch.xml
      arg:
      - {name: who, value: you}
- log: {message: $(var who), unless: $(not true)}
"""


@pytest.mark.parametrize(("name", "text"), [("a.launch.xml", XML), ("a.launch.yaml", YAML)])
def test_xml_and_yaml_know_the_same(terminal: Terminal, tmp_path: Path, name: str, text: str) -> None:
    (tmp_path / name).write_text(text)
    (tmp_path / "inner.launch.xml").write_text('<launch><arg name="who"/><log message="inner $(var who)"/></launch>')
    answer = terminal.ros2("launch", name, cwd=tmp_path)
    assert (answer.code, answer.err) == (0, "")
    assert said(answer) == ["3 hello world true", "inner you", "world", "[echo-1] hello world late"]


def test_the_share_folder_of_an_installed_package_is_found(terminal: Terminal, tmp_path: Path) -> None:
    answer = launched(terminal, tmp_path, """
from ament_index_python.packages import get_package_share_directory
return LaunchDescription([LogInfo(msg=get_package_share_directory("std_msgs"))])""")  # fmt: skip
    assert Path(said(answer)[0]).is_dir()
