"""Programs wait in the hub's time: whatever they wait with, they wake at the right time, and in the same order."""

from __future__ import annotations

import pytest
from programs import MS, Watch, serialized

from rmw_lockstep.qos import QosPolicies


def test_time_goes_on_only_when_the_hub_says_so(watch: Watch) -> None:
    watch.start("""
        node.create_timer(0.1, lambda: say('tick'))
        rclpy.spin(node)
    """)
    watch.go_on(0)
    assert watch.said() == []
    watch.go_on(0.35)
    assert watch.said() == [(100, "tick"), (200, "tick"), (300, "tick")]


@pytest.mark.parametrize(
    "waiting",
    [
        "time.sleep(0.02)",
        "threading.Event().wait(0.02)",
        "threading.Lock().acquire() and lock.acquire(timeout=0.02)",
        "queue.Queue().get(timeout=0.02) if False else threading.Condition(threading.RLock()).acquire() and cond(0.02)",
        "select.select([], [], [], 0.02)",
        "select.poll().poll(20)",
        "selectors.DefaultSelector().select(0.02)",
        "asyncio.run(asyncio.sleep(0.02))",
        "subprocess.run(['sleep', '0.02'])",
        "os.system('sleep 0.02')",
        "wait_by_the_clock(0.02)",
        "rclpy.spin_until_future_complete(node, rclpy.Future(), timeout_sec=0.02)",
        "node.create_client(Trigger, '/nobody').wait_for_service(timeout_sec=0.02)",
    ],
)
def test_a_wait_of_20_ms_takes_20_ms_of_the_hubs_time(watch: Watch, waiting: str) -> None:
    watch.start(f"""
        import asyncio, queue, select, selectors, subprocess
        from std_srvs.srv import Trigger
        lock = threading.Lock(); lock.acquire()
        def cond(seconds):
            condition = threading.Condition()
            with condition: condition.wait(seconds)
        def wait_by_the_clock(seconds):
            end = time.perf_counter() + seconds
            while time.perf_counter() < end: pass
        for i in range(3):
            {waiting}
            say(i)
    """)
    watch.go_on(1.0)
    assert [round(at) for at, _ in watch.said()] in (
        [20, 40, 60],
        [250, 500, 750],
    )  # wait_for_service looks each 250 ms


def test_threads_that_wake_at_one_time_wake_one_after_another_in_the_order_of_their_start(watch: Watch) -> None:
    watch.start("""
        def loop(name):
            while True:
                time.sleep(0.01)
                say(name)
        for name in 'abc': threading.Thread(target=loop, args=name, daemon=True).start()
        rclpy.spin(node)
    """)
    watch.go_on(0.03)
    assert [said for _, said in watch.said()] == list("abc" * 3)


def test_the_calendar_and_the_steady_clock_show_the_hubs_time(watch: Watch) -> None:
    watch.start("""
        import datetime
        time.sleep(1.5)
        say(time.monotonic())
        say(datetime.datetime.now(datetime.timezone.utc).isoformat())
        say(node.get_clock().now().nanoseconds)
    """)
    watch.go_on(2)
    assert [said for _, said in watch.said()] == ["1001.5", "2026-01-01T00:16:41.500000+00:00", "1767226601500000000"]


def test_a_program_that_asks_again_and_again_is_idle_and_its_time_goes_on(watch: Watch) -> None:
    watch.start("""
        began = time.monotonic()
        while time.monotonic() < began + 0.1: rclpy.spin_once(node, timeout_sec=0)
        say('done')
    """)
    watch.go_on(0.05)
    assert watch.said() == []
    watch.go_on(0.15)
    ((at, _),) = watch.said()
    assert 100 <= at <= 110


def test_a_look_into_a_pipe_without_waiting_takes_no_time(watch: Watch) -> None:
    watch.start("""
        import multiprocessing
        ours, theirs = multiprocessing.Pipe()
        say([ours.poll() for _ in range(1000)].count(True))
    """)
    watch.go_on(1)
    assert watch.said() == [(0, "0")]


