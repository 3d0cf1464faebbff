"""What a launch file means is what it means in ROS 2: checked against https://github.com/ros2/launch and launch_ros."""

from __future__ import annotations

import re
from pathlib import Path

import pytest
import yaml
from click.testing import CliRunner, Result

from ros_in_python.launch.command import launch

HEAD = """\
import os
from launch import *
from launch.actions import *
from launch.conditions import *
from launch.substitutions import *
from launch_ros.actions import *
from launch_ros.descriptions import *

a = LaunchConfiguration("a", default="1")

def say(*texts, **more):
    return LogInfo(msg=list(texts), **more)

def generate_launch_description():
    return LaunchDescription([
"""
#: Prints its words, and the parameter files among them.
SHOW = """#!/bin/sh
echo "$@"
for word in "$@"; do case "$word" in *.yaml) cat "$word" ;; esac; done
"""


@pytest.fixture(autouse=True)
def _folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (tmp_path / "show.sh").write_text(SHOW)
    (tmp_path / "show.sh").chmod(0o755)
    monkeypatch.chdir(tmp_path)


def launched(entities: str, *words: str, name: str = "a.launch.py") -> Result:
    """Launch a file in this process; a Python one describes these entities."""
    Path(name).write_text(f"{HEAD}{entities}])\n" if name.endswith(".py") else entities)
    return CliRunner().invoke(launch, [*(word for word in words if word.startswith("-")), name, *words[-1:]])


def said(answer: Result) -> list[str]:
    """What the launch logs for its file."""
    assert answer.exit_code == 0, answer.output
    return re.findall(r"^\[INFO\] \[launch\.user\]: (.*)$", answer.output, re.MULTILINE)


def shown(answer: Result) -> list[str]:
    """What the programs print, without the names before their lines."""
    assert answer.exit_code == 0, answer.output
    return re.findall(r"^\[show\.sh-\d+\] (.*)$", answer.output, re.MULTILINE)


def parameters(answer: Result) -> list[dict[str, dict[str, object]]]:
    """The parameter files of the programs, in order: nodes with their parameters."""
    text = "\n".join(line for line in shown(answer) if "--ros-args" not in line)
    tables = [yaml.safe_load(part) for part in re.split(r"^(?=\S+:$)", text, flags=re.MULTILINE) if part]
    return [{node: table["ros__parameters"] for node, table in of.items()} for of in tables]


@pytest.mark.parametrize(
    ("left", "right", "is_equal"),
    [
        ("'True'", "'1'", True),
        ("'1'", "'1.0'", True),
        ("'0.1'", "'0.1000000000001'", True),
        ("' true'", "'true'", False),
        ("'x'", "'X'", False),
        ("None", "''", True),
        ("3", "'3'", True),
    ],
)
def test_two_texts_are_equal_if_they_mean_the_same(left: str, right: str, is_equal: bool) -> None:
    answer = launched(f"say(EqualsSubstitution({left}, {right}), ' ', NotEqualsSubstitution({left}, {right}))")
    assert said(answer) == [f"{is_equal} {not is_equal}".lower()]


def test_the_older_condition_compares_texts_as_they_are() -> None:
    conditions = [("a", "'true'"), ("a", "'True'"), ("nope", "None"), ("a", "None")]
    entities = ",".join(f"say('{at}', condition=LaunchConfigurationEquals('{name}', {value}))"
                        for at, (name, value) in enumerate(conditions))  # fmt: skip
    assert said(launched(f"SetLaunchConfiguration('a', 'True'), {entities}")) == ["1", "2"]


