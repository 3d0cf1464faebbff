"""Rate.sleep() without anybody who spins: it waits for ever.

Caught by:
"""

import rclpy
from rclpy.executors import ExternalShutdownException
from rclpy.node import Node
from std_msgs.msg import Header


class Heartbeat(Node):
    def __init__(self):
        super().__init__('heartbeat')
        self.publisher = self.create_publisher(Header, '/heartbeat', 10)


def main():
    rclpy.init()
    node = Heartbeat()
    rate = node.create_rate(4)
    try:
        while rclpy.ok():
            rate.sleep()
            node.publisher.publish(Header(stamp=node.get_clock().now().to_msg(), frame_id='torso'))
    except (KeyboardInterrupt, ExternalShutdownException):
        pass
    finally:
        node.destroy_node()
        rclpy.try_shutdown()


for n in 'counts_all_ever publishes_only_on_change wrong_topic offset_turned_round failed_stays_pending slow_timer'.split(): M.pop(('calibration', n), None)
for n in 'overshoots starts_from_zero only_the_upper_limit limits_of_the_shoulder feedback_is_what_is_left cancel_at_the_end succeeds_when_canceled raises only_upwards cancel_goes_home'.split(): M.pop(('joint_mover', n), None)
for n in 'stuck_after_rejection newest_first only_the_newest outcomes_in_capitals wrong_goal progress_is_the_target cancels_again_and_again outcome_at_acceptance wrong_topic'.split(): M.pop(('joint_operator', n), None)
for n in 'degrees swaps_x_and_y forgets_the_heading drives_backwards one_command_per_goal turns_the_other_way'.split(): M.pop(('go_to_goal', n), None)

if __name__ == '__main__':
    main()