def test_a_time_out_of_a_program_passes_at_its_time(watch: Watch) -> None:
    watch.start("""
        import subprocess
        try: subprocess.run(['sleep', '5'], timeout=0.02, stdout=subprocess.PIPE)
        except subprocess.TimeoutExpired: say('expired')
    """)
    watch.go_on(1)
    assert watch.said() == [(20, "expired")]


def test_a_thread_that_waits_for_python_does_not_keep_the_one_that_waits_for_a_time(watch: Watch) -> None:
    watch.start("""
        nothing, waited = os.open('/dev/null', os.O_WRONLY), threading.Event()
        def write():
            while not waited.is_set(): os.write(nothing, b'x')  # and asks for Python's lock after each
        threading.Thread(target=write, daemon=True).start()
        began = time.monotonic()
        while time.monotonic() < began + 0.02: pass
        waited.set()
        say('waited')
        rclpy.spin(node)
    """)
    watch.go_on(0.2)
    ((at, said),) = watch.said()
    assert said == "waited"
    assert 20 <= at <= 21


def test_what_a_program_published_before_it_ends_without_warning_has_come(watch: Watch) -> None:
    watch.start("""
        for i in range(50): say(i)
        os._exit(0)
    """)
    watch.go_on(0)
    assert [said for _, said in watch.said()] == [str(i) for i in range(50)]


def test_a_forked_process_waits_in_the_hubs_time_too(watch: Watch) -> None:
    watch.start("""
        reading, writing = os.pipe()
        if os.fork() == 0:
            time.sleep(0.01)
            os.write(writing, b'x')
            os._exit(0)
        os.read(reading, 1)
        say('the child has slept')
        os.wait()
    """)
    watch.go_on(1)
    assert watch.said() == [(10, "the child has slept")]


@pytest.mark.parametrize("computes_s", [0.0, pytest.param(0.3, marks=pytest.mark.soak)])
def test_a_childs_clock_goes_on_from_where_it_was_forked_however_busy_its_parent_is(
    watch: Watch, computes_s: float
) -> None:
    watch.start(f"""
        def fork():
            time.sleep(0.03)
            began = time.monotonic()
            reading, writing = os.pipe()
            if os.fork() == 0:
                os.write(writing, repr(time.monotonic() - began).encode())
                os._exit(0)
            os.close(writing)
            end = time.process_time() + {computes_s}
            while time.process_time() < end: pass
            say(os.read(reading, 100).decode())
            os.wait()
        threading.Thread(target=fork, daemon=True).start()
        rclpy.spin(node)
    """)
    watch.go_on(1)
    assert [said for _, said in watch.said()] == ["0.0"]


@pytest.mark.parametrize("child", ["", "import rclpy"])
def test_time_stands_still_for_a_child_and_what_is_sent_for_later_waits(watch: Watch, child: str) -> None:
    watch.start(f"""
        import subprocess
        node.create_subscription(String, '/asked', lambda message: say(message.data + '!'), 10)
        def work():
            time.sleep(0.024)
            subprocess.run([sys.executable, '-c', {child!r}])
            say('waited')
        threading.Thread(target=work, daemon=True).start()
        rclpy.spin(node)
    """)
    publisher = watch.node.publisher("/asked", "std_msgs/msg/String", QosPolicies())
    watch.hub.wait_until_idle()
    watch.hub.advance(watch.hub.now + 100 * MS)
    publisher.publish(serialized("one"))
    watch.hub.barrier()
    publisher.publish(serialized("two"))
    watch.hub.wait_until_idle()
    assert watch.said() == [(24, "waited"), (100, "one!"), (100, "two!")]


