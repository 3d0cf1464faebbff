"""Helpers for closed loops: whether the controlled position reaches a place in time, without overshoot, and stays."""

from __future__ import annotations

import itertools
import math
from bisect import bisect_right
from collections.abc import Sequence

from grader.checking.cause import UNKNOWN, Cause
from grader.checking.hint_texts import hints
from grader.checking.patterns import common
from grader.checking.recorded_run import RecordedRun
from grader.recording.events import Truth
from grader.recording.recording import ReceivedMessage, Recording, SentMessage
from ros_in_python.field_path import field_of

Place = dict[str, float]

#: Stands for a topic: what the world's truth() returned after each step.
TRUTH = "truth"

#: (seconds after the start, (values of the fields)) of each message, in order; also of one field: `(0.5, (2.0,))`.
Way = list[tuple[float, tuple[float, ...]]]

#: (seconds after the start, how far it is to the goal then, with its sign), in order: the goal minus the place.
Errors = Sequence[tuple[float, float]]

#: A command or an error this close to 0 has no sign that counts.
SMALLEST = 1e-3

#: This many commands, at least, tell that a sign is wrong.
FEWEST = 3

_SIGN = hints("wrong_sign")


def trajectory(run: RecordedRun, topic: str, *fields: str) -> Way:
    """Return (seconds after the start, values of `fields`) of each message on `topic`, whichever node published it.

    The values are a tuple, also of one field. The topic "truth" stands for what the world's truth() returned. There is
    at least one: the check ends if only the solution published something on `topic`.

    Example: `time, (value,) = run.trajectory("/in", "data")[-1]`
    """
    return _from(run, topic, None, *fields)


def _from(run: RecordedRun, topic: str, start: float | None, *fields: str) -> Way:
    """Return the trajectory from `start` on (s). If it is empty, the check ends, or the author's check is at fault."""
    way = _way(run.recording, topic, start, fields)
    since = "" if start is None else f" from {start:g} s on"
    if not way and not _way(run.reference, topic, start, ()):
        raise ValueError(f"there is no message on {topic} in the scenario {run.scenario}{since}.")
    if not way:
        run.wrong_at(None, f"expected messages on {topic}, got none{since}.", "", "messages", "none", run.waits())
    return way


def _way(recording: Recording, topic: str, start: float | None, fields: Sequence[str]) -> Way:
    messages: list[Truth | SentMessage | ReceivedMessage] = [*recording.truth]
    if topic != TRUTH:
        messages = [message for message in recording.sent if message.topic == topic]
        messages += [m for m in recording.received if m.topic == topic and not m.subscriber]
        messages.sort(key=lambda message: message.at_ns)
    chosen = [message for message in messages if start is None or message.at >= start - 1e-9]
    values = ((one.at, one.values if isinstance(one, Truth) else one.fields) for one in chosen)
    return [(at, tuple(float(field_of(named, name)) for name in fields)) for at, named in values]


def must_reach(
    run: RecordedRun,
    topic: str,
    place: Place,
    tolerance: float,
    within: float,
    overshoot: float | None = None,
    stay: bool = True,
    start: float = 0.0,
) -> None:
    """Check that the position published on `topic` is within `tolerance` of `place` by `within` s after `start`.

    `place` has a value for each field that counts: `{"x": 9.0, "y": 2.0}`. With `overshoot`, it must not go further
    than that beyond the place, as seen from its position at `start`. It must not leave the place again after that time;
    with `stay=False` it may, and passing through the place once is enough. Raises ValueError if the world ends before
    that time.

    Example: `run.must_reach("truth", {"level": 1.0}, tolerance=0.1, within=0.9)`
    """
    way = _from(run, topic, start, *place)
    _see_that_it_may_be_late(run, topic, start + within)
    goal, unit = tuple(place.values()), run.unit_of(next(iter(place)), topic)
    reached = next((at for at, point in way if math.dist(point, goal) <= tolerance), None)
    words = _words(place)
    if reached is None or reached - start > within + 1e-9:
        _never_there(run, way, goal, words, tolerance, within, unit, reached, start)
    assert reached is not None
    if overshoot is not None:
        _beyond(run, way, goal, words, overshoot, unit)
    left = next((at for at, p in way if at > max(reached, start + within) and math.dist(p, goal) > tolerance), None)
    if stay and left is not None:
        text = f"it reached {words} at {reached:.2f} s, but did not stay there."
        run.wrong_at(left, text, "", f"to stay within {_measure(tolerance, unit)}", f"left at {left:.2f} s")


