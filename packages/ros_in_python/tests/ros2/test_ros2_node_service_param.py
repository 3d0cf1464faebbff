"""`ros2 node`, `ros2 service` and `ros2 param` on real nodes."""

from __future__ import annotations

import pytest
from ros2_terminal import Robot, Terminal

pytestmark = pytest.mark.usefixtures("ros_domain")

SERVICES = """\
    /joint_publisher/describe_parameters: rcl_interfaces/srv/DescribeParameters
    /joint_publisher/get_parameter_types: rcl_interfaces/srv/GetParameterTypes
    /joint_publisher/get_parameters: rcl_interfaces/srv/GetParameters
    /joint_publisher/get_type_description: type_description_interfaces/srv/GetTypeDescription
    /joint_publisher/list_parameters: rcl_interfaces/srv/ListParameters
    /joint_publisher/set_parameters: rcl_interfaces/srv/SetParameters
    /joint_publisher/set_parameters_atomically: rcl_interfaces/srv/SetParametersAtomically
"""


def test_node_info_has_the_sections_of_the_real_command(standing: Robot, terminal: Terminal) -> None:
    standing("publisher")
    assert terminal.ros2("node", "list").out == "/joint_publisher\n"
    assert terminal.ros2("node", "info", "/joint_publisher").out == (
        "/joint_publisher\n"
        "  Subscribers:\n"
        "\n"
        "  Publishers:\n"
        "    /joint_commands: sensor_msgs/msg/JointState\n"
        "    /parameter_events: rcl_interfaces/msg/ParameterEvent\n"
        "    /rosout: rcl_interfaces/msg/Log\n"
        "  Service Servers:\n" + SERVICES + "  Service Clients:\n"
        "\n"
        "  Action Servers:\n"
        "\n"
        "  Action Clients:\n"
        "\n"
    )


def test_an_unknown_node_is_refused(standing: Robot, terminal: Terminal) -> None:
    standing("publisher")
    answer = terminal.ros2("node", "info", "/jointpublisher")
    assert answer.code == 1
    assert answer.err.startswith("Unable to find node '/jointpublisher'\nNodes seen: /joint_publisher.")
    # As the real command, which knows nodes by their full names.
    bare = terminal.ros2("node", "info", "joint_publisher")
    assert bare.code == 1
    assert bare.err.startswith(
        "Unable to find node 'joint_publisher'\nIts name begins with a slash: ros2 node info /joint_publisher\n"
    )


def test_service_list_has_types(standing: Robot, terminal: Terminal) -> None:
    standing("publisher")
    expected = "".join(
        f"{name} [{kind}]\n" for name, kind in (line.strip().split(": ") for line in SERVICES.splitlines())
    )
    assert terminal.ros2("service", "list", "-t").out == expected


def test_service_call_prints_request_and_response(standing: Robot, terminal: Terminal) -> None:
    standing("service")
    answer = terminal.ros2("service", "call", "/stand_up", "std_srvs/srv/SetBool", "{data: true}")
    assert answer.out == (
        "requester: making request: std_srvs.srv.SetBool_Request(data=True)\n"
        "\n"
        "response:\n"
        "std_srvs.srv.SetBool_Response(success=True, message='up')\n"
        "\n"
    )
    assert terminal.ros2("service", "type", "stand_up").out == "std_srvs/srv/SetBool\n"
    assert terminal.ros2("service", "find", "std_srvs/srv/SetBool").out == "/stand_up\n"


def test_a_misspelled_service_is_waited_for_with_the_right_name_in_sight(standing: Robot, terminal: Terminal) -> None:
    standing("service")
    running = terminal.start("service", "call", "/stand_op", "std_srvs/srv/SetBool")
    assert running.process.stderr is not None
    message = running.process.stderr.readline()
    assert message == "There is no service '/stand_op' yet. Did you mean /stand_up? Ctrl-C ends the wait.\n"
    running.stop()


def test_a_service_of_another_type_is_not_waited_for(standing: Robot, terminal: Terminal) -> None:
    standing("service")
    answer = terminal.ros2("service", "call", "/stand_up", "std_srvs/srv/Trigger")
    assert answer.code == 1
    assert "is of type std_srvs/srv/SetBool, not std_srvs/srv/Trigger" in answer.err


def test_a_wrong_field_of_a_request(terminal: Terminal) -> None:
    answer = terminal.ros2("service", "call", "/stand_up", "std_srvs/srv/SetBool", "{dat: true}")
    assert answer.code == 1
    assert "data (boolean)" in answer.err


def test_param_list_of_all_and_of_one(standing: Robot, terminal: Terminal) -> None:
    standing("publisher")
    params = "  gains.left\n  rate\n  start_type_description_service\n  use_sim_time\n"
    assert terminal.ros2("param", "list").out == "/joint_publisher:\n" + params
    assert terminal.ros2("param", "list", "joint_publisher").out == params


def test_param_get_set_and_dump(robot: Robot, terminal: Terminal) -> None:
    robot("publisher")
    assert terminal.ros2("param", "get", "/joint_publisher", "rate").out == "Double value is: 50.0\n"
    assert terminal.ros2("param", "set", "/joint_publisher", "rate", "-20.0").out == "Set parameter successful\n"
    assert terminal.ros2("param", "dump", "/joint_publisher").out == (
        "/joint_publisher:\n"
        "  ros__parameters:\n"
        "    gains:\n"
        "      left:\n"
        "      - 0.5\n"
        "      - 0.25\n"
        "    rate: -20.0\n"
        "    start_type_description_service: true\n"
        "    use_sim_time: false\n"
        "\n"
    )


def test_param_describe(standing: Robot, terminal: Terminal) -> None:
    standing("publisher")
    assert terminal.ros2("param", "describe", "/joint_publisher", "rate").out == (
        "Parameter name: rate\n"
        "  Type: double\n"
        "  Description: messages a second\n"
        "  Constraints:\n"
        "    Min value: -100.0\n"
        "    Max value: 100.0\n"
    )


def test_param_refusals(standing: Robot, terminal: Terminal) -> None:
    standing("publisher")
    unknown = terminal.ros2("param", "get", "/joint_publisher", "rat")
    assert (unknown.code, unknown.err.splitlines()[0]) == (1, "Parameter not set")
    assert "rate" in unknown.err.splitlines()[1]
    wrong = terminal.ros2("param", "set", "/joint_publisher", "rate", "fast")
    assert (wrong.code, wrong.err.split(":")[0]) == (0, "Setting parameter failed")
    nobody = terminal.ros2("param", "get", "/nobody", "rate")
    assert (nobody.code, nobody.err.splitlines()[0]) == (1, "Node not found")


def test_param_list_by_prefix_and_by_expression(standing: Robot, terminal: Terminal) -> None:
    standing("publisher")
    listed = terminal.ros2("param", "list", "joint_publisher", "--param-prefixes", "gains")
    assert listed.out == "  gains.left\n"
    assert terminal.ros2("param", "list", "joint_publisher", "--filter", "ra|use").out == "  rate\n  use_sim_time\n"
    wrong = terminal.ros2("param", "list", "joint_publisher", "--filter", "(")
    assert wrong.err.startswith("'(' is not a valid regular expression")


def test_service_echo_prints_the_calls_of_a_service_that_publishes_them(robot: Robot, terminal: Terminal) -> None:
    robot("introspected")
    running = terminal.start("service", "echo", "/lie_down", "--flow-style")
    lines: list[str] = []
    while "request: [{data: true}]" not in lines:
        lines += running.lines(1)
    assert "info:" in lines
    assert running.stop().code == 2