def test_parameters_are_for_one_node_only_if_the_file_gives_name_and_namespace() -> None:
    answer = launched("""
        SetParameter('rate', 5),
        Node(executable='./show.sh', name='left', parameters=[{'gain': 1}]),
        Node(executable='./show.sh', name='left', namespace='', parameters=[{'gain': 2}]),
        Node(executable='./show.sh', name='left', namespace='robot', parameters=[{'gain': 3}, Parameter('mode', 'x')]),
    """)
    tables = parameters(answer)
    keys = sorted((str(next(iter(table.values()))), next(iter(table))) for table in tables)
    assert keys == [
        ("{'gain': 1}", "/**"),
        ("{'gain': 2}", "/left"),
        ("{'gain': 3}", "/robot/left"),
        ("{'mode': 'x'}", "/**"),
        *[("{'rate': 5}", "/**")] * 3,
    ]
    assert "-r __ns:=/ " in "\n".join(shown(answer))


def test_values_of_parameters_are_read_as_yaml_where_a_substitution_makes_them() -> None:
    entities = """Node(executable='./show.sh', parameters=[{
        'number': a, 'text': '1', 'joined': [a, '0'], 'row': [[a], [a, '1']],
        'empty': LaunchConfiguration('b', default=''), 'mixed': [1, 2.5], 'a': {'b': {'c': a}},
        'typed': ParameterValue(a, value_type=str)}])"""
    values = {"number": 1, "text": "1", "joined": 10, "row": [1, 11], "empty": "", "mixed": [1.0, 2.5]}
    values |= {"a": {"b": {"c": 1}}, "typed": "1"}
    assert parameters(launched(entities)) == [{"/**": values}]


def test_a_description_that_is_no_value_of_a_parameter_is_refused_with_the_remedy() -> None:
    answer = launched("Node(executable='./show.sh', parameters=[{'robot_description': Command(['echo \"x: y: z\"'])}])")
    assert (answer.exit_code, "a.launch.py:16: 'x: y: z" in answer.output) == (1, True), answer.output
    assert "ParameterValue(…, value_type=str)" in answer.output


def test_functions_find_the_environment_that_the_file_has_set_and_can_change_it() -> None:
    entities = """SetEnvironmentVariable('GREETING', 'hello'),
        OpaqueFunction(function=lambda context: [say(os.environ['GREETING'])]),
        OpaqueFunction(function=lambda context: os.environ.update(GREETING='bye')),
        say(EnvironmentVariable('GREETING')),
        GroupAction([OpaqueFunction(function=lambda context: os.environ.update(GREETING='inside'))]),
        say(EnvironmentVariable('GREETING')),
        OpaqueFunction(function=lambda context: [__import__('launch').actions.LogInfo(msg='imported later')])"""
    assert said(launched(entities)) == ["hello", "bye", "bye", "imported later"]


def test_an_argument_counts_if_it_is_declared_in_an_included_file_or_asked_for_anywhere() -> None:
    Path("b.launch.xml").write_text('<launch><arg name="b" default="2"/><log message="$(var b)"/></launch>')
    include = "IncludeLaunchDescription([ThisLaunchFileDir(), '/b.launch.xml']), say(a)"
    assert said(launched(include, "b:=3")) == ["3", "1"]
    assert said(launched(include, "a:=4")) == ["2", "4"]
    assert "the launch file has no argument 'c'. It has: b." in launched(include, "c:=1").output
    assert "'b':" in launched(include, "--show-args").output


@pytest.mark.parametrize(
    ("condition", "problem"),
    [
        ("IfCondition('perhaps')", "a condition must be true, false, 1 or 0, and not 'perhaps'"),
        ("Condition(predicate=lambda context: {}['odd'])", "KeyError: 'odd'"),
    ],
)
def test_what_fails_within_a_file_is_named_with_its_file_and_line(condition: str, problem: str) -> None:
    answer = launched(f"say('x'),\nGroupAction([LogInfo(msg='y', condition={condition})])")
    assert answer.output == f"a.launch.py:17: {problem}\n"