def must_stay_between(
    run: RecordedRun, topic: str, field: str, lowest: float, highest: float, start: float = 0.0
) -> None:
    """Check that each value of `field` on `topic`, from `start` on (s), is between these two, whichever node
    published it.

    Example: `run.must_stay_between("/out", "data", 0.0, 2.0)`
    """
    if lowest > highest:
        raise ValueError(f"lowest={lowest:g} is more than highest={highest:g}.")
    unit = run.unit_of(field, topic)
    for at, (value,) in _from(run, topic, start, field):
        if not lowest - 1e-9 <= value <= highest + 1e-9:
            expected, got = f"{lowest:g} to {_measure(highest, unit)}", _measure(value, unit)
            part = "" if topic == TRUTH else topic  # which is no name that a student knows
            run.wrong_at(at, f"expected {field} from {expected}, got {got}.", part, expected, got)


def must_estimate(run: RecordedRun, topic: str, fields: dict[str, str], rmse: float, start: float = 0.0) -> None:
    """Check that the node's messages on `topic`, from `start` on (s), are close to what the world's truth() returned.

    `fields` has the name of the true value for each field: `{"pose.position.x": "x"}`. `rmse` is the largest root of
    the mean squared error that is allowed, in the fields' unit. A message is compared with the last step before it.

    Example: `run.must_estimate("/out", {"data": "level"}, rmse=0.2)`
    """
    truth, times = run.recording.truth, [state.at_ns for state in run.recording.truth]
    if not run.reference.truth:
        raise ValueError(f"the world of the scenario {run.scenario} has no truth(), with which to compare {topic}.")
    messages = [m for m in run.published_on(topic) if m.at >= start and times and m.at_ns >= times[0]]
    if not messages:
        _from(run, topic, start)
        run.wrong_at(None, f"expected messages on {topic}, got none from {start:g} s on.", "", "messages", "none")
    pairs = [(truth[bisect_right(times, m.at_ns) - 1].values, m.fields) for m in messages]
    each = {
        field: [(float(field_of(true, name)), float(field_of(got, field))) for true, got in pairs]
        for field, name in fields.items()
    }
    error = math.sqrt(sum((t - g) ** 2 for values in each.values() for t, g in values) / len(messages))
    if error <= rmse:
        return
    name, values = max(each.items(), key=lambda item: sum((t - g) ** 2 for t, g in item[1]))
    unit = run.unit_of(name, topic)
    expected, got = f"at most {_measure(rmse, unit)}", _measure(error, unit)
    text = f"the root of the mean squared error of {', '.join(fields)} on {topic} is {got}; {expected} is allowed."
    run.wrong_at(None, text, "", expected, got, common(values, name, unit))


def must_steer(run: RecordedRun, topic: str, field: str, errors: Errors) -> None:
    """Check that each value of `field` on `topic` has the sign of the error at that time.

    `errors` are pairs of a time (s) and how far it is to the goal then: the goal minus the place. Each holds until the
    next one.

    Example: `run.must_steer("/out", "data", [(0.0, 2.0)])`
    """
    cause, steering = steers_away(run, topic, field, errors), _steering(run, topic, field, errors)
    since = min((at for at, error in errors if abs(error) > SMALLEST), default=None)
    if since is not None and not steering:
        text = f"expected a {field} on {topic} while the goal is away, got none from {since:g} s on."
        run.wrong_at(since, text, "", f"a {field}", "none", run.waits())
    for at, error, value in steering:
        if error * value <= 0:
            expected, got = "more than 0" if error > 0 else "less than 0", _measure(value, run.unit_of(field, topic))
            text = f"expected {field} {expected}, because the goal is {error:+.3g} away; got {got}."
            run.wrong_at(at, text, topic, expected, got, cause)


def steers_away(run: RecordedRun, topic: str, field: str, errors: Errors) -> Cause:
    """Explain that every value of `field` on `topic` leads away from the goal, or that it turns to and fro; UNKNOWN if
    neither.

    `errors` are as in `must_steer`. Give what this returns to `run.wrong_at(…, cause=…)`.

    Example: `run.steers_away("/out", "data", [(0.0, 2.0)])`
    """
    pairs = [(error, value) for _, error, value in _steering(run, topic, field, errors) if abs(value) > SMALLEST]
    if len(pairs) < FEWEST:
        return UNKNOWN
    if max(error * value for error, value in pairs) <= 0:
        return Cause(f"Every {field} leads away from the goal: it has the wrong sign.", *_SIGN)
    changes = sum(before * after < 0 for (_, before), (_, after) in itertools.pairwise(pairs))
    if changes < len(pairs) / 4:
        return UNKNOWN
    text = f"{field} changes its sign {changes} times in {len(pairs)} commands: it turns to and fro, past the goal."
    return Cause(text, *hints("to_and_fro", field=field))


