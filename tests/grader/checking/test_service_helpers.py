"""What the helpers for services say: responses of the student's server, requests of the student's client."""

from __future__ import annotations

from dataclasses import replace

import pytest
from made_up import ADD, EMPTY, ENDS, EXERCISE, finding, ns, published, run, says

from grader.exercise.exercise import ServiceOrAction
from grader.recording import Recording
from grader.recording.events import Call


def calls(*sums: int | None, late: float = 0.0, by: str = "grader", served: bool = True) -> Recording:
    """Return one request per second, n + 1 for number n, and these responses."""
    made = tuple(
        Call(
            *(ns(n), "/add", ADD, {"a": n, "b": 1}, by),  # type: ignore[arg-type]
            answered_ns=None if total is None else ns(n + late),
            response=None if total is None else {"sum": total},
            served=served,
        )
        for n, total in enumerate(sums, start=1)
    )
    return replace(EMPTY, calls=made)


RIGHT = calls(2, 3, 4, 5)
CLIENT = replace(EXERCISE, endpoints=(ServiceOrAction("/add", ADD, "client"),))


def test_a_right_server_passes() -> None:
    run(RIGHT).must_respond(within=0.0)
    run(RIGHT).must_match_responses("sum")
    run(RIGHT).must_match_responses()


@pytest.mark.parametrize(
    ("mine", "message"),
    [
        (calls(2, 9, 4, 5), "At 2.00 s (as usual), request 2 to /add (a 2, b 1): expected sum 3 m, got 9 m."),
        (calls(-2, -3, -4, -5), "expected sum 2 m, got -2 m. Every value has the wrong sign."),
        (calls(4, 6, 8, 10), "Every sum is 2 times what it should be."),
        (calls(2, None, 4, 5), "request 2 to /add (a 2, b 1): a response was expected, got none."),
        (calls(None, None, None, None), "got none. Your node never responds. Does the callback return the response"),
    ],
)
def test_wrong_responses(mine: Recording, message: str) -> None:
    assert message in says(lambda: run(mine, RIGHT).must_match_responses("sum"))


def test_responses_that_come_late() -> None:
    found = finding(lambda: run(calls(2, 3, 4, 5, late=0.45), RIGHT).must_respond(within=0.1))
    assert found.text == (
        "At 1.00 s (as usual), request 1 to /add (a 1, b 1): a response was expected within 0.1 s, got it 0.45 s "
        "after the request. Every response comes 0.45 s after its request."
    )
    assert (found.at, found.part, found.expected, found.got) == (1.0, "request 1 to /add (a 1, b 1)", "0.1 s", "0.45 s")


def test_a_server_under_another_name() -> None:
    mine = replace(calls(None, None, served=False), end_points=(replace(ENDS[2], topic="/sum"),))
    assert "your node has no service /add. Its services are: /sum." in says(lambda: run(mine, RIGHT).must_respond())


def test_requests_of_a_client() -> None:
    right = calls(2, 3, by="node")
    run(right, exercise=CLIENT).must_call(count=2)
    run(right, exercise=CLIENT).must_match_requests("a")
    once, none = calls(2, by="node"), calls(by="node")
    assert "expected 2 requests to /add, got 1." in says(lambda: run(once, right, CLIENT).must_call())
    assert "got 0. Your node has no client for /add. Its clients are for: none." in says(
        lambda: run(none, right, CLIENT).must_call()
    )
    other = replace(right, calls=tuple(replace(call, request={"a": 7, "b": 1}) for call in right.calls))
    assert "request 1 to /add: expected a 1, got 7." in says(lambda: run(other, right, CLIENT).must_match_requests())


def test_a_client_that_does_nothing_after_its_request_is_asked_whether_it_waits() -> None:
    def client(requests: int, until: float) -> Recording:
        ticks = [n / 2 for n in range(1, 20) if n / 2 <= until]
        asked = calls(*range(requests), by="node")
        return replace(asked, received=published(ticks, ticks).received)

    right, waits = client(4, 5.0), client(1, 0.9)
    message = "Your node sent a request to /add at 1.00 s, and did nothing from then on. Does a callback wait,"
    mine = run(waits, right, CLIENT)
    assert message in says(lambda: mine.must_match_requests("a"))
    assert message in says(lambda: mine.must_keep_rate(2.0, "/out"))
    assert message in says(lambda: mine.must_match_series("data", "/out"))
    goes_on = run(client(1, 5.0), right, CLIENT)
    assert says(lambda: goes_on.must_match_requests("a")).endswith("expected 4 requests to /add, got 1.")


def test_requests_that_come_too_late() -> None:
    right = calls(2, 3, by="node")
    late = replace(right, calls=tuple(replace(call, at_ns=call.at_ns + ns(0.45) - ns(0)) for call in right.calls))
    run(late, right, CLIENT).must_match_requests()
    assert "request 1 to /add: it was expected at 1.00 s, but happened at 1.45 s." in says(
        lambda: run(late, right, CLIENT).must_match_requests(time=0.1)
    )


def test_an_author_who_has_to_name_the_service_is_reported() -> None:
    with pytest.raises(ValueError, match=r"name the client: exercise.toml has none under \[\[client\]\]"):
        run(RIGHT).must_call()
