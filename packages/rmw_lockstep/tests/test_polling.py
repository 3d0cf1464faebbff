"""Loops that look for messages and sleep a little in between: few turns while nothing happens, everything on time."""

from __future__ import annotations

import pytest
from programs import Watch, serialized

from rmw_lockstep.hub import QosPolicies

#: Looks every 3 ms, from 0 on, and says when it got a message and how many turns that took.
LOOP = """
    turns = 0
    def answer(message):
        global turns
        say(f'{message.data} {turns}')
        turns = 0
    node.create_subscription(String, '/heard', answer, 10)
    def turn():
        global turns
        turns += 1
        rclpy.spin_once(node, timeout_sec=0)
"""

SLEEPS = {
    "time.sleep": "while True: turn(); time.sleep(0.003)",
    "select": "import select\n    while True: turn(); select.select([], [], [], 0.003)",
    "asyncio": "import asyncio\n    async def loop():\n"
    "        while True: turn(); await asyncio.sleep(0.003)\n    asyncio.run(loop())",
}


@pytest.mark.parametrize("sleep", SLEEPS)
def test_a_long_silence_takes_few_turns_and_its_end_is_seen_at_the_next_one(watch: Watch, sleep: str) -> None:
    watch.start(LOOP + "    " + SLEEPS[sleep])
    publisher = watch.node.publisher("/heard", "std_msgs/msg/String", QosPolicies(depth=10))
    for at in (3.0, 3.5, 4.0, 14.001):
        watch.go_on(at - watch.elapsed_s)
        publisher.publish(serialized(str(at)))
    watch.go_on(0.01)
    said = [(at, *map(float, text.split())) for at, text in watch.said()]
    assert [when for _, when, _ in said] == [3.0, 3.5, 4.0, 14.001]
    # asyncio rounds its sleeps up to milliseconds, so its turns are 3 or 4 ms apart.
    assert all(0 < at - 1000 * when <= 4 for at, when, _ in said)
    if sleep != "asyncio":
        assert [round(at) for at, _, _ in said] == [3003, 3501, 4002, 14_004]
    turns = [turns for _, _, turns in said]
    assert all(40 < count < 80 for count in turns[1:3]), "500 ms in turns of up to 9 ms"
    assert 1000 < turns[3] < 1300, "10 s in turns of up to 9 ms"


def test_what_another_thread_does_meanwhile_is_seen_at_the_next_turn(watch: Watch) -> None:
    watch.start("""
        found = []
        def think():
            for after in (0.1, 0.03, 0.0305):
                time.sleep(after)
                found.append(after)
        threading.Thread(target=think, daemon=True).start()
        while True:
            rclpy.spin_once(node, timeout_sec=0)
            while found: say(found.pop())
            time.sleep(0.001)
    """)
    watch.go_on(0.3)
    assert [(round(at), text) for at, text in watch.said()] == [(101, "0.1"), (131, "0.03"), (161, "0.0305")]


def test_a_program_that_acts_by_its_own_clock_is_late_once_at_most(watch: Watch) -> None:
    watch.start("""
        due = time.monotonic() + 0.0335
        while True:
            rclpy.spin_once(node, timeout_sec=0)
            if time.monotonic() >= due:
                say('now')
                due += 0.0335
            time.sleep(0.001)
    """)
    watch.go_on(0.14)
    first, *rest = (at for at, _ in watch.said())
    assert 33.5 <= first < 44
    assert rest == [67, 101, 134]


def test_a_wall_timer_is_on_time(watch: Watch) -> None:
    watch.start("""
        from rclpy.clock import Clock, ClockType
        node.create_timer(0.0335, lambda: say('now'), clock=Clock(clock_type=ClockType.STEADY_TIME))
        while True:
            rclpy.spin_once(node, timeout_sec=0)
            time.sleep(0.001)
    """)
    watch.go_on(0.14)
    assert [at for at, _ in watch.said()] == [34, 67, 101, 134]
