"""Mistakes that `solutions/` does not list: other numbers, other places, two at once, and some unexpected ones.

Each is the exercise's solution with some of its text replaced. `may_be_called` are the listed mistakes that it makes: it
may stand under these, or under "other", and under nothing else.
"""

# ruff: noqa: E501

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass


@dataclass(frozen=True)
class Unlisted:
    """One mistake: what it replaces in the solution, and the names that fit it."""

    replaced: Mapping[str, str]
    may_be_called: tuple[str, ...] = ()

    def applied_to(self, solution: str) -> str:
        """Return the whole program."""
        for old, new in self.replaced.items():
            assert old in solution, f"the solution has no {old!r}"
            solution = solution.replace(old, new)
        return solution


UNLISTED: dict[str, dict[str, Unlisted]] = {
    "heartbeat": {
        "five_per_second": Unlisted(
            {"self.timer = self.create_timer(0.25, self.beat)": "self.timer = self.create_timer(0.2, self.beat)"}
        ),
        "rate_2": Unlisted(
            {"self.timer = self.create_timer(0.25, self.beat)": "self.timer = self.create_timer(0.5, self.beat)"}
        ),
        "frame_upper": Unlisted({"message.frame_id = 'torso'": "message.frame_id = 'Torso'"}),
        "no_stamp_no_frame": Unlisted(
            {"message.stamp = self.get_clock().now().to_msg()": "pass", "message.frame_id = 'torso'": "pass"},
            ("forgets_the_stamp", "forgets_the_frame", "stamp_from_the_start"),
        ),
        "misspelt_topic": Unlisted({"'/heartbeat', 10": "'/hearbeat', 10"}, ("wrong_topic",)),
        "monotonic_stamp": Unlisted(
            {
                "message.stamp = self.get_clock().now().to_msg()": "import time; message.stamp.sec = int(time.monotonic())"
            }
        ),
        "ctrl_c_and_name": Unlisted(
            {"rclpy.try_shutdown()": "rclpy.shutdown()", "super().__init__('heartbeat')": "super().__init__('beat')"},
            ("another_name", "traceback_on_ctrl_c"),
        ),
        "stamp_one_second_ahead": Unlisted(
            {
                "message.stamp = self.get_clock().now().to_msg()": "message.stamp = self.get_clock().now().to_msg(); message.stamp.sec += 1"
            }
        ),
        "stops_after_five": Unlisted(
            {
                "self.timer = self.create_timer(0.25, self.beat)": "self.timer = self.create_timer(0.25, self.beat); self.n = 0",
                "        message = Header()\n": "        self.n += 1\n        if self.n > 20: return\n        message = Header()\n",
            },
            ("stops_after_ten_seconds",),
        ),
    },
    "joint_velocity": {
        "half": Unlisted(
            {"(position - self.positions_before[name]) / dt": "(position - self.positions_before[name]) / (2 * dt)"}
        ),
        "abs_speed": Unlisted(
            {"(position - self.positions_before[name]) / dt": "abs(position - self.positions_before[name]) / dt"}
        ),
        "fixed_dt_50hz": Unlisted(
            {"(position - self.positions_before[name]) / dt": "(position - self.positions_before[name]) / 0.02"},
            ("fixed_dt",),
        ),
        "radians_of_degrees": Unlisted(
            {
                "(position - self.positions_before[name]) / dt": "math.radians((position - self.positions_before[name]) / dt)"
            }
        ),
        "sign_and_frame": Unlisted(
            {
                "(position - self.positions_before[name]) / dt": "(self.positions_before[name] - position) / dt",
                "answer.header = message.header": "answer.header.stamp = message.header.stamp",
            },
            ("sign_turned_round", "forgets_the_frame"),
        ),
        "millis": Unlisted({"/ NANOSECONDS)": "/ 1e6)"}),
        "rounded": Unlisted(
            {"(position - self.positions_before[name]) / dt": "round((position - self.positions_before[name]) / dt, 1)"}
        ),
        "other_topic_name": Unlisted(
            {"JointState, '/joint_velocities', 10": "JointState, '/joints/velocity', 10"}, ("wrong_topic",)
        ),
        "clamps_5": Unlisted(
            {
                "(position - self.positions_before[name]) / dt": "max(-5.0, min(5.0, (position - self.positions_before[name]) / dt))"
            },
            ("clamps_velocities",),
        ),
        "smoothed": Unlisted(
            {
                "(position - self.positions_before[name]) / dt": "0.5 * (position - self.positions_before[name]) / dt + 0.5 * self.former.get(name, (position - self.positions_before[name]) / dt)",
                "self.stamp_before = None  # ns": "self.stamp_before = None; self.former = {}",
                "            if name in self.positions_before:\n": "            if name in self.positions_before:\n                self.former[name] = self.former.get(name, 0.0)\n",
            },
            ("averaged_over_two",),
        ),
        "stamp_plus_one": Unlisted(
            {
                "answer.header = message.header": "answer.header.frame_id = message.header.frame_id; answer.header.stamp.sec = message.header.stamp.sec + 1; answer.header.stamp.nanosec = message.header.stamp.nanosec"
            }
        ),
        "skips_every_other": Unlisted(
            {
                "        if answer.name:\n": "        self.k = getattr(self, 'k', 0) + 1\n        if answer.name and self.k % 2:\n"
            }
        ),
        "reversed_names": Unlisted(
            {
                "        if answer.name:\n": "        answer.name = list(answer.name)[::-1]; answer.velocity = list(answer.velocity)[::-1]\n        if answer.name:\n"
            }
        ),
    },
    "motor_switch": {
        "other_words": Unlisted({"'motors on' if self.on else 'motors off'": "'ok'"}),
        "no_reason": Unlisted({"response.message = 'emergency stop'": "pass"}),
        "raises_index": Unlisted(
            {
                "            response.success = False\n            response.message = 'emergency stop'\n            return response": "            [][0]"
            },
            ("raises",),
        ),
        "inverted_output": Unlisted({"Bool(data=on)": "Bool(data=not on)"}, ("publishes_the_former_state",)),
        "forgets_and_name": Unlisted(
            {"response.success = True": "pass", "super().__init__('motor_switch')": "super().__init__('switch')"},
            ("forgets_success", "another_name"),
        ),
        "emergency_topic": Unlisted({"Bool, '/emergency_stop'": "Bool, '/emergency'"}),
        "first_only": Unlisted(
            {
                "if on != self.on:": "if on != self.on and not getattr(self, 'once', False):\n            self.once = True"
            }
        ),
    },
    "robot_description": {
        "depth_5": Unlisted({"depth=1": "depth=5"}, ("keeps_ten", "depth_of_five")),
        "upper": Unlisted({"String(data=text)": "String(data=text.upper())"}),
        "volatile_and_all": Unlisted(
            {
                "latched = QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL)": "latched = 1",
                "        self.add_on_set_parameters_callback(self.on_set)\n": "",
            },
            ("volatile", "takes_everything"),
        ),
        "declares_other_default": Unlisted(
            {"DEFAULT = '<robot name=\"humanoid\"/>'": "DEFAULT = '<robot name=\"arm\"/>'"}
        ),
        "endswith": Unlisted(
            {"        return ElementTree.fromstring(text).tag == 'robot'": "        return text.startswith('<robot')"}
        ),
        "refuses_everything": Unlisted(
            {
                "return SetParametersResult(successful=True)": "return SetParametersResult(successful=False, reason='no')"
            },
            ("on_set_returns_nothing",),
        ),
        "twice_a_second": Unlisted(
            {
                "        self.published = None\n": "        self.published = None\n        self.create_timer(0.5, lambda: self.publisher.publish(String(data=self.published)))\n"
            },
            ("latched_and_again",),
        ),
    },
    "joint_filter": {
        "default_0_9": Unlisted({"'gain', 0.5": "'gain', 0.9"}, ("another_default",)),
        "called_k": Unlisted({"'gain'": "'k'"}, ("another_parameter",)),
        "always_0_3": Unlisted({"gain = self.get_parameter('gain').value": "gain = 0.3"}, ("fixed_gain",)),
        "half_range": Unlisted({"to_value=1.0": "to_value=0.5", "<= 1.0:": "<= 0.5:"}),
        "velocity_out": Unlisted(
            {"answer.position.append(self.smooth[name])": "answer.velocity.append(self.smooth[name])"}
        ),
        "no_header_and_ctrl_c": Unlisted(
            {"header=message.header, ": "", "rclpy.try_shutdown()": "rclpy.shutdown()"},
            ("forgets_the_stamp", "traceback_on_ctrl_c"),
        ),
        "second_order": Unlisted({"before + gain * (position - before)": "before + gain * gain * (position - before)"}),
    },
    "go_to_goal": {
        "stops_at_half": Unlisted({"CLOSE_ENOUGH = 0.08": "CLOSE_ENOUGH = 0.5"}, ("stops_too_early",)),
        "three_ms": Unlisted({"FASTEST = 2.0": "FASTEST = 3.0"}, ("too_fast",)),
        "turn_4": Unlisted({"FASTEST_TURN = 2.0": "FASTEST_TURN = 4.0"}, ("turns_too_fast",)),
        "slowest": Unlisted({"min(distance": "min(0.1 * distance"}, ("too_slow",)),
        "turns_wrong_way": Unlisted({"min(4.0 * turn": "min(-4.0 * turn"}, ("turns_away",)),
        "swaps_xy": Unlisted(
            {"self.goal.x - pose.x, self.goal.y - pose.y": "self.goal.y - pose.x, self.goal.x - pose.y"},
            ("swaps_x_and_y",),
        ),
        "backwards": Unlisted({"command.linear.x = min": "command.linear.x = -min"}, ("drives_backwards",)),
    },
    "calibration": {
        "gives_up_2s": Unlisted({"seconds=5.0": "seconds=2.0"}, ("gives_up_too_early",)),
        "gives_up_20s": Unlisted({"seconds=5.0": "seconds=60.0"}, ("never_gives_up",)),
        "slow_timer": Unlisted({"create_timer(0.1, self.tick)": "create_timer(0.5, self.tick)"}),
        "negates": Unlisted({"position=[answer.offset]": "position=[-answer.offset]"}),
        "ignores_both": Unlisted(
            {"answer.success and math.isfinite(answer.offset)": "True"}, ("ignores_success", "passes_nan_on")
        ),
        "name_of_node_and_ctrlc": Unlisted(
            {
                "super().__init__('calibration')": "super().__init__('calib')",
                "rclpy.try_shutdown()": "rclpy.shutdown()",
            },
            ("another_name", "traceback_on_ctrl_c"),
        ),
    },
    "joint_mover": {
        "half_step": Unlisted({"STEP = 0.05": "STEP = 0.02"}, ("too_slow",)),
        "big_step": Unlisted({"STEP = 0.05": "STEP = 0.5"}, ("jumps",)),
        "upper_1": Unlisted({"UPPER = 0.0, 2.356": "UPPER = 0.0, 1.0"}),
        "no_feedback_empty_result": Unlisted(
            {
                "            goal_handle.publish_feedback(MoveJoint.Feedback(position=self.position))\n": "",
                "MoveJoint.Result(position=self.position)": "MoveJoint.Result()",
            },
            ("no_feedback", "empty_result"),
        ),
        "cancel_rejected": Unlisted(
            {"return CancelResponse.ACCEPT": "return CancelResponse.REJECT"}, ("no_cancel_callback",)
        ),
        # An exception, like that of canceled(): no difference is visible from outside.
        "raises_when_replaced": Unlisted(
            {
                "                goal_handle.abort()\n                break": "                raise RuntimeError('replaced')"
            },
            ("canceled_when_replaced",),
        ),
    },
    "joint_operator": {
        # If the computer's clock runs faster by a quarter, as here, 4 s are what 5 s of it are.
        "cancels_after_4": Unlisted({"seconds=5.0": "seconds=4.0"}, ("cancels_too_early", "wall_clock")),
        "cancels_after_30": Unlisted({"seconds=5.0": "seconds=300.0"}, ("never_cancels",)),
        "upper_case": Unlisted({"String(data=outcome)": "String(data=outcome.upper())"}),
        "no_progress_and_name": Unlisted(
            {
                "send_goal_async(goal, self.on_feedback)": "send_goal_async(goal)",
                "super().__init__('joint_operator')": "super().__init__('operator')",
            },
            ("no_feedback_callback", "another_name"),
        ),
        "newest_only": Unlisted(
            {"self.waiting.append(message.data)": "self.waiting = [message.data]"}, ("drops_while_busy",)
        ),
        "other_action": Unlisted({"MoveJoint, '/move_joint'": "MoveJoint, '/move'"}, ("wrong_action",)),
    },
}
