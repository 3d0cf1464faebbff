"""What the helpers for closed loops say: too late, too far, past it, away from it, never moved."""

from __future__ import annotations

import pytest
from made_up import finding, moved, published, run, says

from grader.recording import Recording

PLACE = {"x": 4.0, "y": 3.0}
START = (0.0, 0.0, 0.0)
RIGHT = moved(START, (1.0, 2.0, 1.5), (2.0, 4.0, 3.0), (3.0, 4.05, 3.0), (4.0, 4.0, 3.0))


def test_a_right_way_passes() -> None:
    run(RIGHT).must_reach("/pose", PLACE, tolerance=0.1, within=2.0, overshoot=0.05)
    assert run(RIGHT).trajectory("/pose", "x")[1] == (1.0, (2.0,))


@pytest.mark.parametrize(
    ("mine", "message"),
    [
        (moved(START, (1.0, 0.0, 0.0)), "the closest it got was 5. It never moved."),
        (
            moved(START, (1.0, -4.0, -3.0)),
            "the closest it got was 5. It only moves away from there, as with a wrong sign.",
        ),
        (
            moved(START, (1.0, 2.0, 1.5), (2.5, 2.0, 1.5), (3.0, 2.0, 1.5)),
            "the closest it got was 2.5. It stopped 2.5 away.",
        ),
        (
            moved(START, (1.0, 1.0, 1.0), (2.0, 2.0, 2.0)),
            "the closest it got was 2.24. It was still coming closer at the end.",
        ),
        (moved(START, (3.0, 4.0, 3.0)), "but got there only after 3.00 s."),
        (moved(START, (1.0, 4.0, 3.0), (1.5, 8.0, 6.0), (2.0, 4.0, 3.0)), "it goes 5 beyond x = 4, y = 3; at most 0.5"),
        (moved(START, (2.0, 4.0, 3.0), (3.0, 3.0, 3.0)), "it reached x = 4, y = 3 at 2.00 s, but did not stay there."),
    ],
)
def test_a_way_that_is_wrong(mine: Recording, message: str) -> None:
    assert message in says(lambda: run(mine).must_reach("/pose", PLACE, tolerance=0.1, within=2.0, overshoot=0.5))


def test_what_need_not_stay() -> None:
    run(moved(START, (2.0, 4.0, 3.0), (3.0, 3.0, 3.0))).must_reach("/pose", PLACE, 0.1, 2.0, stay=False)


def test_what_must_stay_between_two_values() -> None:
    run(RIGHT).must_stay_between("/pose", "x", 0.0, 4.05)
    message = says(lambda: run(RIGHT).must_stay_between("/pose", "x", 0.0, 4.0))
    assert message == "At 3.00 s (as usual), /pose: expected x from 0 to 4, got 4.05."


@pytest.mark.parametrize(
    ("gain", "message"),
    [
        (-1.0, "At 1.00 s (as usual), /out: expected data more than 0, because the goal is +4 away; got -4 m. "
               "Every data leads away from the goal: it has the wrong sign."),
        (0.0, "got 0 m."),
    ],
)  # fmt: skip
def test_a_command_with_the_wrong_sign(gain: float, message: str) -> None:
    errors = [(1.0, 4.0), (2.0, 2.0), (3.0, -1.0), (4.0, 0.0)]
    right, wrong = (published((1.0, 2.0, 3.0, 4.0), [g * e for _, e in errors]) for g in (1.0, gain))
    run(right).must_steer("/out", "data", errors)
    found = finding(lambda: run(wrong).must_steer("/out", "data", errors))
    assert found.text.endswith(message)
    assert found.where.startswith("Look at the line that computes it") == (gain < 0)


def test_a_command_that_turns_to_and_fro_is_named() -> None:
    errors = [(float(second), 4.0 * (-1) ** second) for second in range(8)]
    mine = run(published([at for at, _ in errors], [2.0 if error > 0 else -2.0 for _, error in errors]))
    cause = mine.steers_away("/out", "data", errors)
    assert cause.seen == "data changes its sign 7 times in 8 commands: it turns to and fro, past the goal."


def test_a_topic_without_messages_is_the_authors_fault() -> None:
    with pytest.raises(ValueError, match="there is no message on /poses in the scenario plain"):
        run(RIGHT).must_reach("/poses", PLACE, 0.1, 2.0)


LASTING = published((1.0, 2.0, 5.0), (1.0, 2.0, 4.0))
SHORT, SILENT = published((1.0, 2.0), (1.0, 2.0)), published((), ())


@pytest.mark.parametrize("mine", [SHORT, SILENT])
def test_a_node_that_falls_silent_fails(mine: Recording) -> None:
    """That nothing comes from the student is no fault of the exercise's."""
    one = run(mine, LASTING)
    for check in (
        lambda: one.must_reach("/out", {"data": 4.0}, 0.1, within=1.0, start=4.0),
        lambda: one.must_stay_between("/out", "data", 0.0, 5.0, start=4.0),
    ):
        message = "In “as usual”: expected messages on /out, got none from 4 s on."
        assert says(check).startswith(message)
    assert says(lambda: run(SILENT, LASTING).trajectory("/out", "data")[-1]).endswith("messages on /out, got none.")
    assert "got none" in says(lambda: one.must_steer("/out", "data", [(4.0, 1.0)]))
    assert "nothing was published on /out for 1.00 s" in says(lambda: one.must_have_no_gap(0.5, start=4.0))


def test_a_time_that_the_scenario_does_not_have_is_the_authors_fault() -> None:
    one = run(RIGHT)
    with pytest.raises(ValueError, match="no message on /pose in the scenario plain from 30 s on"):
        one.must_stay_between("/pose", "x", 0.0, 5.0, start=30.0)
    with pytest.raises(ValueError, match="may take until 2000 s, but the scenario plain ends after 4 s"):
        one.must_reach("/pose", PLACE, 0.1, within=2000.0)
    with pytest.raises(ValueError, match="has no truth"):
        one.must_estimate("/out", {"data": "x"}, rmse=1.0)
    with pytest.raises(ValueError, match="nothing to look at on /out: it ends at 5 s"):
        run(LASTING).must_have_no_gap(1.0, start=30.0)