def _steering(run: RecordedRun, topic: str, field: str, errors: Errors) -> list[tuple[float, float, float]]:
    """Return (seconds, error, value) of each command on `topic` that comes when there is an error."""
    times = [at for at, _ in errors]
    commands = [(at, value, bisect_right(times, at + 1e-9)) for at, (value,) in trajectory(run, topic, field)]
    pairs = [(at, errors[known - 1][1], value) for at, value, known in commands if known]
    return [(at, error, value) for at, error, value in pairs if abs(error) > SMALLEST]


def _see_that_it_may_be_late(run: RecordedRun, topic: str, end: float) -> None:
    """Raise ValueError if what the world publishes on `topic` ends before `end` (s): then nothing comes too late."""
    times = [one.at for one in (run.reference.truth if topic == TRUTH else run.reference.sent) if _is_on(one, topic)]
    if len(times) > 1 and end > 2 * times[-1] - times[-2] + 1e-9:
        text = (
            f"it may take until {end:g} s, but the scenario {run.scenario} ends after {times[-1]:g} s: it never comes"
        )
        raise ValueError(f"{text} too late. Give a shorter within, or the scenario a longer duration.")


def _is_on(one: Truth | SentMessage, topic: str) -> bool:
    return isinstance(one, Truth) or one.topic == topic


def _never_there(
    run: RecordedRun,
    way: Way,
    goal: tuple[float, ...],
    words: str,
    tolerance: float,
    within: float,
    unit: str,
    reached: float | None,
    start: float,
) -> None:
    expected = f"within {_measure(tolerance, unit)} of {words} after {within:g} s"
    if reached is not None:
        text = f"it was expected {expected}, but got there only after {reached - start:.2f} s."
        run.wrong_at(reached, text, "", expected, f"after {reached - start:.2f} s")
    at, closest = min(way, key=lambda point: math.dist(point[1], goal))
    distance = math.dist(closest, goal)
    text = f"it was expected {expected}; the closest it got was {_measure(distance, unit)}."
    run.wrong_at(at, text, "", expected, _measure(distance, unit), _of_way(way, goal))


def _beyond(run: RecordedRun, way: Way, goal: tuple[float, ...], words: str, overshoot: float, unit: str) -> None:
    begin = way[0][1]
    length = math.dist(begin, goal)
    if not length:
        return
    ahead = [(g - b) / length for b, g in zip(begin, goal, strict=True)]
    for at, point in way:
        beyond = sum(a * (p - g) for a, p, g in zip(ahead, point, goal, strict=True))
        if beyond > overshoot + 1e-9:
            furthest = max(sum(a * (p - g) for a, p, g in zip(ahead, q, goal, strict=True)) for _, q in way)
            expected, got = f"at most {_measure(overshoot, unit)}", _measure(furthest, unit)
            run.wrong_at(at, f"it goes {got} beyond {words}; {expected} is allowed.", "", expected, got)


def _of_way(way: Way, goal: tuple[float, ...]) -> Cause:
    """Return what is systematically wrong with a path that does not lead to the goal."""
    begin, end = way[0][1], way[-1][1]
    length = math.dist(begin, goal)
    if all(math.dist(point, begin) < 1e-6 for _, point in way):
        return Cause("It never moved.", *hints("never_moved"))
    travelled = sum(math.dist(before, after) for (_, before), (_, after) in itertools.pairwise(way))
    if math.dist(end, goal) - length > 0.95 * travelled:
        return Cause("It only moves away from there, as with a wrong sign.", *_SIGN)
    last = [point for at, point in way if at >= way[-1][0] - 1.0]
    if len(last) > 1 and all(math.dist(point, end) < 1e-6 for point in last):
        nearly = math.dist(end, goal) < length / 4
        steps = hints("stopped_before") if nearly else hints("stopped_elsewhere")
        return Cause(f"It stopped {math.dist(end, goal):.3g} away.", *steps)
    if all(math.dist(end, goal) <= math.dist(point, goal) for _, point in way):
        return Cause("It was still coming closer at the end.", *hints("too_slow"))
    return UNKNOWN


def _words(place: Place) -> str:
    return ", ".join(f"{name} = {value:g}" for name, value in place.items())


def _measure(value: float, unit: str) -> str:
    return f"{value:.3g}{f' {unit}' if unit else ''}"