COMPOSED = """
    ComposableNodeContainer(package='c', executable='d', name='e', namespace='', composable_node_descriptions=[
        ComposableNode(package='p', plugin='p::Eye'),
        ComposableNode(package='p', plugin='p::Ear', condition=IfCondition('0')),
    ]),
    LoadComposableNodes(target_container='e', composable_node_descriptions=[
        ComposableNode(package='p', plugin='p::Nose')]),
    say('the rest')"""
COMPOSED_XML = """<launch>
  <node_container pkg="c" exec="d" name="e" namespace=""><composable_node pkg="p" plugin="p::Eye" name="eye">
    <param name="x" value="1"/><remap from="a" to="b"/><extra_arg name="y" value="2"/></composable_node>
    <composable_node pkg="p" plugin="p::Ear" name="ear" if="0"/></node_container>
  <load_composable_node target="e"><composable_node pkg="p" plugin="p::Nose" name="nose"/></load_composable_node>
  <log message="the rest"/>
</launch>"""


@pytest.mark.parametrize(("name", "text"), [("a.launch.py", COMPOSED), ("a.launch.xml", COMPOSED_XML)])
def test_composable_nodes_are_refused_by_name_and_left_out_if_the_user_asks_for_that(name: str, text: str) -> None:
    refused = launched(text, name=name)
    assert (refused.exit_code, "composable nodes (p::Eye) are C++ libraries" in refused.output) == (1, True)
    left_out = "left out, as composable nodes need a ROS installation: "
    rest = [f"{left_out}p::Eye", f"{left_out}p::Nose", "the rest"]
    assert said(launched(text, "--without-composable-nodes", name=name)) == rest


def test_words_of_commands_are_split_as_a_shell_splits_them() -> None:
    xml = """<launch><arg name="a" default="3 4"/>
      <log message="$(eval '\\'$(var a)\\' == \\'3 4\\'') \\$(var a)"/>
      <executable cmd="./show.sh 'x y' $(var a) b$(var a)c &quot;d e&quot;" name="show.sh" launch-prefix="env"/>
    </launch>"""
    answer = launched(xml, name="a.launch.xml")
    assert said(answer) == ["True $(var a)"]
    assert shown(answer) == ["x y 3 4 b3 4c d e"]
    assert said(launched("say(Command(['echo ', '\"x  y\"; z']))"))[0] == "x  y; z"


@pytest.mark.parametrize(
    ("attributes", "problem"),
    [
        (
            """cmd="echo 'to $(var a)'" """,
            "`echo 'to $(var a)'`: No closing quotation. As in ROS 2, quotes have no `$(…)` in them.",
        ),
        ('cmd="true" respawn_delay="soon"', "`executable`: could not convert string to float: 'soon'."),
    ],
)
def test_an_attribute_that_can_not_be_read_is_named(attributes: str, problem: str) -> None:
    answer = launched(f"<launch><executable {attributes}/></launch>", name="a.launch.xml")
    assert (answer.exit_code, answer.output.strip().endswith(f"a.launch.xml: {problem}")) == (1, True), answer.output


def test_a_prefix_for_programs_may_have_none_to_stand_before() -> None:
    assert said(launched("say('hi')", "--launch-prefix=nice")) == ["hi"]


def test_texts_of_yaml_stay_texts_and_those_of_xml_are_read_as_yaml() -> None:
    xml = (
        "<launch><set_parameter name='a' value='3'/><node exec='./show.sh'><param name='b' value='4'/></node></launch>"
    )
    assert parameters(launched(xml, name="a.launch.xml")) == [{"/**": {"a": 3}}, {"/**": {"b": 4}}]
    text = """launch:
- set_parameter: {name: a, value: "3"}
- node: {exec: ./show.sh, param: [{name: b, value: "4"}, {name: c, value: $(eval 2+3)}]}
"""
    of_yaml = [{"/**": {"a": 3}}, {"/**": {"b": "4"}}, {"/**": {"c": 5}}]
    assert parameters(launched(text, name="a.launch.yaml")) == of_yaml