def test_a_process_that_another_wakes_through_a_pipe_is_not_idle_before_it_has_done_what_it_is_woken_for(
    watch: Watch,
) -> None:
    watch.start("""
        reading, writing = os.pipe()
        if os.fork() == 0:
            for i in range(20):
                time.sleep(0.01)
                os.write(writing, b'x')
            time.sleep(10)
            os._exit(0)
        for i in range(20):
            os.read(reading, 1)
            sum(range(300_000))
            say(i)
        rclpy.spin(node)
    """)
    watch.go_on(0.5)
    assert watch.said() == [(10 * (i + 1), str(i)) for i in range(20)]


def test_a_program_that_is_started_by_the_program_is_part_of_the_graph(watch: Watch) -> None:
    watch.start("""
        import subprocess
        if len(sys.argv) == 1:
            child = subprocess.Popen([sys.executable, __file__, 'child'])
            child.wait()
            say('parent')
        else:
            time.sleep(0.01)
            say('child')
    """)
    watch.go_on(1)
    assert sorted(watch.said()) == [(10, "child"), (10, "parent")]


def test_two_processes_with_one_nodes_name_publish_without_order_and_another_name_has_its_own(watch: Watch) -> None:
    watch.start("say('first')\nrclpy.spin(node)")
    watch.go_on(0)
    watch.start("say('second')\nrclpy.spin(node)")
    watch.start("""
        other = rclpy.create_node('other')
        other.create_publisher(String, '/said', 100).publish(String(data='third'))
        rclpy.spin(node)
    """)
    watch.go_until(lambda: len(watch.said()) == 3)
    assert watch.ordered() == {"first": True, "second": False, "third": True}


@pytest.mark.parametrize("executor", ["SingleThreadedExecutor", "MultiThreadedExecutor", "EventsExecutor"])
def test_every_executor_answers_and_is_known_to_be_idle(watch: Watch, executor: str) -> None:
    watch.start(f"""
        from rclpy.experimental.events_executor import EventsExecutor
        node.create_subscription(String, '/asked', lambda message: say(message.data + '!'), 10)
        executor = {executor}()
        executor.add_node(node)
        executor.spin()
    """)
    from rclpy.serialization import serialize_message
    from std_msgs.msg import String

    publisher = watch.node.publisher("/asked", "std_msgs/msg/String", QosPolicies())
    watch.go_on(0)
    for word in ("one", "two", "three"):
        publisher.publish(serialize_message(String(data=word)))
        watch.go_on(0.1)
    assert watch.said() == [(0, "one!"), (100, "two!"), (200, "three!")]


def test_a_callback_that_sleeps_in_a_group_of_its_own_does_not_keep_the_others(watch: Watch) -> None:
    watch.start("""
        from rclpy.callback_groups import MutuallyExclusiveCallbackGroup as Group
        def slow():
            time.sleep(0.03)
            say('slow')
        node.create_timer(0.1, slow, callback_group=Group())
        node.create_timer(0.02, lambda: say('quick'), callback_group=Group())
        executor = MultiThreadedExecutor(4)
        executor.add_node(node)
        executor.spin()
    """)
    watch.go_on(0.25)
    assert [at for at, said in watch.said() if said == "slow"] == [130, 230]
    assert [at for at, said in watch.said() if said == "quick"] == list(range(20, 250, 20))


def test_a_program_is_not_idle_before_a_thread_has_done_what_a_condition_variable_wakes_it_for(watch: Watch) -> None:
    watch.start("""
        import ctypes
        c = ctypes.CDLL(None)
        mutex, condition = ctypes.create_string_buffer(64), ctypes.create_string_buffer(64)
        far = (ctypes.c_long * 2)(4_000_000_000, 0)
        def work():
            c.pthread_mutex_lock(mutex)
            for _ in range(3):
                c.pthread_cond_timedwait(condition, mutex, far)
                sum(range(3_000_000))
                say('worked')
        threading.Thread(target=work, daemon=True).start()
        node.create_timer(0.1, lambda: c.pthread_cond_signal(condition))
        rclpy.spin(node)
    """)
    watch.go_on(0)
    watch.go_on(0.35)
    assert watch.said() == [(100, "worked"), (200, "worked"), (300, "worked")]
